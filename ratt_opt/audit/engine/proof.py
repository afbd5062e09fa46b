"""Proofs of claims, and the exact check that accepts or rejects them.

The check uses rational arithmetic only and shares nothing with the linear programs that
find proofs: a proof is rebuilt from the names of its inequalities.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.claim import Linear
from ratt_opt.audit.engine.cone import Elementary, elementary
from ratt_opt.audit.engine.polynomial import LARGEST_FORM
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from fractions import Fraction

    from ratt_opt.audit.engine.claim import Claim, Ground, Inequality
    from ratt_opt.audit.engine.polynomial import Polynomial

__all__ = ["Proof", "ProofStep", "check_proof", "step_inequality"]


@dataclass(frozen=True, slots=True)
class ProofStep:
    """``multiplier`` times one inequality: ``source`` names an elementary one, or is the index of a premise."""

    source: Elementary | int
    multiplier: Polynomial


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """The steps sum to the claim's conclusion.

    ``curvature`` : the one value it holds for; ``None`` when it holds for all in [0, 1].
    ``feasible`` : uses only sets with one element per robot.
    """

    steps: tuple[ProofStep, ...]
    curvature: Fraction | None
    feasible: bool


def step_inequality(claim: Claim, step: ProofStep) -> Inequality:
    """The inequality that a step multiplies.

    Raises
    ------
    ProofError : the step names none.
    """
    if isinstance(step.source, int):
        if not 0 <= step.source < len(claim.premises):
            raise ProofError(f"premise {step.source} does not exist")
        return claim.premises[step.source]
    return elementary(claim.function_class, claim.ground, step.source)


def check_proof(claim: Claim, proof: Proof) -> None:
    """Accept a proof or name its first fault.

    Raises
    ------
    ProofError : a step is no inequality of the claim, a multiplier may be negative, or the sum is not the claim.
    """
    total = Linear()
    t = None if proof.curvature is None else 1 - proof.curvature
    for number, step in enumerate(proof.steps):
        _check_multiplier(number, step.multiplier, t)
        inequality = step_inequality(claim, step)
        if proof.feasible and isinstance(step.source, Elementary):
            _check_feasible(claim.ground, number, inequality)
        total = total + inequality.expression * step.multiplier
    difference = claim.conclusion - total
    if t is None and difference.terms:
        raise ProofError(f"the steps do not sum to the claim: {difference.text(claim.ground, 'c')} is left")
    if t is not None and any(coefficient(t) for coefficient in difference.terms.values()):
        raise ProofError(f"the steps do not sum to the claim at curvature {proof.curvature}")


def _check_multiplier(number: int, multiplier: Polynomial, t: Fraction | None) -> None:
    values = multiplier.form(max(multiplier.degree, LARGEST_FORM)) if t is None else (multiplier(t),)
    if any(value < 0 for value in values):
        raise ProofError(f"the multiplier of step {number} may be negative")


def _check_feasible(ground: Ground, number: int, inequality: Inequality) -> None:
    for key in inequality.expression.terms:
        if isinstance(key, int) and not ground.is_feasible(key):
            raise ProofError(f"step {number} uses {ground.text(key)}, which has two elements of one robot")
