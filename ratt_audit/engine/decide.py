"""Decide one claim: checked proof, checked counterexample or open question; and the rest of a refuted one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cache
from math import floor
from typing import TYPE_CHECKING

from ratt_audit.engine.polynomials import constant
from ratt_audit.engine.prover import find_proof
from ratt_audit.engine.refuter import LARGEST_GROUND, find_witness, least_ratio

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_audit.engine.claim import Claim
    from ratt_audit.engine.evidence import Proof, Witness

__all__ = ["CURVATURE_GRID", "BestFactor", "Decision", "Verdict", "best_factors", "curvatures_tried", "decide"]

CURVATURE_GRID = tuple(Fraction(i, 4) for i in (2, 1, 3))
"""Curvatures tried for counterexamples, and for proofs if none covers all values at once."""


class Verdict(Enum):
    """Verdict on a claim; the texts are those of the ledger."""

    PROVED = "proved"
    REFUTED = "refuted"
    NO_VIOLATION = "no violation found"
    UNDECIDED = "not decidable here"


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """A claim with its verdict and evidence.

    ``proofs`` : one for all curvatures, or one per value of the grid; empty unless proved.
    ``witness`` : present exactly when refuted.
    """

    claim: Claim
    verdict: Verdict
    proofs: tuple[Proof, ...] = ()
    witness: Witness | None = None

    @property
    def scope(self) -> str:
        """Curvatures for which the verdict holds."""
        if not self.claim.function_class.is_parametric:
            return "no curvature in the claim"
        symbol = self.claim.function_class.symbol
        if self.witness is not None:
            return f"{symbol} = {self.witness.curvature}"
        if self.proofs and self.proofs[0].curvature is None:
            return f"all {symbol} in [0, 1]"
        return f"grid {symbol} in {{{', '.join(str(v) for v in sorted(CURVATURE_GRID))}}}"


def curvatures_tried(claim: Claim) -> tuple[Fraction | None, ...]:
    """The grid, or the one ``None`` if the class has no curvature."""
    return CURVATURE_GRID if claim.function_class.is_parametric else (None,)


def decide(claim: Claim) -> Decision:
    """Decide a claim; equal questions are answered once.

    Order: a proof for all curvatures from feasible sets only, a counterexample over all
    sets, a proof over all sets or of higher degree, proofs on the curvature grid.
    """
    return replace(_decide(claim), claim=claim)


@cache
def _decide(claim: Claim) -> Decision:
    proof = find_proof(claim, feasible=True)
    if proof is not None:
        return Decision(claim=claim, verdict=Verdict.PROVED, proofs=(proof,))
    for curvature in curvatures_tried(claim):
        witness = find_witness(claim, curvature=curvature)
        if witness is not None:
            return Decision(claim=claim, verdict=Verdict.REFUTED, witness=witness)
    for feasible, extra in ((False, 0), (True, 1), (True, 2), (False, 1)):
        proof = find_proof(claim, feasible=feasible, extra=extra)
        if proof is not None:
            return Decision(claim=claim, verdict=Verdict.PROVED, proofs=(proof,))
    return _on_grid(claim)


def _on_grid(claim: Claim) -> Decision:
    proofs = []
    for curvature in curvatures_tried(claim):
        proof = _proof_at(claim, curvature)
        if proof is None:
            searched = claim.ground.n <= LARGEST_GROUND
            return Decision(claim=claim, verdict=Verdict.NO_VIOLATION if searched else Verdict.UNDECIDED)
        proofs.append(proof)
    return Decision(claim=claim, verdict=Verdict.PROVED, proofs=tuple(proofs))


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
    least: BestFactor | None = None
    for claim in refuted:
        found = _at(claim, curvature)
        if found is None or found.factor == 0:
            return found
        least = found if least is None or found.factor < least.factor else least
    return least


def _at(claim: Claim, curvature: Fraction | None) -> BestFactor | None:
    assert claim.sides is not None
    least = least_ratio(claim, *claim.sides, curvature=curvature)
    if least is None:
        return None
    ratio = max(least, 0.0)
    tried = (Fraction(ratio).limit_denominator(SIMPLE), floor(ratio * STEP.denominator) * STEP)
    factor = next((factor for factor in tried if _proof_at(_scaled(claim, factor), curvature)), None)
    if factor is None:
        return None
    above = find_witness(_scaled(claim, factor + STEP), curvature=curvature)
    at = curvature if claim.function_class.is_parametric else None
    return BestFactor(curvature=at, factor=factor, is_best=above is not None)


def _proof_at(claim: Claim, curvature: Fraction | None) -> Proof | None:
    each = (find_proof(claim, feasible=feasible, curvature=curvature) for feasible in (True, False))
    return next((found for found in each if found is not None), None)


def _scaled(claim: Claim, factor: Fraction) -> Claim:
    assert claim.sides is not None
    left, right = claim.sides
    return replace(claim, conclusion=left - right * constant(factor))
