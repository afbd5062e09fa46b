"""RATT and the baselines against Algorithm 1 written out line by line."""

from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings

from ratt_opt import (
    Attack,
    Problem,
    SetFunction,
    Stop,
    TableFunction,
    caa,
    exhaustive_optimum,
    greedy,
    myopic,
    network_scenario,
    nonrobust_optimum,
    random_plan,
    random_scenario,
    ratt,
    solve_maxmin,
)
from ratt_opt.budget import Budget
from ratt_opt.solvers.lazy_greedy import LazyGreedyParams
from ratt_opt.solvers.ratt import RattParams
from tests.solvers.maxmin.engine import NO_PLANS_LISTED
from tests.strategies import OBJECTIVES, information_data, random_problem, table_problems
from tests.ways import go


def algorithm_1(f: SetFunction, choices: list[list[int]], alpha: int) -> tuple[list[int], list[int]]:
    """Lines 3 to 18 of Algorithm 1 with ties by lowest element, then lowest robot: (elements, bait)."""
    robots = range(len(choices))
    best: dict[int, int] = {}
    for i in robots:
        for e in choices[i]:
            if i not in best or f([e]) > f([best[i]]):
                best[i] = e
    if alpha >= len(choices):
        return [best[i] for i in robots], list(robots)
    bait: list[int] = []
    while len(bait) < alpha:
        pick = None
        for i in robots:
            if i not in bait and (pick is None or f([best[i]]) > f([best[pick]])):
                pick = i
        assert pick is not None
        bait.append(pick)
    plan = {i: best[i] for i in bait}
    chosen: list[int] = []
    while len(plan) < len(choices):
        candidates = sorted(e for i in robots if i not in plan for e in choices[i])
        winner = candidates[0]
        for e in candidates:
            if f([*chosen, e]) > f([*chosen, winner]):
                winner = e
        plan[next(i for i in robots if winner in choices[i])] = winner
        chosen.append(winner)
    return [plan[i] for i in robots], sorted(bait)


@given(table_problems())
@settings(max_examples=300, deadline=None)
def test_planners_are_algorithm_1(problem: Problem) -> None:
    choices = [c.tolist() for c in problem.choices]
    n = problem.n_robots
    alpha = problem.alpha_s + caa(n, problem.alpha_c).alpha_cs
    for plan, level in ((ratt(problem), alpha), (greedy(problem), 0), (myopic(problem), n)):
        elements, bait = algorithm_1(problem.objective, choices, level)
        assert plan.elements.tolist() == elements
        assert list(plan.bait) == bait


