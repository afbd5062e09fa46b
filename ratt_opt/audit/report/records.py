"""From a decided entry to its record in ``audit.json``."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from ratt_opt.audit.engine.proof import step_inequality

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.audit.decided import DecidedClaim, DecidedEntry
    from ratt_opt.audit.engine.best_factor import BestFactor
    from ratt_opt.audit.engine.claim import Claim
    from ratt_opt.audit.engine.counterexample import Witness
    from ratt_opt.audit.engine.proof import Proof
    from ratt_opt.audit.real_objectives.search import RealSearch
    from ratt_opt.audit.report.document import (
        ClaimRecord,
        EntryHead,
        EntryRecord,
        FactorRecord,
        ProofRecord,
        RealRecord,
        WitnessRecord,
        WorstRecord,
    )

__all__ = ["entry_record", "real_record"]

ENUMERATED = "exhaustive enumeration"
BY_CONE = "linear programming over the set-function cone, re-checked exactly"


def entry_record(decided: DecidedEntry) -> EntryRecord:
    """The record of one entry, without what other entries say about it."""
    counted, remains = decided.counted, decided.remains
    if counted is not None:
        record = _begun(decided, ENUMERATED)
        record["sizes"], record["detail"] = counted.sizes, counted.detail
        record["counterexamples"], record["claims"] = list(counted.cases), []
        record["seconds"] = decided.seconds
        return record
    robots = [claim.sized.robots for claim in decided.claims]
    in_play = f"{min(robots)} to {max(robots)} robots in play, {len(robots)} cases"
    record = _begun(decided, BY_CONE)
    record["function_class"] = decided.claims[0].sized.claim.function_class.value
    record["sizes"] = f"for all functions of the class, {in_play}"
    record["curvature"] = sorted({claim.decision.scope for claim in decided.claims})
    record["claims"] = [_claim(claim) for claim in decided.claims]
    if remains is not None:
        record["best_factors"] = _factors(remains.factors)
        record["realistic"] = None if remains.real is None else real_record(remains.real)
        if remains.has_detours:
            record["follows_from"] = remains.follows_from
    record["seconds"] = decided.seconds
    return record


def _begun(decided: DecidedEntry, decided_by: str) -> EntryRecord:
    """A record without its evidence, which the caller adds in the order of the file."""
    entry = decided.entry
    head: EntryHead = {
        "label": entry.label,
        "kind": entry.kind.value,
        "chain": entry.chain,
        "reading": entry.reading,
        "statement": entry.statement,
        "hypotheses": entry.hypotheses,
        "decided_by": decided_by,
        "verdict": decided.verdict.value,
    }
    return cast("EntryRecord", head)


def _claim(decided: DecidedClaim) -> ClaimRecord:
    claim, decision = decided.sized.claim, decided.decision
    return {
        "size": decided.sized.size,
        "robots": decided.sized.robots,
        "claim": claim.text(),
        "premises": len(claim.premises),
        "verdict": decision.verdict.value,
        "scope": decision.scope,
        "proofs": [_proof(claim, proof) for proof in decision.proofs],
        "witness": None if decision.witness is None else _witness(claim, decision.witness, decided.chooses_roles),
    }


def _proof(claim: Claim, proof: Proof) -> ProofRecord:
    """Multiplier, reason and inequality of every step; the steps sum to the claim."""
    steps = []
    for step in proof.steps:
        inequality = step_inequality(claim, step)
        multiplier = step.multiplier.form_text(claim.symbol)
        steps.append([multiplier, inequality.reason, claim.text(inequality.expression)])
    return {
        "curvature": None if proof.curvature is None else str(proof.curvature),
        "curvature_domain": "feasible sets" if proof.feasible else "all sets",
        "steps": steps,
    }


def _witness(claim: Claim, witness: Witness, chooses_roles: bool | None) -> WitnessRecord:
    return {
        "elements": list(witness.names),
        "robot": list(claim.ground.owner),
        "values": list(witness.values),
        "values_in_play": {claim.ground.text(mask): witness.values[mask] for mask in claim.sets},
        "auxiliary": {name: str(value) for name, value in witness.auxiliary.items()},
        "curvature": None if witness.curvature is None else str(witness.curvature),
        "violation": str(witness.violation),
        "premises": [premise.reason for premise in claim.premises],
        "ratt_chooses_the_roles": chooses_roles,
    }


def _factors(found: Iterable[BestFactor]) -> list[FactorRecord]:
    return [
        {
            "curvature": None if best.curvature is None else str(best.curvature),
            "factor": str(best.factor),
            "cannot_exceed_by_1/1000": best.is_best,
        }
        for best in found
    ]


def real_record(found: RealSearch) -> RealRecord:
    """What trying an entry on EKF objectives found, complete: the worst instance can be replayed from it."""
    return {
        "objective": found.objective,
        "section_vi_instances": found.applied,
        "section_vi_violations": found.broken,
        "worst": _worst(found),
    }


def _worst(found: RealSearch) -> WorstRecord | None:
    worst = found.worst
    if worst is None or worst.sized.team is None:
        return None
    return {
        "origin": str(worst.origin),
        "claim": worst.sized.size,
        "relative_violation": worst.violation,
        "violated_exactly": found.violated_exactly,
        "elements": dict(zip(worst.sized.team.ground.names, worst.players, strict=True)),
        "scenario": worst.scenario.model_dump(mode="json"),
    }
