"""Claims with known answers: proved, refuted, or settled on the grid only."""

import pickle
from dataclasses import replace
from fractions import Fraction

import pytest

from ratt_audit.appendix.roles import Team
from ratt_audit.engine.claim import Claim, Inequality, Linear
from ratt_audit.engine.decide import Verdict, decide
from ratt_audit.engine.evidence import check_proof
from ratt_audit.engine.polynomials import ONE, T, constant
from ratt_audit.engine.prover import find_proof
from ratt_audit.engine.refuter import find_witness
from ratt_opt import ProofError
from ratt_opt.worst_ratio.function_class import FunctionClass
from tests.ratt_audit.engine.abc_claims import ABC, ANY, ND, SUB, claim, f

SUBADDITIVE = f("a") + f("b") + f("c") - f("a", "b", "c")


@pytest.mark.parametrize(
    ("kind", "conclusion"),
    [
        (FunctionClass.SUBMODULAR, SUBADDITIVE),
        (SUB, SUBADDITIVE),
        (SUB, f("a", "b") - f("b") - (f("a", "c") - f("c")) * T),  # c = k: marginals of a differ by 1-k at most
        (SUB, f("a", "b", "c") - (f("a") + f("b") + f("c")) * T),
        (ND, f("a", "b") - (f("a") + f("b")) * T),
        (ND, f("a") + f("b") - f("a", "b") * T),
        (ANY, f("a", "b") - f("a")),
    ],
)
def test_true_claims_are_proved_for_every_curvature(kind: FunctionClass, conclusion: Linear) -> None:
    decision = decide(claim(kind, conclusion))
    assert decision.verdict is Verdict.PROVED
    assert [proof.curvature for proof in decision.proofs] == [None]
    check_proof(decision.claim, decision.proofs[0])


@pytest.mark.parametrize(
    ("kind", "conclusion"),
    [
        (ANY, f("a", "c") - f("c") - (f("a", "b", "c") - f("b", "c"))),  # every monotone function is submodular
        (ND, f("a") + f("b") - f("a", "b")),
        (SUB, f("a", "b") - f("a") - f("b")),
        (SUB, f("a") - f("b")),
        (FunctionClass.SUBMODULAR, f("a", "b") - (f("a") + f("b")) * constant(Fraction(51, 100))),
    ],
)
def test_false_claims_are_refuted_by_a_function_the_library_can_evaluate(
    kind: FunctionClass, conclusion: Linear
) -> None:
    decision = decide(claim(kind, conclusion))
    assert decision.verdict is Verdict.REFUTED
    witness = decision.witness
    assert witness is not None
    function = witness.function()
    t = 1 - (witness.curvature or Fraction(0))
    value = sum(float(c(t)) * function(ABC.members(key)) for key, c in conclusion.terms.items() if isinstance(key, int))
    assert value == pytest.approx(-float(witness.violation))
    assert value < 0


def greedy_claim(factor: Fraction) -> Claim:
    team = Team((), ("g1", "g2"))
    conclusion = team.chosen(team.greedy) - team.compared(team.greedy) * constant(factor)
    kind = FunctionClass.SUBMODULAR
    return team.claim(kind, conclusion)


def test_greedy_keeps_half_and_no_more_for_every_submodular_function() -> None:
    assert decide(greedy_claim(Fraction(1, 2))).verdict is Verdict.PROVED
    assert decide(greedy_claim(Fraction(501, 1000))).verdict is Verdict.REFUTED


def test_a_proof_at_one_curvature_says_so_and_fails_at_another() -> None:
    question = claim(ND, f("a") + f("b") - f("a", "b") * constant(Fraction(1, 2)))
    proof = find_proof(question, feasible=True, curvature=Fraction(1, 2))
    assert proof is not None
    assert proof.curvature == Fraction(1, 2)
    with pytest.raises(ProofError):
        check_proof(question, replace(proof, curvature=Fraction(3, 4)))
    assert find_proof(question, feasible=True, curvature=Fraction(3, 4)) is None
    assert find_witness(question, curvature=Fraction(3, 4)) is not None


def test_a_claim_that_holds_on_the_grid_only_is_not_proved_for_all_curvatures() -> None:
    """(1-c)(4c-1)(4c-2)(4c-3)^2 f(a) - like factors: non-negative on the grid, negative between its points."""
    c = ONE - T
    quartered = [c - constant(Fraction(i, 4)) for i in (1, 2, 3)]
    sign = quartered[0] * quartered[1] * quartered[2]
    decision = decide(claim(ND, f("a") * sign))
    assert decision.verdict is Verdict.PROVED
    assert decision.scope == "grid c in {1/4, 1/2, 3/4}"


def test_equal_questions_are_one_value_whatever_they_are_called() -> None:
    left, right = f("a") + f("b"), f("b") + f("a")
    first = claim(ND, left - f("a", "b"), Inequality("one reason", f("a")))
    second = replace(claim(ND, right - f("a", "b"), Inequality("another", f("a"))), sides=(right, f("a", "b")))
    assert first == second
    assert hash(first) == hash(second)
    assert first != claim(ND, left - f("a", "b"))
    assert pickle.loads(pickle.dumps(decide(first))) == decide(first)