@given(table_problems())
@settings(max_examples=100, deadline=None)
def test_nonrobust_optimum_is_the_best_plan_without_attack(problem: Problem) -> None:
    calm = Problem(problem.objective, problem.robot, None, 0, 0)
    values = {
        pick: calm.team_value(pick, Attack())
        for pick in np.ndindex(*map(len, problem.choices))
        for pick in [tuple(c[k] for c, k in zip(problem.choices, pick, strict=True))]
    }
    plan = nonrobust_optimum(problem)
    assert values[tuple(plan.elements.tolist())] == max(values.values())


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("seed", range(8))
def test_nonrobust_optimum_by_search_equals_every_plan(kind: str, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = random_problem(np.random.default_rng([8, seed]), 4, kind=kind)
    every = nonrobust_optimum(problem)
    go(monkeypatch, NO_PLANS_LISTED)
    searched = nonrobust_optimum(problem)
    values = [problem.team_value(plan.elements, Attack()) for plan in (every, searched)]
    assert values[1] == pytest.approx(values[0], rel=1e-9)


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_nonrobust_optimum_of_thirty_robots_is_proved_and_no_worse_than_greedy(kind: str) -> None:
    problem = random_scenario(30, 10, alpha_s=10, alpha_c=108, seed=0).problem(kind)
    value, by_greedy = (problem.team_value(plan(problem).elements, Attack()) for plan in (nonrobust_optimum, greedy))
    proved = solve_maxmin(replace(problem, alpha_s=0, alpha_c=0))
    assert proved.stop is Stop.CLOSED
    assert value >= proved.lower * (1 - 1e-9)
    assert value >= by_greedy * (1 - 1e-9)


class CountingFunction(TableFunction):
    """A table that counts how many values it is asked for."""

    __slots__ = ("asked",)

    def __init__(self, values: list[float]) -> None:
        super().__init__(values)
        self.asked = 0

    def evaluate(self, membership: np.ndarray) -> np.ndarray:
        self.asked += len(membership)
        return super().evaluate(membership)


@pytest.mark.parametrize(("alpha_s", "alpha_c"), [(0, 0), (1, 0), (1, 2), (3, 3)])
def test_evaluations_are_counted(alpha_s: int, alpha_c: int) -> None:
    f = CountingFunction([float(bin(mask).count("1")) for mask in range(64)])
    problem = Problem(f, np.repeat(np.arange(3), 2), None, alpha_s, alpha_c)
    plan = ratt(problem)
    assert plan.evaluations == f.asked
    # Theorem 2: no more than |U_V|^2 evaluations.
    assert plan.evaluations <= f.n**2


def test_random_plan_is_reproducible_and_uses_every_element() -> None:
    problem = Problem(TableFunction(np.zeros(16)), [0, 0, 1, 1], None, 0, 0)
    plans = [tuple(random_plan(problem, seed=s).elements.tolist()) for s in range(40)]
    assert set(plans) == {(0, 2), (0, 3), (1, 2), (1, 3)}
    assert plans[7] == tuple(random_plan(problem, seed=7).elements.tolist())


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(12))
def test_lazy_evaluation_changes_nothing(name: str, seed: int) -> None:
    """Equal elements and robots, rank one, useless and overwhelming information included."""
    rng = np.random.default_rng(seed)
    prior, information = information_data(rng, 24, 5)
    information *= 10.0 ** rng.integers(-6, 7, size=(24, 1, 1, 1)) if seed % 3 == 0 else 1.0
    information[1], information[7], information[9] = information[0], information[0], 0.0
    weights = rng.uniform(0.2, 3, 5) if seed % 2 else None
    problem = Problem(OBJECTIVES[name](prior, information, weights), np.repeat(np.arange(8), 3), None, seed % 4, 0)
    plain = ratt(problem)
    lazy = LazyGreedyParams(plain=-1, first=[8, 1][seed % 2], at_once=[10**6, 0][seed // 2 % 2])
    assert ratt(problem, params=RattParams(greedy=lazy)) == plain


def test_the_size_of_groups_takes_no_more_than_its_share() -> None:
    params, seconds = RattParams(), np.geomspace(1e-3, 1e4, 60)
    asked = [params.seconds_of(left) or 0.0 for left in seconds]
    assert asked == sorted(asked)
    assert all(got in {0.3, 2.0, 0.5 * left, 0.1 * left} for got, left in zip(asked, seconds, strict=True))
    assert asked[0] == 0.3
    assert params.seconds_of(np.inf) is None
    shares = [params.first_share(left) for left in seconds]
    assert shares == sorted(shares, reverse=True)
    assert (shares[0], shares[-1], params.first_share(np.inf), params.first_share(50.0)) == (0.1, 0.02, 0.02, 0.04)


@pytest.mark.parametrize("n_robots", [13, 65])
@pytest.mark.parametrize("controls", [1, 2])
def test_no_attack_needs_no_outcomes(n_robots: int, controls: int) -> None:
    """Chains beyond the enumeration of outcomes, teams beyond an array's axes: few plans all the same."""
    rng = np.random.default_rng(n_robots)
    owners = np.concatenate([np.arange(n_robots), np.arange(13 * (controls - 1))])
    objective = OBJECTIVES["trace"](*information_data(rng, len(owners), 2))
    problem = Problem(objective, owners, nx.path_graph(n_robots), 1, 1)
    found = exhaustive_optimum(replace(problem, alpha_s=0, alpha_c=0))
    assert found.stop is Stop.EXHAUSTED
    value = problem.objective(nonrobust_optimum(problem).elements)
    assert (found.lower, found.upper) == problem.widen_by_rounding(value, value)
    assert value >= problem.objective(ratt(problem).elements) * (1 - 1e-12)


@pytest.mark.parametrize("family", ["dense", "disk-6", "hubs"])
def test_the_plan_of_a_small_network_does_not_depend_on_the_limit(family):
    problem = network_scenario(family, 14, 4, alpha_s=0.2, alpha_c=0.3, seed=2).problem()
    assert ratt(problem).alpha_cs == ratt(problem, budget=Budget(0.0)).alpha_cs > 0
