"""The max-min solver against the exhaustive optimum, and its proofs against an independent reading."""

import copy
import pickle
import time
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from ratt_opt import (
    AttackResult,
    InputError,
    LogDetObjective,
    Problem,
    Stop,
    TraceObjective,
    exhaustive_optimum,
    greedy,
    myopic,
    random_scenario,
    ratt,
    solve_maxmin,
    worst_case_attack,
)
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.adversary import worst_case_attack_unrounded
from tests.solvers.maxmin.engine import BLIND, UNLISTED, exact_attacks, link_attacks
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, random_problem
from tests.ways import go


@pytest.mark.parametrize("seed", range(200))
def test_equals_the_exhaustive_optimum(seed: int) -> None:
    rng = np.random.default_rng([5, seed])
    problem = random_problem(rng, int(rng.integers(1, 6)), controls=4)
    expected = exhaustive_optimum(problem).lower
    result = solve_maxmin(problem)
    scale = max(1.0, abs(expected))
    assert result.lower <= result.upper
    assert result.lower == pytest.approx(expected, abs=1e-8 * scale)
    assert result.upper == pytest.approx(expected, abs=1e-8 * scale)
    assert worst_case_attack(problem, result.elements).lower >= result.lower - 1e-12 * scale
    if result.proof is not None:
        assert proved_upper(problem, result.proof) <= result.upper + 1e-10 * scale


@pytest.mark.parametrize("seed", range(60))
def test_quick_attacks_that_see_nothing_cost_time_only(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Plans look better than they are until they are attacked exactly; what was closed on their word is reopened."""
    go(monkeypatch, UNLISTED, BLIND)
    rng = np.random.default_rng([6, seed])
    problem = random_problem(rng, int(rng.integers(2, 6)), kind=list(OBJECTIVES)[seed % 3], controls=4)
    expected = exhaustive_optimum(problem).lower
    result = solve_maxmin(problem)
    scale = max(1.0, abs(expected))
    assert result.lower == pytest.approx(expected, abs=1e-8 * scale)
    assert expected - 1e-9 * scale <= result.upper
    assert proved_upper(problem, result.proof) <= result.upper + 1e-10 * scale
    assert result.upper == pytest.approx(expected, abs=1e-8 * scale)


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("at", [1, 2, 4])
def test_an_interrupt_keeps_the_bracket(kind: str, at: int) -> None:
    seed = 0 if kind == "maxeig" else 1
    problem = random_scenario(10, 15, alpha_s=3, alpha_c=11, seed=seed).problem(kind)
    brackets: list[tuple[float, float]] = []

    def interrupt(_: int, lower: float, upper: float) -> None:
        brackets.append((lower, upper))
        if len(brackets) == at:
            raise KeyboardInterrupt

    result = solve_maxmin(problem, progress=interrupt)
    assert result.stop is Stop.INTERRUPTED
    assert (result.lower, result.upper) == brackets[-1]
    assert all(later[0] >= lower and later[1] <= upper for (lower, upper), later in pairwise(brackets))
    full = solve_maxmin(problem)
    assert result.lower <= full.upper * (1 + 1e-12)
    assert full.lower <= result.upper * (1 + 1e-12)
    assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_an_interrupted_attack_keeps_the_bracket(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = random_scenario(10, 8, alpha_s=3, alpha_c=11, seed=1).problem(kind)
    full = solve_maxmin(problem)

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    go(monkeypatch, exact_attacks(interrupted))
    result = solve_maxmin(problem)
    assert result.stop is Stop.INTERRUPTED
    assert result.lower <= full.lower <= full.upper <= result.upper


@pytest.mark.parametrize("robots", [10, 14])
def test_an_interrupt_that_an_inner_attack_turned_into_a_bracket_is_heard(
    robots: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the exact attack in a team of ten, of the quick one in a larger team."""
    problem = random_scenario(robots, 8, alpha_s=3, alpha_c=11, seed=1).problem()
    asked = []

    def interrupted(*given: Any, **limits: Any) -> AttackResult:
        asked.append(given)
        return replace(worst_case_attack_unrounded(*given, **limits), stop=Stop.INTERRUPTED)

    go(monkeypatch, exact_attacks(interrupted))
    outer = Budget()
    result = solve_maxmin(problem, budget=outer)
    assert result.stop is outer.stop() is Stop.INTERRUPTED
    assert len(asked) == 1
    assert result.lower <= result.upper


@pytest.mark.parametrize("limits", [{"gap": -1}, {"gap": float("nan")}, {"time_limit": -1}, {"max_nodes": 0}])
def test_bad_limits_are_refused(limits: dict[str, float]) -> None:
    problem = random_scenario(2, 2, alpha_s=0, alpha_c=0, seed=0).problem()
    with pytest.raises(InputError, match=next(iter(limits))):
        solve_maxmin(problem, **limits)


def quadratic_regression(objective, robots: int, points: int = 21) -> Problem:
    """Every robot may measure ``a + b x + c x^2`` at any point of a grid over [-1, 1]; nobody attacks."""
    x = np.linspace(-1, 1, points)
    rows = np.stack([np.ones_like(x), x, x * x], axis=1)
    information = np.tile(rows[:, None, :, None] * rows[:, None, None, :], (robots, 1, 1, 1))
    owners = np.repeat(np.arange(robots), points)
    return Problem(objective(1e6 * np.eye(3)[None], information), owners, None, 0, 0)


@pytest.mark.parametrize(
    ("objective", "robots", "shares"),
    [(LogDetObjective, 6, {0: 2, 10: 2, 20: 2}), (TraceObjective, 8, {0: 2, 10: 4, 20: 2})],
)
def test_optimal_designs_known_in_closed_form(objective, robots: int, shares: dict[int, int]) -> None:
    """D-optimal: thirds at -1, 0, 1. A-optimal: a quarter, a half, a quarter."""
    problem = quadratic_regression(objective, robots)
    result = solve_maxmin(problem, gap=1e-9, time_limit=60)
    chosen = (result.elements % 21).tolist()
    best = problem.objective([i * 21 + point for i, point in enumerate(p for p, k in shares.items() for _ in range(k))])
    assert result.upper >= best * (1 - 1e-12)
    assert result.lower == pytest.approx(best, rel=1e-9, abs=2 * problem.evaluation_error)
    assert {point: chosen.count(point) for point in set(chosen)} == shares


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize(("alpha_s", "alpha_c"), [(4, 20), (7, 30), (9, 46)])
def test_teams_whose_outcomes_are_not_listed(kind: str, alpha_s: int, alpha_c: int) -> None:
    """The proved bracket holds what every part says anew: the proof its upper end, the exact attacker its lower."""
    problem = random_scenario(14, 5, alpha_s=alpha_s, alpha_c=alpha_c, seed=4).problem(kind)
    result = solve_maxmin(problem, gap=1e-6)
    assert result.upper - result.lower <= 1e-6 * result.upper * (1 + 1e-9)
    assert result.stop in {Stop.GAP, Stop.CLOSED}
    assert worst_case_attack(problem, result.elements).lower >= result.lower * (1 - 1e-9)
    assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)
    for planner in (ratt, greedy, myopic):
        assert worst_case_attack(problem, planner(problem).elements).upper <= result.upper * (1 + 1e-9)


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_node_limits_make_large_teams_reproducible(kind: str) -> None:
    problem = random_scenario(14, 5, alpha_s=5, alpha_c=26, seed=0).problem(kind)
    first, again = (solve_maxmin(problem, max_nodes=6) for _ in range(2))
    assert first.elements.tolist() == again.elements.tolist()
    assert (first.lower, first.upper, first.nodes, first.stop) == (again.lower, again.upper, again.nodes, again.stop)
    assert first.nodes <= 6


