"""Teams whose robots cover few targets each: both ends against the exhaustive optimum, and proofs with lemmas."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from ratt_opt import InformationInput, Problem, certify, exhaustive_optimum, solve_maxmin, verify_certificate
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.elements import Task
from ratt_opt.solvers.maxmin.rows.separation import RowSeparation
from ratt_opt.solvers.maxmin.solve import proved_by_tangents
from tests.solvers.maxmin.proofs import proved_upper

if TYPE_CHECKING:
    from pathlib import Path


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
    plain = proved_by_tangents(problem, result, Budget())
    assert not any(cut.lemmas for cut in plain.proof.cuts)
    assert plain.upper >= plain.lower == result.lower
    made = certify(problem, result, tmp_path / "best.json")
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
