"""Restarted searches lose no plan, prove what they say, and leave a valid bracket wherever they stop."""

from dataclasses import replace

import numpy as np
import pytest

from ratt_opt import certify, exhaustive_optimum, random_scenario, solve_maxmin, verify_certificate
from tests.solvers.maxmin.engine import BLIND, SMALL_TREES, UNLISTED, trees_begun
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, small_team
from tests.ways import go


@pytest.fixture(autouse=True)
def small_trees(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many small trees, as where searches of large teams are long."""
    go(monkeypatch, UNLISTED, SMALL_TREES)


@pytest.mark.parametrize(("seed", "sees_late"), [*((k, False) for k in range(60)), *((k, True) for k in range(30))])
def test_agrees_with_exhaustive_search(seed: int, sees_late: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where attacks see nothing until a plan is attacked exactly: the level falls after trees have ended."""
    if sees_late:
        go(monkeypatch, BLIND)
    problem = small_team(seed)
    found, best = solve_maxmin(problem, gap=0), exhaustive_optimum(problem)
    slack = 1e-9 * best.upper + 16 * problem.objective.rounding
    assert found.lower == pytest.approx(best.lower, abs=slack)
    assert best.lower - slack <= found.upper <= best.upper + slack
    assert proved_upper(problem, found.proof) <= found.upper + slack


def test_an_optimum_of_nothing_ends() -> None:
    problem = random_scenario(5, 3, alpha_s=4, alpha_c=3, seed=2).problem()
    nothing = replace(
        problem, objective=problem.information_objective.with_information(0 * problem.information_objective.information)
    )
    found = solve_maxmin(nothing)
    assert found.upper == pytest.approx(0, abs=1e-9)


def test_the_bound_comes_down_from_tree_to_tree(monkeypatch: pytest.MonkeyPatch) -> None:
    trees = trees_begun(monkeypatch)
    problem = random_scenario(8, 6, alpha_s=1, alpha_c=14, seed=1).problem()
    uppers = []
    result = solve_maxmin(problem, gap=1e-7, progress=lambda *state: uppers.append(state[2]))
    assert len(trees) > 1
    assert np.all(np.diff(uppers) <= 1e-12 * result.upper)
    assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_stopping_at_any_node_leaves_a_proved_bracket(kind: str, tmp_path) -> None:
    problem = random_scenario(6, 4, alpha_s=0, alpha_c=9, seed=5).problem(kind)
    optimum = exhaustive_optimum(problem).lower
    uppers = []
    for max_nodes in (1, 2, 3, 4, 6, 9, 13):
        result = solve_maxmin(problem, max_nodes=max_nodes, gap=0)
        assert result.lower <= optimum * (1 + 1e-12)
        assert result.upper >= optimum * (1 - 1e-12)
        assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)
        uppers.append(result.upper)
    assert np.all(np.diff(uppers) <= 1e-12 * optimum)
    certify(problem, result, tmp_path / "one.json")
    assert verify_certificate(tmp_path / "one.json").upper >= optimum * (1 - 1e-12)
