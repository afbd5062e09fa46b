"""Teams whose robots cover few targets each: both ends against the exhaustive optimum, and proofs with lemmas."""

from pathlib import Path

import numpy as np
import pytest

from ratt_opt import InformationInput, Problem, certify, exhaustive_optimum, solve_maxmin, verify_certificate
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.elements import Task
from ratt_opt.solvers.maxmin.params import RowParams
from ratt_opt.solvers.maxmin.rows.separation import RowSeparation
from ratt_opt.solvers.maxmin.solve import solve_in_coordinates
from ratt_opt.solvers.maxmin.stages.schedule import TREES_ALONE
from tests.solvers.maxmin.proofs import proved_upper


def covering_team(rng: np.random.Generator, *, robots: int, paths: int, targets: int, lost: int, kind: str) -> Problem:
    """Robots that see a fifth of the targets well on each path, and nothing of the others."""
    seen = rng.random((robots * paths, targets)) < 0.2
    information = np.where(seen, 10.0 ** rng.uniform(0, 4, seen.shape), 0.0)[..., None, None]
    owners = np.repeat(np.arange(robots), paths).tolist()
    return InformationInput(
        prior=[[[1.0]]] * targets, information=information, robot=owners, alpha_s=lost, alpha_c=0
    ).problem(kind)


@pytest.mark.parametrize("kind", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(6))
def test_both_ends_meet_at_the_exhaustive_optimum(seed: int, kind: str) -> None:
    rng = np.random.default_rng([67, seed])
    problem = covering_team(rng, robots=5, paths=4, targets=14, lost=1 + seed % 2, kind=kind)
    result, best = solve_maxmin(problem), exhaustive_optimum(problem).lower
    assert result.lower == pytest.approx(best, rel=1e-9)
    assert result.upper == pytest.approx(best, rel=1e-9)
    assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-9)


def test_a_proof_with_lemmas_becomes_a_certificate(tmp_path: Path) -> None:
    problem = covering_team(np.random.default_rng(0), robots=6, paths=4, targets=20, lost=2, kind="trace")
    for limit in range(1, 40):  # whatever ends the search in depth would leave no rows
        result = solve_maxmin(problem, max_nodes=limit)
        if any(cut.lemmas for cut in result.proof.cuts):
            break
    assert any(cut.lemmas for cut in result.proof.cuts)
    assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-9)
    made = certify(problem, result, tmp_path / "best.json")
    assert made.upper_raised <= 1e-7 * result.upper
    assert made.verified.upper == pytest.approx(result.upper + made.upper_raised)
    assert verify_certificate(tmp_path / "best.json").upper == made.verified.upper


def test_rows_are_for_sums_of_targets_that_few_robots_see() -> None:
    rng = np.random.default_rng(1)
    problem = covering_team(rng, robots=4, paths=3, targets=10, lost=1, kind="trace")
    assert RowSeparation.fits(Task.of(problem))
    seen_by_all = InformationInput(
        prior=[[[1.0]]] * 4, information=np.ones((6, 4, 1, 1)), robot=[0, 0, 1, 1, 2, 2], alpha_s=1, alpha_c=0
    )
    assert not RowSeparation.fits(Task.of(seen_by_all.problem("trace")))
    assert not RowSeparation.fits(Task.of(covering_team(rng, robots=4, paths=3, targets=10, lost=1, kind="maxeig")))


def test_rows_begin_at_the_root_where_elements_see_many_targets() -> None:
    rng = np.random.default_rng(2)
    many = covering_team(rng, robots=4, paths=5, targets=40, lost=1, kind="logdet")
    few = covering_team(rng, robots=4, paths=5, targets=8, lost=1, kind="logdet")
    assert RowSeparation.first_node(Task.of(many)) == 0
    assert RowSeparation.first_node(Task.of(few)) == RowParams().nodes > 0
    not_a_sum = covering_team(rng, robots=4, paths=5, targets=40, lost=1, kind="maxeig")
    assert np.isinf(RowSeparation.first_node(Task.of(not_a_sum)))


@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_rows_that_begin_later_change_nothing_before(kind: str) -> None:
    problem = covering_team(np.random.default_rng(3), robots=6, paths=4, targets=9, lost=2, kind=kind)
    one, other = (solve_in_coordinates(problem, Budget(), by_rows=by_rows) for by_rows in (True, False))
    assert 0 < one.nodes < RowParams().nodes
    assert (one.nodes, one.lower, one.upper) == (other.nodes, other.lower, other.upper)


@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_rows_may_begin_in_the_middle_of_a_tree(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(RowSeparation, "first_node", lambda _: 3)
    problem = covering_team(np.random.default_rng(4), robots=5, paths=4, targets=9, lost=2, kind=kind)
    result = solve_in_coordinates(problem, Budget(), stages=TREES_ALONE)
    assert any(cut.lemmas for cut in result.proof.cuts)
    assert result.lower == pytest.approx(exhaustive_optimum(problem).lower, rel=1e-9)
    assert result.lower <= proved_upper(problem, result.proof) <= result.upper * (1 + 1e-9)
