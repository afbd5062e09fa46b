"""The checker of proofs can say no: each part corrupted, the fault named."""

from dataclasses import replace
from fractions import Fraction

import pytest

from ratt_audit.engine.claim import Claim, Elementary, Ground, Linear
from ratt_audit.engine.decide import Decision, decide
from ratt_audit.engine.evidence import ProofStep, check_proof
from ratt_audit.engine.polynomials import ONE, T, constant
from ratt_audit.engine.prover import find_proof
from ratt_opt import ProofError
from tests.ratt_audit.engine.abc_claims import ANY, ND, claim, f


def a_proof() -> Decision:
    decision = decide(claim(ND, f("a", "b") - (f("a") + f("b")) * T))
    assert len(decision.proofs[0].steps) >= 2
    return decision


def test_the_checker_rejects_a_missing_step() -> None:
    decision = a_proof()
    proof = decision.proofs[0]
    with pytest.raises(ProofError, match="do not sum"):
        check_proof(decision.claim, replace(proof, steps=proof.steps[1:]))


def test_the_checker_rejects_a_changed_multiplier() -> None:
    decision = a_proof()
    proof = decision.proofs[0]
    wrong = ProofStep(proof.steps[0].source, proof.steps[0].multiplier + constant(Fraction(1, 10**9)))
    with pytest.raises(ProofError, match="do not sum"):
        check_proof(decision.claim, replace(proof, steps=(wrong, *proof.steps[1:])))


def test_the_checker_rejects_a_negative_multiplier_even_if_the_sum_is_right() -> None:
    question = claim(ND, -f("a"))
    steps = (ProofStep(Elementary("monotone", (0,), 0), constant(-1)),)
    decision = a_proof()
    with pytest.raises(ProofError, match="may be negative"):
        check_proof(question, replace(decision.proofs[0], steps=steps))


@pytest.mark.parametrize(
    "key",
    [
        Elementary("curvature", (0,), 2),
        Elementary("made up", (0,), 2),
        Elementary("low", (0,), 1),
        Elementary("low", (0,), 1 << 5),
        Elementary("low", (0, 1), 0),
        7,
    ],
)
def test_the_checker_rejects_inequalities_that_are_not_the_class_s(key: Elementary | int) -> None:
    decision = a_proof()
    proof = replace(decision.proofs[0], steps=(ProofStep(key, ONE),))
    with pytest.raises(ProofError, match=r"no elementary|does not exist"):
        check_proof(decision.claim, proof)


def test_the_checker_rejects_infeasible_sets_in_a_proof_that_claims_feasible_ones() -> None:
    ground = Ground(("a", "b"), (0, 0))
    question = Claim(function_class=ANY, ground=ground, conclusion=Linear.of(3) - Linear.of(1))
    proof = find_proof(question, feasible=False)
    assert proof is not None
    with pytest.raises(ProofError, match="two elements of one robot"):
        check_proof(question, replace(proof, feasible=True))
    assert find_proof(question, feasible=True) is None
