"""Outcomes of small groups narrow a search without losing a plan, and prove what they leave out."""

import numpy as np
import pytest

from ratt_opt import Problem, certify, exhaustive_optimum, random_scenario, solve_maxmin, verify_certificate
from ratt_opt.solvers.maxmin.small_groups import SmallGroups
from tests.solvers.maxmin.engine import UNLISTED
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, ragged, threatened
from tests.ways import go

BUDGETS = ((5, 0, 7), (5, 0, 8), (6, 0, 11), (6, 0, 12), (6, 1, 9), (5, 1, 5))
"""(N, sensing, links) that leave several groups of two and three."""


@pytest.mark.parametrize("seed", range(60))
def test_narrowed_searches_agree_with_exhaustive_search(seed: int, tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Outcomes are not listed beforehand, as for large teams."""
    go(monkeypatch, UNLISTED)
    rng = np.random.default_rng([17, seed])
    robots, alpha_s, alpha_c = BUDGETS[seed % len(BUDGETS)]
    team = ragged(rng, robots, 4, list(OBJECTIVES)[seed % 3], weak=int(rng.integers(0, 2)))
    problem = threatened(team, alpha_s, alpha_c)
    found, best = solve_maxmin(problem, gap=0), exhaustive_optimum(problem)
    slack = 1e-9 * best.upper + 16 * problem.objective.rounding
    assert found.lower == pytest.approx(best.lower, abs=slack)
    assert best.lower - slack <= found.upper <= best.upper + slack
    assert proved_upper(problem, found.proof) <= found.upper + slack
    if seed % 10 == 0:
        certify(problem, found, tmp_path / "one.json")
        proved = verify_certificate(tmp_path / "one.json")
        assert proved.lower <= best.upper
        assert best.lower <= proved.upper <= found.upper * (1 + 1e-6) + slack


@pytest.mark.parametrize(("blinded", "cut"), [(5, 156), (0, 180)])
def test_pairs_and_threes_of_twenty_robots_close_in_a_few_nodes(blinded: int, cut: int) -> None:
    """Relaxed plans alone leave these open after thousands."""
    problem = random_scenario(20, 20, alpha_s=blinded, alpha_c=cut, seed=0).problem()
    found = solve_maxmin(problem, gap=5e-5, max_nodes=100)
    assert found.upper - found.lower <= 1e-4 * found.upper


def test_a_node_without_a_plan_above_the_level_is_closed_without_a_program(monkeypatch: pytest.MonkeyPatch) -> None:
    go(monkeypatch, UNLISTED)
    closed = []

    def narrow(self, node, better, plain=SmallGroups.narrow):
        left = plain(self, node, better)
        closed.append(left is None)
        return left

    monkeypatch.setattr(SmallGroups, "narrow", narrow)
    rng = np.random.default_rng(3)
    for _ in range(6):
        problem: Problem = threatened(ragged(rng, 6, 4, "trace"), 0, 12)
        solve_maxmin(problem, gap=0)
    assert any(closed)
