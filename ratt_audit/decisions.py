"""Decide one entry: its verdict with the evidence, as a record of the ledger."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from ratt_audit.appendix.entry import ClaimEntry, EntryKind, EnumeratedEntry
from ratt_audit.engine.decide import Verdict, best_factors, decide
from ratt_audit.real_objectives.violations import search_real_objectives
from ratt_audit.report.records import begun, claim_record, factor_record, real_record
from ratt_opt.problem import Problem
from ratt_opt.solvers.ratt import bait_and_greedy

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_audit.appendix.entry import Detour, Entry
    from ratt_audit.appendix.roles import SizedClaim, Team
    from ratt_audit.engine.claim import Claim
    from ratt_audit.engine.decide import Decision
    from ratt_audit.engine.evidence import Witness
    from ratt_audit.report.records import EntryRecord

__all__ = ["decide_entry"]

ENUMERATED = "exhaustive enumeration"
BY_CONE = "linear programming over the set-function cone, re-checked exactly"
QUICK_ROBOTS = 3


def decide_entry(entry: Entry, *, quick: bool = False) -> EntryRecord:
    """Decide one entry and return its record (JSON data), without what other entries say about it.

    ``quick`` keeps the sizes with at most three robots, else the smallest size, and one case of more than four robots;
    it leaves out best factors and the search on EKF objectives.
    """
    start = time.perf_counter()
    if isinstance(entry, EnumeratedEntry):
        counted = entry.enumerate_cases()
        record = begun(entry, counted.verdict, ENUMERATED)
        record["sizes"], record["detail"] = counted.sizes, counted.detail
        record["counterexamples"], record["claims"] = list(counted.cases), []
    else:
        assert isinstance(entry, ClaimEntry)
        claims = _quick_claims(entry) if quick else entry.claims
        decisions = [decide(sized.claim) for sized in claims]
        record = begun(entry, _verdict(decisions), BY_CONE)
        _add_claims(record, claims, decisions)
        if not quick:
            _add_what_remains(record, entry, [each.claim for each in decisions if each.witness is not None])
    record["seconds"] = time.perf_counter() - start
    return record


def _quick_claims(entry: ClaimEntry) -> tuple[SizedClaim, ...]:
    smallest = min(sized.robots for sized in entry.claims)
    claims = tuple(sized for sized in entry.claims if sized.robots <= max(QUICK_ROBOTS, smallest))
    return claims[:1] if smallest > QUICK_ROBOTS + 1 else claims


def _add_claims(record: EntryRecord, claims: Sequence[SizedClaim], decisions: Sequence[Decision]) -> None:
    robots = [sized.robots for sized in claims]
    record["function_class"] = claims[0].claim.function_class.value
    in_play = f"{min(robots)} to {max(robots)} robots in play, {len(robots)} cases"
    record["sizes"] = f"for all functions of the class, {in_play}"
    record["curvature"] = sorted({decision.scope for decision in decisions})
    record["claims"] = [
        claim_record(sized, decision, _ratt_chooses_the_roles(sized.team, decision.witness))
        for sized, decision in zip(claims, decisions, strict=True)
    ]


def _ratt_chooses_the_roles(team: Team | None, witness: Witness | None) -> bool | None:
    """Run RATT's bait and greedy rules on the witness: are its choices the elements that the claim calls its own?"""
    if team is None or witness is None:
        return None
    problem = Problem(witness.function(), np.array(team.ground.owner), None, 0, 0)
    plan = bait_and_greedy(problem, len(team.bait))
    return bool((plan.elements == np.arange(len(team.robots))).all())


def _verdict(decisions: Sequence[Decision]) -> Verdict:
    """One refuted size refutes; all sizes must be proved to prove."""
    found = {decision.verdict for decision in decisions}
    order = (Verdict.REFUTED, Verdict.UNDECIDED, Verdict.NO_VIOLATION)
    return next((verdict for verdict in order if verdict in found), Verdict.PROVED)


def _add_what_remains(record: EntryRecord, entry: ClaimEntry, broken: Sequence[Claim]) -> None:
    """Best factors of the refuted claims, what EKF objectives say, and the latest earlier line that serves directly."""
    factors = () if entry.kind is EntryKind.AS_WRITTEN else best_factors(broken)
    record["best_factors"] = [factor_record(best) for best in factors]
    real = search_real_objectives(entry.claims, refuted=bool(broken))
    record["realistic"] = None if real is None else real_record(real)
    if broken and entry.detours is not None:
        record["follows_from"] = _latest(entry.detours())


def _latest(detours: Iterator[Detour]) -> str | None:
    """The latest earlier line from which the refuted one is proved directly, at every size."""
    for detour in detours:
        if all(decide(sized.claim).verdict is Verdict.PROVED for sized in detour.claims):
            return detour.start
    return None
