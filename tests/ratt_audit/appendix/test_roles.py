"""The premises of the roles hold for what RATT really chooses."""

from fractions import Fraction

import numpy as np
import pytest

from ratt_audit.appendix.roles import Side, Team, optimum, worst_for
from ratt_opt import Problem, TableFunction, ratt
from tests.strategies import monotone_table

N_ROBOTS = 3
CONTROLS = 3


def greedy_order(problem: Problem, plan: np.ndarray, bait: tuple[int, ...]) -> list[int]:
    """The order in which RATT's elements come out of the greedy rule (any order consistent with it)."""
    order: list[int] = []
    left = [i for i in range(N_ROBOTS) if i not in bait]
    while left:
        values = {i: problem.objective([*(plan[j] for j in order), plan[i]]) for i in left}
        best = min(left, key=lambda i: (-values[i], plan[i]))
        order.append(best)
        left.remove(best)
    return order


@pytest.mark.parametrize("seed", range(40))
def test_ratt_s_choices_satisfy_every_premise(seed: int) -> None:
    rng = np.random.default_rng(seed)
    owners = np.repeat(np.arange(N_ROBOTS), CONTROLS)
    function = TableFunction(monotone_table(rng, len(owners)))
    problem = Problem(function, owners, None, int(rng.integers(0, N_ROBOTS + 1)), 0)
    plan = ratt(problem)
    order = greedy_order(problem, plan.elements, plan.bait)
    other = [int(rng.choice(choice)) for choice in problem.choices]
    bait = {f"b{k}": i for k, i in enumerate(plan.bait)}
    greedy = {f"g{k}": i for k, i in enumerate(order)}
    team = Team(tuple(bait), tuple(greedy), with_own_best=True)
    single = function.singletons()
    element = {}
    for name, robot in {**bait, **greedy}.items():
        element[name] = int(plan.elements[robot])
        element[optimum(name)] = other[robot]
        element[f"h({name})"] = int(problem.choices[robot][np.argmax(single[problem.choices[robot]])])
    ground = team.ground
    known: dict[int | str, Fraction] = {}
    for mask in range(1, 1 << ground.n):
        if ground.is_feasible(mask):
            known[mask] = Fraction(function([element[ground.names[e]] for e in ground.members(mask)]))
    for premise in team.premises:
        assert premise.expression.value(known, Fraction(1)) >= 0, premise.reason


def test_worst_attack_premises_say_that_the_attack_leaves_the_least() -> None:
    team = Team(("b1",), ("g1",))
    premises = worst_for(team, team.robots, ("g1",), side=Side.RATT)
    assert [p.expression for p in premises] == [team.f(["g1"]) - team.f(["b1"])]
    premises = worst_for(team, team.robots, ("g1",), side=Side.OPTIMUM)
    assert [p.expression for p in premises] == [team.f(["o(g1)"]) - team.f(["o(b1)"])]
