"""The JSON data of ``audit.json``, typed, also for ledgers read from disk, and an entry's record from its decision."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NotRequired, TypedDict, cast

from ratt_audit.appendix.printed import equation_number
from ratt_audit.engine.evidence import step_inequality

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_audit.appendix.entry import Entry
    from ratt_audit.appendix.roles import SizedClaim
    from ratt_audit.engine.claim import Claim
    from ratt_audit.engine.decide import BestFactor, Decision, Verdict
    from ratt_audit.engine.evidence import Proof, Witness
    from ratt_audit.real_objectives.violations import RealSearch
    from ratt_audit.whole.replay import WholeInstance
    from ratt_audit.whole.search import Decided

__all__ = [
    "ClaimRecord",
    "EntryHead",
    "EntryRecord",
    "FactorRecord",
    "InstanceRecord",
    "LedgerDocument",
    "OtherEntry",
    "RealRecord",
    "WholeRecord",
    "WitnessRecord",
    "WorstRecord",
    "begun",
    "claim_record",
    "factor_record",
    "real_record",
    "whole_record",
]  # fmt: skip


class ProofRecord(TypedDict):
    """A proof; a step is [multiplier, reason, inequality], and the steps sum to the claim.

    ``curvature`` : the one value it holds for, ``None`` for all; ``curvature_domain`` : feasible sets or all sets.
    """

    curvature: str | None
    curvature_domain: str
    steps: list[list[str]]


class WitnessRecord(TypedDict):
    """A function that breaks a claim: its values on all subsets, by bit mask over ``elements``.

    ``ratt_chooses_the_roles`` : whether RATT itself, run on the function with this many baits,
    picks the elements named as its choices (``None`` if the elements have no roles).
    """

    elements: list[str]
    robot: list[int]
    values: list[int]
    values_in_play: dict[str, int]
    auxiliary: dict[str, str]
    curvature: str | None
    violation: str
    premises: list[str]
    ratt_chooses_the_roles: bool | None


class ClaimRecord(TypedDict):
    """One size of an entry with its proof or counterexample."""

    size: str
    robots: int
    claim: str
    premises: int
    verdict: str
    scope: str
    proofs: list[ProofRecord]
    witness: WitnessRecord | None


FactorRecord = TypedDict(
    "FactorRecord", {"curvature": "str | None", "factor": "str", "cannot_exceed_by_1/1000": "bool"}
)
"""Best factor of a refuted step at one curvature."""


class WorstRecord(TypedDict):
    """The worst EKF instance, complete: the scenario file's content, the roles, and the sign of the violation."""

    origin: str
    claim: str
    relative_violation: float
    violated_exactly: bool
    elements: dict[str, int]
    scenario: dict[str, Any]


class RealRecord(TypedDict):
    """Findings from trying an entry on EKF objectives."""

    objective: str
    section_vi_instances: int
    section_vi_violations: int
    worst: WorstRecord | None


class OtherEntry(TypedDict):
    """Other entry, ``label/kind`` or ``label/kind/reading``, and its verdict (``None`` if readings differ)."""

    entry: str
    verdict: str | None


class EntryHead(TypedDict):
    """Statement of an entry, and how it was decided. ``equation`` : its number in the paper; older files lack it."""

    label: str
    equation: NotRequired[int | None]
    kind: str
    chain: str
    reading: str
    statement: str
    hypotheses: str
    decided_by: str
    verdict: str


class EntryRecord(EntryHead):
    """One entry with its evidence.

    ``detail``, ``counterexamples`` : of entries decided by enumeration; ``function_class``, ``curvature`` : of the
    others, and, if they were looked for, ``best_factors``, ``realistic`` and ``follows_from``.
    """

    sizes: str
    claims: list[ClaimRecord]
    seconds: float
    detail: NotRequired[str]
    counterexamples: NotRequired[list[str]]
    function_class: NotRequired[str]
    curvature: NotRequired[list[str]]
    best_factors: NotRequired[list[FactorRecord]]
    realistic: NotRequired[RealRecord | None]
    follows_from: NotRequired[str | None]
    conclusion_without_it: NotRequired[OtherEntry]
    weaker_step_that_serves: NotRequired[OtherEntry]


