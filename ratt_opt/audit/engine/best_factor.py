"""What is left of a refuted step: the best factor for which ``left >= factor * right`` still holds."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import floor
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.claim import Claim
from ratt_opt.audit.engine.decide import CURVATURE_GRID
from ratt_opt.audit.engine.polynomial import constant
from ratt_opt.audit.engine.prover import find_proof
from ratt_opt.audit.engine.refuter import find_witness, least_ratio

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.audit.appendix.entry import SizedClaim
    from ratt_opt.audit.engine.claim import Linear

__all__ = ["Weakened", "weaken"]

_STEP = Fraction(1, 1000)


@dataclass(frozen=True, slots=True, kw_only=True)
class Weakened:
    """``left >= factor * right`` is proved at ``curvature``; ``is_best``: with ``factor + 1/1000`` it is refuted.

    Factor 0 is trivial: no positive factor was found.
    """

    curvature: Fraction | None
    factor: Fraction
    is_best: bool


def weaken(refuted: Sequence[SizedClaim]) -> tuple[Weakened, ...]:
    """Return, at each curvature of the grid, the best factor that was found and checked for all of these sizes."""
    if not refuted or any(sized.left is None or sized.right is None for sized in refuted):
        return ()
    kind = refuted[0].claim.kind
    grid: tuple[Fraction | None, ...] = CURVATURE_GRID if kind.is_parametric else (None,)
    found = (_for_all(refuted, curvature) for curvature in sorted(grid, key=lambda v: v or 0))
    return tuple(item for item in found if item is not None)


def _for_all(refuted: Sequence[SizedClaim], curvature: Fraction | None) -> Weakened | None:
    """The smallest factor of the sizes: every value in a claim is non-negative, so it serves the other sizes too."""
    each = []
    for sized in refuted:
        assert sized.left is not None
        assert sized.right is not None
        found = _at(sized.claim, sized.left, sized.right, curvature)
        if found is None:
            return None
        each.append(found)
        if found.factor == 0:
            break
    return min(each, key=lambda found: found.factor)


def _at(claim: Claim, left: Linear, right: Linear, curvature: Fraction | None) -> Weakened | None:
    ratio = least_ratio(claim, left, right, curvature=curvature)
    if ratio is None:
        return None
    simple, rounded = Fraction(max(ratio, 0.0)).limit_denominator(200), Fraction(floor(max(ratio, 0.0) * 1000), 1000)
    proved = (factor for factor in (simple, rounded) if _is_proved(_scaled(claim, left, right, factor), curvature))
    factor = next(proved, None)
    if factor is None:
        return None
    above = find_witness(_scaled(claim, left, right, factor + _STEP), curvature=curvature)
    return Weakened(curvature=curvature if claim.kind.is_parametric else None, factor=factor, is_best=above is not None)


def _is_proved(claim: Claim, curvature: Fraction | None) -> bool:
    proofs = (find_proof(claim, feasible=feasible, curvature=curvature) for feasible in (True, False))
    return any(proof is not None for proof in proofs)


def _scaled(claim: Claim, left: Linear, right: Linear, factor: Fraction) -> Claim:
    conclusion = left - right * constant(factor)
    return Claim(kind=claim.kind, ground=claim.ground, premises=claim.premises, conclusion=conclusion)
