"""Records of the ledger: an entry, its verdict and its evidence as JSON data."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.audit.engine.proof import step_inequality
from ratt_opt.problem import Problem
from ratt_opt.solvers.ratt import bait_and_greedy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.audit.appendix.entry import Counted, Entry, EnumeratedEntry, SizedClaim
    from ratt_opt.audit.appendix.roles import Team
    from ratt_opt.audit.engine.best_factor import Weakened
    from ratt_opt.audit.engine.claim import Claim
    from ratt_opt.audit.engine.decide import Decision, Verdict
    from ratt_opt.audit.engine.proof import Proof, Witness

__all__ = ["claim_record", "enumerated_record", "factor_records", "replays"]

Record = dict[str, object]


def _head(entry: Entry | EnumeratedEntry, verdict: Verdict, decided_by: str) -> Record:
    return {
        "label": entry.label,
        "kind": entry.kind,
        "chain": entry.chain,
        "reading": entry.reading,
        "statement": entry.statement,
        "hypotheses": entry.hypotheses,
        "decided_by": decided_by,
        "verdict": verdict.value,
    }


def enumerated_record(entry: EnumeratedEntry, counted: Counted, *, seconds: float) -> Record:
    """Record of an entry decided by enumeration; ``witness`` holds the first cases that break it."""
    record = _head(entry, counted.verdict, "exhaustive enumeration")
    record.update(
        sizes=counted.sizes,
        detail=counted.detail,
        counterexamples=list(counted.cases),
        claims=[],
        survives_by=entry.survives_by,
        serves_by=entry.serves_by,
        seconds=seconds,
    )
    return record


def claim_record(
    entry: Entry,
    claims: Sequence[SizedClaim],
    decisions: Sequence[Decision],
    verdict: Verdict,
) -> Record:
    """Record of an entry decided by the cone: every size with its proof or counterexample."""
    record = _head(entry, verdict, "linear programming over the set-function cone, re-checked exactly")
    kind = claims[0].claim.kind
    robots = sorted({sized.robots for sized in claims})
    record.update(
        function_class=kind.value,
        sizes=f"for all functions of the class, {robots[0]} to {robots[-1]} robots in play, {len(claims)} cases",
        curvature=sorted({decision.scope for decision in decisions}),
        claims=[_sized(sized, decision) for sized, decision in zip(claims, decisions, strict=True)],
        survives_by=entry.survives_by,
        serves_by=entry.serves_by,
    )
    return record


def factor_records(weaker: Sequence[Weakened]) -> list[Record]:
    """Best factors of a refuted step as JSON data."""
    return [
        {
            "curvature": None if w.curvature is None else str(w.curvature),
            "factor": str(w.factor),
            "cannot_exceed_by_1/1000": w.is_best,
        }
        for w in weaker
    ]


def _sized(sized: SizedClaim, decision: Decision) -> Record:
    claim = sized.claim
    return {
        "size": sized.size,
        "robots": sized.robots,
        "claim": f"{claim.conclusion.text(claim.ground, claim.kind.symbol)} >= 0",
        "premises": len(claim.premises),
        "verdict": decision.verdict.value,
        "scope": decision.scope,
        "proofs": [_proof(claim, proof) for proof in decision.proofs],
        "witness": None if decision.witness is None else _witness(sized, decision.witness),
    }


def _proof(claim: Claim, proof: Proof) -> Record:
    """Multiplier, reason and inequality of every step; the steps sum to the claim."""
    steps = []
    for step in proof.steps:
        inequality = step_inequality(claim, step)
        steps.append(
            [
                step.multiplier.form_text(claim.kind.symbol),
                inequality.reason,
                f"{inequality.expression.text(claim.ground, claim.kind.symbol)} >= 0",
            ]
        )
    return {
        "curvature": None if proof.curvature is None else str(proof.curvature),
        "curvature_domain": "feasible sets" if proof.feasible else "all sets",
        "steps": steps,
    }


def _witness(sized: SizedClaim, witness: Witness) -> Record:
    """The function's values on all subsets, by bit mask over ``elements``.

    ``ratt_chooses_the_roles`` : whether RATT itself, run on the function with this many baits,
    picks the elements named as its choices (``None`` where the elements have no roles).
    """
    claim = sized.claim
    return {
        "elements": list(witness.names),
        "robot": list(claim.ground.owner),
        "values": list(witness.values),
        "values_in_play": {claim.ground.text(mask): witness.values[mask] for mask in _sets_in_play(claim)},
        "auxiliary": {name: str(value) for name, value in witness.auxiliary.items()},
        "curvature": None if witness.curvature is None else str(witness.curvature),
        "violation": str(witness.violation),
        "premises": [premise.reason for premise in claim.premises],
        "ratt_chooses_the_roles": None if sized.team is None else replays(sized.team, witness),
    }


def _sets_in_play(claim: Claim) -> list[int]:
    """Sets whose values the claim or its premises speak of, by bit mask."""
    expressions = [claim.conclusion, *(premise.expression for premise in claim.premises)]
    return sorted({key for expression in expressions for key in expression.terms if isinstance(key, int)})


def replays(team: Team, witness: Witness) -> bool:
    """Run RATT's bait and greedy rules on the witness: are its choices the elements named as such?"""
    problem = Problem(witness.function(), np.array(team.ground.owner), None, 0, 0)
    plan = bait_and_greedy(problem, len(team.bait))
    return bool((plan.elements == np.arange(len(team.robots))).all())
