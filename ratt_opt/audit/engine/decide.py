"""Decide one claim: a checked proof, a checked counterexample, or an open question."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.prover import find_proof
from ratt_opt.audit.engine.refuter import LARGEST_GROUND, find_witness

if TYPE_CHECKING:
    from ratt_opt.audit.engine.claim import Claim
    from ratt_opt.audit.engine.counterexample import Witness
    from ratt_opt.audit.engine.proof import Proof

__all__ = ["CURVATURE_GRID", "Decision", "Verdict", "curvatures_tried", "decide"]

CURVATURE_GRID = tuple(Fraction(i, 4) for i in (2, 1, 3))
"""Curvatures tried for counterexamples, and for proofs where none covers all values at once."""


class Verdict(Enum):
    """What was established; the texts are those of the ledger."""

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
        """For which curvatures the verdict holds."""
        if not self.claim.function_class.is_parametric:
            return "no curvature in the claim"
        symbol = self.claim.symbol
        if self.witness is not None:
            return f"{symbol} = {self.witness.curvature}"
        if self.proofs and self.proofs[0].curvature is None:
            return f"all {symbol} in [0, 1]"
        return f"grid {symbol} in {{{', '.join(str(v) for v in sorted(CURVATURE_GRID))}}}"


def curvatures_tried(claim: Claim) -> tuple[Fraction | None, ...]:
    """The grid, or the one ``None`` where the class has no curvature."""
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
        each = (find_proof(claim, feasible=feasible, curvature=curvature) for feasible in (True, False))
        proof = next((found for found in each if found is not None), None)
        if proof is None:
            searched = claim.ground.n <= LARGEST_GROUND
            return Decision(claim=claim, verdict=Verdict.NO_VIOLATION if searched else Verdict.UNDECIDED)
        proofs.append(proof)
    return Decision(claim=claim, verdict=Verdict.PROVED, proofs=tuple(proofs))
