"""The cone: claims with known answers, its elementary inequalities, and checkers that can say no."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from ratt_opt.audit.appendix.roles import Team
from ratt_opt.audit.engine.claim import Claim, FunctionClass, Ground, Inequality, Linear
from ratt_opt.audit.engine.cone import Elementary, elementary, elementary_keys
from ratt_opt.audit.engine.counterexample import check_class, check_witness
from ratt_opt.audit.engine.decide import Decision, Verdict, decide
from ratt_opt.audit.engine.polynomial import ONE, T, constant
from ratt_opt.audit.engine.proof import ProofStep, check_proof
from ratt_opt.audit.engine.prover import find_proof
from ratt_opt.audit.engine.refuter import find_witness
from ratt_opt.errors import ProofError

ABC = Ground(("a", "b", "c"), (0, 1, 2))
ANY, ND, SUB = FunctionClass.NON_DECREASING, FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE


def f(*names: str) -> Linear:
    return Linear.of(ABC.mask(names))


def claim(kind: FunctionClass, conclusion: Linear, *premises: Inequality) -> Claim:
    return Claim(function_class=kind, ground=ABC, premises=premises, conclusion=conclusion)


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


def in_class(kind: FunctionClass, values: tuple[int, ...], curvature: Fraction) -> bool:
    try:
        check_class(kind, values, 3, curvature)
    except ProofError:
        return False
    return True


def satisfies_elementary(kind: FunctionClass, values: tuple[int, ...], curvature: Fraction) -> bool:
    """All elementary inequalities of the class hold, with m(x) the largest marginal."""
    known: dict[int | str, Fraction] = {mask: Fraction(v) for mask, v in enumerate(values)}
    for x, name in enumerate(ABC.names):
        marginals = [values[s | 1 << x] - values[s] for s in range(8) if not s >> x & 1]
        known[f"m({name})"] = Fraction(max(marginals))
    keys = elementary_keys(kind, ABC, feasible=False)
    return all(elementary(kind, ABC, key).expression.value(known, 1 - curvature) >= 0 for key in keys)


@pytest.mark.parametrize("kind", [ANY, ND, FunctionClass.SUBMODULAR, SUB])
def test_elementary_inequalities_hold_exactly_on_the_class(kind: FunctionClass) -> None:
    """Integer tables near a modular one, on both sides of the class's border: definition against inequalities."""
    rng = np.random.default_rng(5)
    seen = {True: 0, False: 0}
    sizes = [bin(mask).count("1") for mask in range(8)]
    for _ in range(1500):
        base = [0, 4, 7, 9] if rng.integers(0, 2) else [0, 3, 6, 9]
        noise = int(rng.integers(1, 4))
        values = tuple(int(base[size] + (rng.integers(-noise, noise + 1) if size else 0)) for size in sizes)
        expected = in_class(kind, values, Fraction(2, 3))
        seen[expected] += 1
        assert satisfies_elementary(kind, values, Fraction(2, 3)) == expected
    assert min(seen.values()) > 20
