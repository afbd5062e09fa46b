"""Attacks with exchanged smaller groups: allowed, of the same sizes, and not stronger at their strongest."""

from collections.abc import Callable, Iterable
from itertools import combinations

import numpy as np
import pytest

from ratt_opt import Attack, Problem, random_scenario, worst_case_attack
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.adversary import PlanIndependentAttacks
from tests.oracles import groups_left
from tests.strategies import OBJECTIVES, random_elements


def groups_of(problem: Problem, attack: Attack) -> list[frozenset[int]]:
    left = (group - attack.sensing for group in groups_left(problem, attack.links))
    return sorted((group for group in left if group), key=lambda group: (-len(group), min(group)))


def at_their_best(problem: Problem) -> Callable[[Iterable[int]], float]:
    """A lone robot's largest value; a group's if each robot saw every target as with the element that sees it best."""
    f = problem.objective
    information = np.empty((problem.n_robots, f.n_targets, 2, 2))
    for i, choice in enumerate(problem.choices):
        for j in range(f.n_targets):
            information[i, j] = f.information[max(choice, key=lambda e, j=j: np.trace(f.information[e, j])), j]
    together = type(f)(f.prior, information, f.weights)
    alone = [max(f([e]) for e in choice) for choice in problem.choices]

    def value(group: Iterable[int]) -> float:
        robots = list(group)
        return alone[robots[0]] if len(robots) == 1 else together(robots)

    return value


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize(("alpha_s", "alpha_c"), [(3, 11), (5, 15), (6, 22), (2, 0)])
def test_the_smaller_groups_are_the_weakest_there_are(kind: str, alpha_s: int, alpha_c: int) -> None:
    problem = random_scenario(10, 6, alpha_s=alpha_s, alpha_c=alpha_c, seed=2).problem(kind)
    best = at_their_best(problem)
    lasting = PlanIndependentAttacks(problem, Budget(), 0.05)
    rng = np.random.default_rng(0)
    for _ in range(6):
        attack = worst_case_attack(problem, random_elements(rng, problem)).attack
        exchanged = lasting.of(attack)
        problem.check_attack(exchanged)
        before, after = groups_of(problem, attack), groups_of(problem, exchanged)
        assert before[0] in after
        assert [len(group) for group in after] == [len(group) for group in before]
        smaller = [group for group in after if group != before[0]]
        if smaller:
            size, outside = len(smaller[0]), sorted(set(range(10)) - before[0])
            weakest = min(best(group) for group in combinations(outside, size))
            found = min(best(group) for group in smaller if len(group) == size)
            assert found == pytest.approx(weakest, rel=1e-9)


def test_nothing_is_exchanged_where_robots_differ_to_the_adversary() -> None:
    calm = random_scenario(6, 3, alpha_s=1, alpha_c=5, seed=0).problem()
    guarded = Problem(calm.objective, calm.robot, None, 1, 5, frozenset({0}))
    attack = worst_case_attack(guarded, random_elements(np.random.default_rng(0), guarded)).attack
    assert PlanIndependentAttacks(guarded, Budget(), 0.05).of(attack) is attack
