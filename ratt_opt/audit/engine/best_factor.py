"""What is left of a refuted step: the best factor for which ``left >= factor * right`` still holds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import floor
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.decide import curvatures_tried
from ratt_opt.audit.engine.polynomial import constant
from ratt_opt.audit.engine.prover import find_proof
from ratt_opt.audit.engine.refuter import find_witness, least_ratio

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.audit.engine.claim import Claim

__all__ = ["BestFactor", "best_factors"]

STEP = Fraction(1, 1000)
"""A factor is the best when this much more is refuted: the ledger prints factors to three digits."""
SIMPLE = 200
"""Denominators up to here are tried before the digits: the best factors are simple fractions of the curvature's."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BestFactor:
    """``left >= factor * right`` is proved at ``curvature``; ``is_best``: with ``factor + 1/1000`` it is refuted.

    Factor 0 is trivial: no positive factor was found.
    """

    curvature: Fraction | None
    factor: Fraction
    is_best: bool


def best_factors(refuted: Sequence[Claim]) -> tuple[BestFactor, ...]:
    """Return, at each curvature of the grid, the best factor that was found and checked for all of these claims."""
    if not refuted or any(claim.sides is None for claim in refuted):
        return ()
    grid = sorted(curvatures_tried(refuted[0]), key=lambda curvature: curvature or 0)
    found = (_for_all(refuted, curvature) for curvature in grid)
    return tuple(item for item in found if item is not None)


def _for_all(refuted: Sequence[Claim], curvature: Fraction | None) -> BestFactor | None:
    """The smallest factor: every value in a claim is non-negative, so it serves the other claims too."""
    each = []
    for claim in refuted:
        found = _at(claim, curvature)
        if found is None:
            return None
        each.append(found)
        if found.factor == 0:
            break
    return min(each, key=lambda found: found.factor)


def _at(claim: Claim, curvature: Fraction | None) -> BestFactor | None:
    assert claim.sides is not None
    least = least_ratio(claim, *claim.sides, curvature=curvature)
    if least is None:
        return None
    ratio = max(least, 0.0)
    tried = (Fraction(ratio).limit_denominator(SIMPLE), floor(ratio * STEP.denominator) * STEP)
    factor = next((factor for factor in tried if _is_proved(_scaled(claim, factor), curvature)), None)
    if factor is None:
        return None
    above = find_witness(_scaled(claim, factor + STEP), curvature=curvature)
    at = curvature if claim.function_class.is_parametric else None
    return BestFactor(curvature=at, factor=factor, is_best=above is not None)


def _is_proved(claim: Claim, curvature: Fraction | None) -> bool:
    return any(find_proof(claim, feasible=feasible, curvature=curvature) is not None for feasible in (True, False))


def _scaled(claim: Claim, factor: Fraction) -> Claim:
    assert claim.sides is not None
    left, right = claim.sides
    return replace(claim, conclusion=left - right * constant(factor))
