"""Pairs against enumeration of all plans, and the search on teams of which attacks leave one pair and lone robots."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
import pytest

from ratt_opt import Problem, Stop, certify, exhaustive_optimum, solve_maxmin, verify_certificate, worst_case_attack
from ratt_opt.solvers.maxmin.groups.pair_outcomes import PairOutcomes, PairValues
from ratt_opt.solvers.maxmin.task import Task
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, ragged, threatened

BUDGETS = ((4, 1, 3), (5, 1, 7), (5, 2, 4), (6, 2, 9), (6, 3, 5), (4, 2, 0))
"""(N, sensing, links) whose finest outcomes are one pair and lone robots."""


def weakest_pair(problem: Problem, plan: tuple[int, ...]) -> float:
    return min(problem.objective(pair) for pair in combinations(plan, 2))


@pytest.mark.parametrize("seed", range(60))
def test_the_strongest_plan_has_the_strongest_weakest_pair(seed: int) -> None:
    rng = np.random.default_rng([7, seed])
    problem = ragged(rng, int(rng.integers(2, 6)), 4, list(OBJECTIVES)[seed % 3])
    plan = PairValues(problem.objective, problem.choices).strongest_plan()
    problem.check_plan(plan)
    best = max(weakest_pair(problem, other) for other in product(*problem.choices))
    assert weakest_pair(problem, tuple(plan)) == pytest.approx(best, rel=1e-12)


@pytest.mark.parametrize("seed", range(60))
def test_eliminations_prove_themselves_and_lose_no_plan(seed: int) -> None:
    rng = np.random.default_rng([8, seed])
    problem = ragged(rng, int(rng.integers(2, 6)), 4, list(OBJECTIVES)[seed % 3])
    choices = [rng.permutation(own)[: rng.integers(1, len(own) + 1)] for own in problem.choices]
    plans = {plan: weakest_pair(problem, plan) for plan in product(*(sorted(own.tolist()) for own in choices))}
    values = PairValues(problem.objective, problem.choices)
    for level in rng.choice(sorted(set(plans.values())), 3):
        left = [set(own.tolist()) for own in choices]
        for step in values.eliminations(choices, level * (1 + 1e-9)):
            gone = set(step.elements.tolist())
            assert gone <= left[step.robot]
            assert gone
            pairs = [problem.objective(pair) for pair in product(gone, left[step.because])]
            assert max(pairs) <= level * (1 + 1e-9)
            left[step.robot] -= gone
        kept = [plan for plan in plans if all(e in own for e, own in zip(plan, left, strict=True))]
        above = [plan for plan, value in plans.items() if value > level * (1 + 1e-8)]
        assert set(above) <= set(kept)


@pytest.mark.parametrize("weak", [0, 2])
@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("budget", BUDGETS)
def test_one_pair_and_lone_robots(budget: tuple[int, int, int], kind: str, weak: int) -> None:
    """With two robots that see next to nothing, lone robots decide the value; else mostly a pair does."""
    robots, alpha_s, alpha_c = budget
    rng = np.random.default_rng([9, robots, alpha_s, weak])
    for _ in range(4):
        problem = threatened(ragged(rng, robots, 4, kind, weak), alpha_s, alpha_c)
        assert PairOutcomes.of(Task.of(problem)) is not None
        expected = exhaustive_optimum(problem).lower
        result = solve_maxmin(problem)
        assert result.lower == pytest.approx(expected, rel=1e-9)
        assert result.upper == pytest.approx(expected, rel=2e-9)
        assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)


@pytest.mark.parametrize(("alpha_s", "alpha_c", "protected"), [(1, 2, ()), (1, 3, (0,)), (3, 3, ())])
def test_other_threats_have_no_such_outcomes(alpha_s: int, alpha_c: int, protected: tuple[int, ...]) -> None:
    team = ragged(np.random.default_rng(0), 4, 3, "trace")
    problem = Problem(team.objective, team.robot, None, alpha_s, alpha_c, frozenset(protected))
    assert PairOutcomes.of(Task.of(problem)) is None


@pytest.mark.parametrize("gap", [1e-2, 1e-6])
@pytest.mark.parametrize("kind", OBJECTIVES)
def test_a_larger_team_with_its_certificate(kind: str, gap: float, tmp_path) -> None:
    problem = threatened(ragged(np.random.default_rng(3), 16, 6, kind), 10, 60)
    result = solve_maxmin(problem, gap=gap)
    assert result.stop in {Stop.GAP, Stop.CLOSED}
    assert result.upper - result.lower <= gap * result.upper * (1 + 1e-9)
    assert worst_case_attack(problem, result.elements).lower >= result.lower * (1 - 1e-9)
    certify(problem, result, tmp_path / "proof.json")
    proved = verify_certificate(tmp_path / "proof.json")
    assert proved.upper >= proved.lower >= result.lower * (1 - 1e-8)
    assert proved.upper <= result.upper * (1 + 1e-8)


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_where_lone_robots_decide_the_first_node_is_enough(kind: str) -> None:
    """The pair of two robots that see next to nothing is closed, although it is the largest group."""
    problem = threatened(ragged(np.random.default_rng(4), 14, 4, kind, weak=2), 9, 40)
    assert PairOutcomes.of(Task.of(problem)) is not None
    result = solve_maxmin(problem, gap=1e-6, max_nodes=1)
    assert result.stop in {Stop.GAP, Stop.CLOSED}
    assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)
