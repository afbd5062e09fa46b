"""The checker of counterexamples can say no: each field corrupted, the fault named."""

from dataclasses import replace
from fractions import Fraction

import pytest

from ratt_audit.engine.claim import Inequality
from ratt_audit.engine.decide import Decision, decide
from ratt_audit.engine.evidence import check_witness
from ratt_opt import ProofError
from tests.ratt_audit.engine.abc_claims import ND, claim, f


def a_refutation() -> Decision:
    premise = Inequality("f(a) >= f(b)", f("a") - f("b"))
    decision = decide(claim(ND, f("a") + f("b") - f("a", "b"), premise))
    assert decision.witness is not None
    return decision


def test_the_checker_rejects_corrupted_witnesses() -> None:
    decision = a_refutation()
    witness = decision.witness
    assert witness is not None
    check_witness(decision.claim, witness)
    values = list(witness.values)
    swapped = [*values]
    swapped[1], swapped[2] = 0, 10 * max(values)
    corrupted = [
        (replace(witness, names=("a", "b", "x")), "other elements"),
        (replace(witness, values=(1, *values[1:])), "not normalised"),
        (replace(witness, values=(*values[:-1], -1)), "non-decreasing"),
        (replace(witness, values=tuple(swapped)), "decreasing|curvature|premise"),
        (replace(witness, curvature=Fraction(1, 1000)), "curvature exceeds"),
        (replace(witness, curvature=None), "state its curvature"),
        (replace(witness, curvature=Fraction(1)), "state its curvature"),
        (replace(witness, violation=witness.violation + 1), "breaks the claim by"),
        (replace(witness, values=(0, 1, 1, 2, 1, 2, 2, 3)), "does not break"),
    ]
    for wrong, fault in corrupted:
        with pytest.raises(ProofError, match=fault):
            check_witness(decision.claim, wrong)
