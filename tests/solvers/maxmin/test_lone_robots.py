"""The search on teams of which attacks leave one pair and lone robots, against all plans."""

import numpy as np
import pytest

from ratt_opt import Stop, certify, exhaustive_optimum, solve_maxmin, verify_certificate, worst_case_attack
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, ragged, threatened

BUDGETS = ((4, 1, 3), (5, 1, 7), (5, 2, 4), (6, 2, 9), (6, 3, 5), (4, 2, 0))
"""(N, sensing, links) whose finest outcomes are one pair and lone robots."""


@pytest.mark.parametrize("weak", [0, 2])
@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("budget", BUDGETS)
def test_one_pair_and_lone_robots(budget: tuple[int, int, int], kind: str, weak: int) -> None:
    """With two robots that see next to nothing, lone robots decide the value; else mostly a pair does."""
    robots, alpha_s, alpha_c = budget
    rng = np.random.default_rng([9, robots, alpha_s, weak])
    for _ in range(4):
        problem = threatened(ragged(rng, robots, 4, kind, weak), alpha_s, alpha_c)
        expected = exhaustive_optimum(problem).lower
        result = solve_maxmin(problem)
        assert result.lower == pytest.approx(expected, rel=1e-9)
        assert result.upper == pytest.approx(expected, rel=2e-9)
        assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)


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
    result = solve_maxmin(problem, gap=1e-6, max_nodes=1)
    assert result.stop in {Stop.GAP, Stop.CLOSED}
    assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)
