"""The ledger: every entry decided, with its evidence, written as JSON, HTML and Markdown."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from ratt_audit.appendix.entry import ClaimEntry, EntryKind, EnumeratedEntry, entries_of
from ratt_audit.appendix.patterns import pattern1_chains, pattern2_chains, submodular_chains
from ratt_audit.appendix.readings import LEFT_SIDE, dominance_entries, readings_of_sets, readings_of_the_attack
from ratt_audit.appendix.roles import Side
from ratt_audit.appendix.size_theorems import size_theorems
from ratt_audit.appendix.team_lines import team_lines
from ratt_audit.appendix.theorems import closing_lines, lemmas, theorems
from ratt_audit.engine.decide import CURVATURE_GRID, Verdict, best_factors, decide
from ratt_audit.engine.pace import paced
from ratt_audit.enumeration.arrangement_claims import arrangement_entries, smallest_team_entries
from ratt_audit.enumeration.clean_witness import clean_witness_entries
from ratt_audit.enumeration.running_time import running_time_entries
from ratt_audit.enumeration.size_claims import size_entries
from ratt_audit.enumeration.tightness import tightness_entries
from ratt_audit.real_objectives.search import search_real_objectives
from ratt_audit.report.findings import findings
from ratt_audit.report.pages import html_report, markdown_report, per_chain
from ratt_audit.report.records import begun, claim_record, factor_record, real_record, whole_record
from ratt_audit.whole.recorded import recorded_decisions
from ratt_audit.whole.search import WholeSearch, smallest_instance
from ratt_opt._files import output_directory, write_json, write_together
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.errors import InputError
from ratt_opt.problem import Problem
from ratt_opt.running.progress import Step
from ratt_opt.solvers.ratt import bait_and_greedy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from ratt_audit.appendix.entry import Detour, Entry, EntryName
    from ratt_audit.appendix.roles import SizedClaim, Team
    from ratt_audit.engine.claim import Claim
    from ratt_audit.engine.decide import Decision
    from ratt_audit.engine.evidence import Witness
    from ratt_audit.report.findings import Finding
    from ratt_audit.report.records import EntryRecord, LedgerDocument, OtherEntry, WholeRecord
    from ratt_audit.whole.replay import WholeInstance

__all__ = ["FILES", "Ledger", "all_entries", "decide_entry", "run_audit", "whole_instance"]

FILES = ("audit.json", "audit.html", "audit.md")
"""Files that :func:`run_audit` writes."""

FORMAT = "ratt-opt audit, version 1"
ENUMERATED = "exhaustive enumeration"
BY_CONE = "linear programming over the set-function cone, re-checked exactly"
QUICK_ROBOTS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Ledger:
    """All records in the paper's order, as written to ``audit.json``.

    ``complete`` is False when the run was interrupted; the records so far are valid. ``whole_searched`` tells whether
    whole instances were searched; else those of an earlier search were re-checked.
    """

    records: tuple[EntryRecord, ...] = field(repr=False)
    seconds: float
    complete: bool
    quick: bool
    whole_instances: tuple[WholeRecord, ...] = field(default=(), repr=False)
    whole_searched: bool = False

    def counts(self) -> dict[str, int]:
        """Entries per verdict."""
        return {v.value: sum(r["verdict"] == v.value for r in self.records) for v in Verdict}

    def per_chain(self) -> dict[str, dict[str, int]]:
        """Entries per verdict of each chain, in order of appearance, then of all."""
        return per_chain(self.document())

    def findings(self) -> tuple[Finding, ...]:
        """Conclusions from the records, section by section."""
        return findings(self.document())

    def document(self) -> LedgerDocument:
        """The ledger as strict JSON data."""
        return {
            "format": FORMAT,
            "complete": self.complete,
            "quick": self.quick,
            "curvature_grid": [str(value) for value in sorted(CURVATURE_GRID)],
            "counts": self.counts(),
            "seconds": self.seconds,
            "entries": list(self.records),
            "whole_instances": list(self.whole_instances),
            "whole_searched": self.whole_searched,
        }


def all_entries() -> Iterator[Entry]:
    """Yield every entry in the paper's order: readings, Pattern 1, Pattern 2, closing lines, the rest."""
    yield from readings_of_the_attack()
    for one in (*pattern1_chains(), *pattern2_chains(), *submodular_chains()):
        yield from entries_of(one)
    yield from chain(readings_of_sets(), team_lines(), closing_lines(), dominance_entries())
    yield from chain(theorems(), size_theorems(), lemmas())
    yield from chain(arrangement_entries(), smallest_team_entries(), size_entries(), clean_witness_entries())
    yield from chain(tightness_entries(), running_time_entries())


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


def run_audit(
    out: str | Path,
    *,
    quick: bool = False,
    search_whole: bool = False,
    progress: Callable[[int, int, str], object] | None = None,
    time_limit: float | None = None,
    budget: Budget | None = None,
) -> Ledger:
    """Decide every entry and write ``FILES`` to the folder ``out``.

    A keyboard interrupt, or a spent time limit, writes what is decided so far, marked incomplete.

    Parameters
    ----------
    out : folder, created if needed
    quick : only the sizes that take seconds
    search_whole : search whole instances (ten minutes) instead of re-checking those of an earlier search
    progress : called with (entries done, entries in all, label) before each entry
    time_limit : seconds; unlimited by default
    budget : an outer search's budget: its seconds and interrupts count too

    Raises
    ------
    InputError : ``out`` cannot be written.
    """
    folder, own = output_directory(out, *FILES), Budget.inside(budget, time_limit)
    entries: list[Entry] = []
    records: list[EntryRecord] = []
    whole: list[WholeRecord] = []
    with suppress(OutOfBudget), paced(own):
        _decide_all(own, entries, records, quick=quick, progress=progress)
        if not quick and own.stop() is None:
            _decide_whole(own, entries, records, whole, searches=search_whole)
    complete = bool(entries) and len(records) == len(entries) and own.stop() is None
    _add_other_verdicts(entries[: len(records)], records)
    ledger = Ledger(
        records=tuple(records),
        seconds=own.elapsed,
        complete=complete,
        quick=quick,
        whole_instances=tuple(whole),
        whole_searched=search_whole,
    )
    document = ledger.document()
    html, markdown = html_report(document), markdown_report(document)
    writers = (
        lambda file: write_json(file, document),
        lambda file: file.write_text(html, encoding="utf-8"),
        lambda file: file.write_text(markdown, encoding="utf-8"),
    )
    write_together(folder, dict(zip(FILES, writers, strict=True)))
    return ledger