def test_a_time_limit_is_kept_and_the_bracket_reported_open() -> None:
    problem = random_scenario(30, 25, alpha_s=10, alpha_c=108, seed=3).problem()
    began = time.monotonic()
    result = solve_maxmin(problem, time_limit=0.5)
    assert result.stop is Stop.TIME
    assert 0 <= result.lower < result.upper
    assert time.monotonic() - began < 60, "a limit of half a second, on however busy a machine"


def test_results_are_values_of_plain_numbers() -> None:
    problem = random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=17).problem()
    result, again = solve_maxmin(problem), solve_maxmin(problem)
    assert result == again == pickle.loads(pickle.dumps(result)) == copy.deepcopy(result)
    assert hash(result) == hash(again)
    assert result != replace(result, nodes=result.nodes + 1)
    assert result != replace(result, proof=replace(result.proof, tree=result.proof.tree[:-1]))
    assert {type(result.lower), type(result.upper), type(result.posterior_gap)} == {float}
    assert len(repr(result)) < 200
    assert exhaustive_optimum(problem) == exhaustive_optimum(problem)


def test_an_outer_budget_counts_and_hears_of_interrupts() -> None:
    problem = random_scenario(10, 15, alpha_s=3, alpha_c=11, seed=1).problem()
    spent = solve_maxmin(problem, budget=Budget(time_limit=0.0))
    assert spent.stop is Stop.TIME
    assert spent.lower <= spent.upper
    outer = Budget()

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    assert solve_maxmin(problem, budget=outer, progress=interrupt).stop is Stop.INTERRUPTED
    assert outer.stop() is Stop.INTERRUPTED
    assert solve_maxmin(problem, budget=outer).stop is Stop.INTERRUPTED


def test_what_is_known_of_the_link_attacks_is_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = random_scenario(6, 3, alpha_s=1, alpha_c=4, seed=2).problem()
    expected, plan = solve_maxmin(problem), ratt(problem)

    def asked(_: Problem) -> int:
        raise AssertionError

    go(monkeypatch, link_attacks(asked))
    assert solve_maxmin(problem, alpha_cs=plan.alpha_cs) == expected
    assert ratt(problem, alpha_cs=plan.alpha_cs) == plan
