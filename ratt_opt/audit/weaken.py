"""What is left of a refuted step: the best factor for which ``left >= factor * right`` still holds."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from ratt_opt.audit.decide import CURVATURE_GRID
from ratt_opt.audit.language import Claim
from ratt_opt.audit.polynomial import constant
from ratt_opt.audit.prove import find_proof
from ratt_opt.audit.refute import find_witness, least_ratio

if TYPE_CHECKING:
    from ratt_opt.audit.entry import SizedClaim
    from ratt_opt.audit.language import Linear

__all__ = ["Weakened", "weaken"]

_STEP = Fraction(1, 1000)


@dataclass(frozen=True, slots=True, kw_only=True)
class Weakened:
    """``left >= factor * right`` is proved at ``curvature``; ``is_best``: with ``factor + 1/1000`` it is refuted."""

    curvature: Fraction | None
    factor: Fraction
    is_best: bool


def weaken(sized: SizedClaim) -> tuple[Weakened, ...]:
    """Return the best factor at each curvature of the grid where one was found and checked; factor 0 is trivial."""
    if sized.left is None or sized.right is None:
        return ()
    kind = sized.claim.kind
    grid: tuple[Fraction | None, ...] = CURVATURE_GRID if kind.is_parametric else (None,)
    found = (_at(sized.claim, sized.left, sized.right, curvature) for curvature in sorted(grid, key=lambda v: v or 0))
    return tuple(item for item in found if item is not None)


def _at(claim: Claim, left: Linear, right: Linear, curvature: Fraction | None) -> Weakened | None:
    ratio = least_ratio(claim, left, right, curvature=curvature)
    if ratio is None:
        return None
    factor = Fraction(max(ratio, 0.0)).limit_denominator(200)
    weaker = _scaled(claim, left, right, factor)
    proof = find_proof(weaker, feasible=True, curvature=curvature) or find_proof(
        weaker, feasible=False, curvature=curvature
    )
    if proof is None:
        return None
    above = find_witness(_scaled(claim, left, right, factor + _STEP), curvature=curvature)
    return Weakened(curvature=curvature if claim.kind.is_parametric else None, factor=factor, is_best=above is not None)


def _scaled(claim: Claim, left: Linear, right: Linear, factor: Fraction) -> Claim:
    conclusion = left - right * constant(factor)
    return Claim(kind=claim.kind, ground=claim.ground, premises=claim.premises, conclusion=conclusion)