class InstanceRecord(TypedDict):
    """A whole instance: values on all subsets by bit mask over ``elements``, budgets, plans, a worst attack.

    ``robot`` : owner of each element; ``groups`` : those that the attack leaves, blinded robots included.
    ``line`` : what the line says here, and ``violation`` how much it lacks.
    """

    n_robots: int
    alpha_s: int
    alpha_c: int
    elements: list[str]
    robot: list[int]
    values: list[int]
    curvature: str
    plan: list[int]
    bait: list[int]
    optimal: list[int]
    sensing: list[int]
    links: list[list[int]]
    groups: list[list[int]]
    ratt_worst: float
    optimum: float
    line: str
    values_in_play: dict[str, int]
    violation: str


class WholeTeamRecord(TypedDict):
    """One team on which a line was decided among whole instances."""

    team: str
    verdict: str


class WholeRecord(TypedDict):
    """A refuted line among whole instances, on teams in order of size until one refutes it.

    ``worst_for`` : the plan whose worst attack A* is.
    """

    label: str
    kind: str
    worst_for: str
    teams: list[WholeTeamRecord]
    instance: InstanceRecord | None


class LedgerDocument(TypedDict):
    """The whole file; older and quick ones lack ``whole_instances``.

    ``whole_searched`` : whether these were searched in this run, or re-checked from an earlier search.
    """

    format: str
    complete: bool
    quick: bool
    curvature_grid: list[str]
    counts: dict[str, int]
    seconds: float
    entries: list[EntryRecord]
    whole_instances: NotRequired[list[WholeRecord]]
    whole_searched: NotRequired[bool]


def begun(entry: Entry, verdict: Verdict, decided_by: str) -> EntryRecord:
    """A record without its evidence, which the caller adds in the order of the file."""
    head: EntryHead = {
        "label": entry.label,
        "equation": equation_number(entry.label),
        "kind": entry.kind.value,
        "chain": entry.chain,
        "reading": entry.reading,
        "statement": entry.statement,
        "hypotheses": entry.hypotheses,
        "decided_by": decided_by,
        "verdict": verdict.value,
    }
    return cast("EntryRecord", head)


def claim_record(sized: SizedClaim, decision: Decision, chooses_roles: bool | None) -> ClaimRecord:
    """One size with its evidence; ``chooses_roles`` as in :class:`WitnessRecord`."""
    claim = sized.claim
    return {
        "size": sized.size,
        "robots": sized.robots,
        "claim": claim.text(),
        "premises": len(claim.premises),
        "verdict": decision.verdict.value,
        "scope": decision.scope,
        "proofs": [_proof(claim, proof) for proof in decision.proofs],
        "witness": None if decision.witness is None else _witness(claim, decision.witness, chooses_roles),
    }


def _proof(claim: Claim, proof: Proof) -> ProofRecord:
    """Multiplier, reason and inequality of every step; the steps sum to the claim."""
    steps = []
    for step in proof.steps:
        inequality = step_inequality(claim, step)
        multiplier = step.multiplier.form_text(claim.function_class.symbol)
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


def factor_record(best: BestFactor) -> FactorRecord:
    """The best factor at one curvature."""
    curvature = None if best.curvature is None else str(best.curvature)
    return {"curvature": curvature, "factor": str(best.factor), "cannot_exceed_by_1/1000": best.is_best}


def real_record(found: RealSearch) -> RealRecord:
    """Findings from trying an entry on EKF objectives, complete: the worst instance can be replayed from it."""
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


def whole_record(entry: Entry, worst_for: str, decided: Sequence[Decided]) -> WholeRecord:
    """Record the decisions about one refuted line among whole instances."""
    found = decided[-1].instance if decided else None
    return {
        "label": entry.label,
        "kind": entry.kind.value,
        "worst_for": worst_for,
        "teams": [{"team": each.whole.text(), "verdict": each.verdict.value} for each in decided],
        "instance": None if found is None else _instance(found),
    }


def _instance(found: WholeInstance) -> InstanceRecord:
    index = {robot: i for i, robot in enumerate(found.whole.team.robots)}
    return {
        "n_robots": len(index),
        "alpha_s": found.whole.alpha_s,
        "alpha_c": found.whole.alpha_c,
        "elements": list(found.names),
        "robot": list(found.robot),
        "values": list(found.values),
        "curvature": found.curvature,
        "plan": list(found.plan),
        "bait": list(found.bait),
        "optimal": list(found.optimal),
        "sensing": sorted(found.attack.sensing),
        "links": sorted(list(link) for link in found.attack.links),
        "groups": [[index[robot] for robot in group] for group in found.whole.groups],
        "ratt_worst": found.ratt_worst,
        "optimum": found.optimum,
        "line": found.line,
        "values_in_play": found.in_play,
        "violation": found.violation,
    }