def _decide_all(
    budget: Budget,
    entries: list[Entry],
    records: list[EntryRecord],
    *,
    quick: bool,
    progress: Callable[[int, int, str], object] | None,
) -> None:
    """Fill in the entries, and their records as far as time allows; raises ``OutOfBudget``."""
    try:
        budget.check()
        for entry in all_entries():
            budget.check()
            entries.append(entry)
        with Step("the audit") as step:
            for number, entry in enumerate(entries):
                budget.check()
                step.say(f"{number + 1}/{len(entries)} {entry.label}")
                if progress is not None:
                    progress(number, len(entries), entry.label)
                records.append(decide_entry(entry, quick=quick))
    except KeyboardInterrupt:
        budget.interrupt()


def refuted_lines(entries: Sequence[Entry], records: Sequence[EntryRecord]) -> dict[tuple[str, str], list[ClaimEntry]]:
    """Refuted lines about a plan and an attack, by label and kind, of the entries that have records; with readings."""
    kinds = (EntryKind.STEP, EntryKind.AS_WRITTEN)
    lines: dict[tuple[str, str], list[ClaimEntry]] = {}
    for entry, record in zip(entries, records, strict=False):
        is_line = entry.kind in kinds or entry.label == LEFT_SIDE
        if isinstance(entry, ClaimEntry) and is_line and record["verdict"] == Verdict.REFUTED.value:
            lines.setdefault((entry.label, entry.kind.value), []).append(entry)
    return lines


def decide_whole_line(
    readings: Sequence[ClaimEntry], worst_for: Side, search: WholeSearch, *, searches: bool
) -> WholeRecord:
    """Decide one refuted line among whole instances in which A* is a worst attack on the plan of ``worst_for``.

    ``searches`` : else an earlier search's decision is re-checked, if there is one.
    """
    first, cases, known = readings[0], _broken(readings), None
    if not searches:
        known = recorded_decisions(
            first.label, first.kind.value, first.chain, cases, worst_for=worst_for, search=search
        )
    if known is None:
        known = smallest_instance(first.chain, cases, worst_for, search)
    return whole_record(first, worst_for.value, known)


def whole_instance(label: str, worst_for: Side, *, kind: EntryKind = EntryKind.STEP) -> WholeInstance:
    """Return the smallest known whole instance on which a line of the appendix fails, re-checked.

    ``label`` : the paper's, such as ``nd_p1d2v1_8``; ``worst_for`` : whose worst attack A* is.

    Raises
    ------
    InputError : none is known.
    """
    readings = [e for e in all_entries() if isinstance(e, ClaimEntry) and (e.label, e.kind) == (label, kind)]
    known = None
    if readings:
        chain_of = readings[0].chain
        known = recorded_decisions(
            label, kind.value, chain_of, _broken(readings), worst_for=worst_for, search=WholeSearch()
        )
    found = known[-1].instance if known else None
    if found is None:
        raise InputError("label", "must be of a line with a known whole instance", label)
    return found


def _broken(readings: Sequence[ClaimEntry]) -> tuple[SizedClaim, ...]:
    """Sizes of a line that are refuted, once each."""
    sizes = (sized for entry in readings for sized in entry.claims)
    broken = (sized for sized in sizes if decide(sized.claim).verdict is Verdict.REFUTED)
    return tuple({(sized.team, sized.attacked, sized.claim.conclusion): sized for sized in broken}.values())


def _decide_whole(
    budget: Budget,
    entries: Sequence[Entry],
    records: Sequence[EntryRecord],
    whole: list[WholeRecord],
    *,
    searches: bool,
) -> None:
    """Fill in what whole instances say of the refuted lines, as far as time allows; raises ``OutOfBudget``."""
    try:
        with Step("whole instances") as step:
            for (label, _), readings in refuted_lines(entries, records).items():
                for side in Side:
                    budget.check()
                    step.say(f"{label}, A* worst for {side.value}")
                    whole.append(decide_whole_line(readings, side, WholeSearch(), searches=searches))
    except KeyboardInterrupt:
        budget.interrupt()


def _add_other_verdicts(entries: Sequence[Entry], records: Sequence[EntryRecord]) -> None:
    """Decide for each refuted entry whether the conclusion holds without it, and which weaker step serves."""
    verdicts: dict[EntryName, set[str]] = {}
    for entry, record in zip(entries, records, strict=True):
        for name in entry.names:
            verdicts.setdefault(name, set()).add(record["verdict"])

    def other(name: EntryName) -> OtherEntry:
        found = verdicts.get(name, set())
        return {"entry": str(name), "verdict": next(iter(found)) if len(found) == 1 else None}

    for entry, record in zip(entries, records, strict=True):
        if record["verdict"] == Verdict.REFUTED.value:
            if entry.survives_by is not None:
                record["conclusion_without_it"] = other(entry.survives_by)
            if entry.serves_by is not None:
                record["weaker_step_that_serves"] = other(entry.serves_by)
