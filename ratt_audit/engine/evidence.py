"""Proofs and counterexamples of claims, and the exact checks that accept or reject them.

The checks share nothing with the linear programs that find either: a proof is rebuilt in rationals from the names of
its inequalities, a counterexample tested in integers against the definitions of its class, set by set.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from ratt_audit.engine.claim import Elementary, Linear, elementary
from ratt_audit.engine.polynomials import LARGEST_FORM
from ratt_opt.errors import ProofError
from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.worst_ratio.function_class import check_class

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ratt_audit.engine.claim import Claim, Ground, Inequality
    from ratt_audit.engine.polynomials import Polynomial

__all__ = ["Proof", "ProofStep", "Witness", "check_proof", "check_witness",
           "step_inequality", "values_of"]  # fmt: skip


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
    """The inequality that a step multiplies; raises ``ProofError`` if it names none."""
    if isinstance(step.source, int):
        if not 0 <= step.source < len(claim.premises):
            raise ProofError(f"premise {step.source} does not exist")
        return claim.premises[step.source]
    return elementary(claim.function_class, claim.ground, step.source)


def check_proof(claim: Claim, proof: Proof) -> None:
    """Accept a proof or raise ``ProofError`` with its first fault.

    A step is no inequality of the claim, a multiplier may be negative, or the sum is not the claim.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Witness:
    """An explicit function that breaks a claim.

    ``values[mask]`` : (2**n,) integers; ``auxiliary`` : the claim's other numbers;
    ``curvature`` : the bound it respects (``None`` for classes without one);
    ``violation`` : minus the value of the conclusion, positive.
    """

    names: tuple[str, ...]
    values: tuple[int, ...]
    auxiliary: Mapping[str, Fraction]
    curvature: Fraction | None
    violation: Fraction

    def function(self) -> TableFunction:
        """The witness as a set function of the library; element ``e`` is ``names[e]``."""
        return TableFunction([float(v) for v in self.values])


def values_of(values: tuple[int, ...], auxiliary: Mapping[str, Fraction]) -> dict[int | str, Fraction]:
    """Function values by bit mask and the other numbers by name, as expressions ask for them."""
    known: dict[int | str, Fraction] = {mask: Fraction(v) for mask, v in enumerate(values)}
    return known | dict(auxiliary)


def check_witness(claim: Claim, witness: Witness) -> None:
    """Accept a counterexample or raise ``ProofError`` with its first fault.

    The function is not of the class, breaks a premise, or does not break the claim.
    """
    if witness.names != claim.ground.names or len(witness.values) != 1 << claim.ground.n:
        raise ProofError("the witness is on other elements than the claim")
    if claim.function_class.is_parametric and not (witness.curvature is not None and 0 <= witness.curvature < 1):
        raise ProofError("the witness does not state its curvature bound in [0, 1)")
    check_class(claim.function_class, np.array(witness.values, dtype=object), witness.curvature)
    known = values_of(witness.values, witness.auxiliary)
    t = 1 - (witness.curvature or Fraction(0))
    for premise in claim.premises:
        if premise.expression.value(known, t) < 0:
            raise ProofError(f"the witness breaks the premise '{premise.reason}'")
    value = claim.conclusion.value(known, t)
    if value >= 0:
        raise ProofError("the witness does not break the claim")
    if value != -witness.violation:
        raise ProofError(f"the witness breaks the claim by {-value}, not by {witness.violation}")
