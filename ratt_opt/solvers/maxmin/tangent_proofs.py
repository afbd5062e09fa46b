"""Proofs by tangents, covers and marginal gains alone, as certificates state them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ratt_opt.coordinates.measured import measured_coordinates
from ratt_opt.coordinates.unit_prior import with_unit_prior
from ratt_opt.solvers.maxmin.solve import ROUNDING, solve_in_coordinates

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["TangentProofParams", "proved_by_tangents"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TangentProofParams:
    """Limits of the search for a proof without inequalities of single targets.

    ``share`` : of the seconds left; ``nodes``, ``times`` : at most this many nodes, or times those of the first search:
    what a certificate states against the time that it takes
    """

    share: float = 0.5
    nodes: int = 2_000
    times: int = 10


def proved_by_tangents(
    problem: Problem, result: MaxMinResult, budget: Budget, params: TangentProofParams | None = None
) -> MaxMinResult:
    """Prove the upper end of a result by tangents, covers and marginal gains alone, as certificates state proofs.

    Neither inequalities of single targets nor the spacing of values are part of such a proof. The result itself if its
    proof is such a one. Otherwise plans are searched again, from the one found. If a limit ends that search, the upper
    end is the one proved by then, which may be larger.
    """
    proof = result.proof
    if proof is None or (proof.spacing is None and not any(cut.lemmas for cut in proof.cuts)):
        return result
    params = TangentProofParams() if params is None else params
    part = budget.part(params.share, max_nodes=max(params.nodes, params.times * result.nodes))
    searched = with_unit_prior(measured_coordinates(problem))
    gap = max((result.upper - result.lower) / abs(result.upper), ROUNDING) if result.upper else ROUNDING
    found = solve_in_coordinates(searched, part, gap, start=result.elements, by_rows=False).widen_by_rounding(searched)
    lifted = searched.lifted(found)
    return replace(result, upper=max(lifted.upper, result.lower), proof=lifted.proof)
