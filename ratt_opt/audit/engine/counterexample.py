"""Counterexamples of claims, and the exact check that accepts or rejects them.

A counterexample is tested in integers against the definitions of its class, set by set; the check shares
nothing with the linear programs that find counterexamples.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.claim import FunctionClass
from ratt_opt.errors import ProofError
from ratt_opt.setfunctions.table import TableFunction

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ratt_opt.audit.engine.claim import Claim

__all__ = ["Witness", "check_class", "check_witness", "values_of"]


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
    known.update(auxiliary)
    return known


def check_witness(claim: Claim, witness: Witness) -> None:
    """Accept a counterexample or name its first fault.

    Raises
    ------
    ProofError : the function is not of the class, breaks a premise, or does not break the claim.
    """
    if witness.names != claim.ground.names or len(witness.values) != 1 << claim.ground.n:
        raise ProofError("the witness is on other elements than the claim")
    if claim.function_class.is_parametric and not (witness.curvature is not None and 0 <= witness.curvature < 1):
        raise ProofError("the witness does not state its curvature bound in [0, 1)")
    check_class(claim.function_class, witness.values, claim.ground.n, witness.curvature)
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


def check_class(function_class: FunctionClass, values: tuple[int, ...], n: int, curvature: Fraction | None) -> None:
    """Test the definitions of ``function_class`` on a full integer table.

    Raises
    ------
    ProofError : naming the property that fails and where.
    """
    if values[0] != 0:
        raise ProofError("the function is not normalised")
    if function_class is FunctionClass.ANY:
        return
    full = (1 << n) - 1
    for x in range(n):
        bit = 1 << x
        marginals = {s: values[s | bit] - values[s] for s in range(1 << n) if not s & bit}
        if min(marginals.values()) < 0:
            raise ProofError(f"the function is not non-decreasing in element {x}")
        if function_class.is_submodular:
            _check_diminishing(marginals, x, n)
        if curvature is None or not function_class.is_parametric:
            continue
        largest = values[bit] if function_class is FunctionClass.CURVATURE else max(marginals.values())
        least = marginals[full ^ bit] if function_class is FunctionClass.CURVATURE else min(marginals.values())
        if least < (1 - curvature) * largest:
            raise ProofError(f"the function's curvature exceeds {curvature} at element {x}")


def _check_diminishing(marginals: dict[int, int], x: int, n: int) -> None:
    for base, marginal in marginals.items():
        for y in range(n):
            larger = base | 1 << y
            if y != x and larger != base and marginals[larger] > marginal:
                raise ProofError(f"the function is not submodular: element {x} at sets {base} and {larger}")
