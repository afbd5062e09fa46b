"""The ledger: every entry decided, with its evidence, written as JSON, HTML and Markdown."""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_atomically, write_json
from ratt_opt.audit.appendix import pattern1, pattern2, submodular
from ratt_opt.audit.appendix.chain import AS_WRITTEN, entries_of
from ratt_opt.audit.appendix.dominance import dominance_entries
from ratt_opt.audit.appendix.entry import Entry, EnumeratedEntry
from ratt_opt.audit.appendix.readings import special_entries
from ratt_opt.audit.appendix.team_lines import summaries
from ratt_opt.audit.appendix.theorems import closing_lines, lemmas, readings_of_the_attack, theorems
from ratt_opt.audit.engine.best_factor import weaken
from ratt_opt.audit.engine.decide import CURVATURE_GRID, Decision, Verdict, decide
from ratt_opt.audit.enumeration.group_claims import arrangement_entries
from ratt_opt.audit.enumeration.running_time import running_time_entries
from ratt_opt.audit.enumeration.size_claims import count_entries
from ratt_opt.audit.enumeration.smallest_teams import occurrence_entries
from ratt_opt.audit.enumeration.tightness import tightness_entries
from ratt_opt.audit.real_objectives.search import realistic_search
from ratt_opt.audit.report.findings import findings
from ratt_opt.audit.report.html_page import html_report
from ratt_opt.audit.report.markdown_page import markdown_report
from ratt_opt.audit.report.records import claim_record, enumerated_record, factor_records
from ratt_opt.audit.report.words import per_chain

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from ratt_opt.audit.appendix.entry import Detour
    from ratt_opt.audit.report.findings import Finding

__all__ = ["Ledger", "all_entries", "decide_entry", "run_audit"]

FORMAT = "ratt-opt audit, version 1"
QUICK_ROBOTS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Ledger:
    """All records in the paper's order, as written to ``audit.json``.

    ``complete`` is False when the run was interrupted; the records so far are valid.
    """

    records: tuple[dict[str, object], ...]
    seconds: float
    complete: bool
    quick: bool

    def counts(self) -> dict[str, int]:
        """Entries per verdict."""
        return {v.value: sum(r["verdict"] == v.value for r in self.records) for v in Verdict}

    def per_chain(self) -> dict[str, dict[str, int]]:
        """Entries per verdict of each chain, in order of appearance, then of all."""
        return per_chain(self.document())

    def findings(self) -> tuple[Finding, ...]:
        """What the records settle, section by section."""
        return findings(self.document())

    def document(self) -> dict[str, object]:
        """The ledger as strict JSON data."""
        return {
            "format": FORMAT,
            "complete": self.complete,
            "quick": self.quick,
            "curvature_grid": [str(value) for value in sorted(CURVATURE_GRID)],
            "counts": self.counts(),
            "seconds": self.seconds,
            "entries": list(self.records),
        }


def all_entries() -> Iterator[Entry | EnumeratedEntry]:
    """Yield every entry in the paper's order: readings, Pattern 1, Pattern 2, closing lines, the rest."""
    chains = (*pattern1.chains(), *pattern2.chains(), *submodular.chains())
    yield from readings_of_the_attack()
    for one in chains:
        yield from entries_of(one)
    yield from chain(special_entries(), summaries(), closing_lines(), dominance_entries(), theorems(), lemmas())
    yield from arrangement_entries()
    yield from occurrence_entries()
    yield from count_entries()
    yield from tightness_entries()
    yield from running_time_entries()


def decide_entry(entry: Entry | EnumeratedEntry, *, quick: bool = False) -> dict[str, object]:
    """Decide one entry and return its record (JSON data).

    ``quick`` keeps the sizes with at most three robots, else the smallest size, and one case of more than four robots;
    it leaves out best factors and the search on EKF objectives.
    """
    start = time.perf_counter()
    if isinstance(entry, EnumeratedEntry):
        counted = entry.enumerate_cases()
        return enumerated_record(entry, counted, seconds=time.perf_counter() - start)
    claims = entry.claims
    if quick:
        smallest = min(sized.robots for sized in claims)
        claims = tuple(sized for sized in claims if sized.robots <= max(QUICK_ROBOTS, smallest))
        claims = claims[:1] if smallest > QUICK_ROBOTS + 1 else claims
    decisions = [decide(sized.claim) for sized in claims]
    verdict = _verdict(decisions)
    record = claim_record(entry, claims, decisions, verdict)
    if not quick:
        broken = [sized for sized, decision in zip(claims, decisions, strict=True) if decision.witness is not None]
        record["best_factors"] = factor_records(() if entry.kind == AS_WRITTEN else weaken(broken))
        record["realistic"] = realistic_search(claims, refuted=bool(broken))
        if broken and entry.detours is not None:
            record["follows_from"] = _latest_detour(entry.detours())
    record["seconds"] = time.perf_counter() - start
    return record


def _latest_detour(detours: Iterator[Detour]) -> str | None:
    """The latest earlier line from which the refuted one is proved directly, at every size."""
    for detour in detours:
        if all(decide(sized.claim).verdict is Verdict.PROVED for sized in detour.claims):
            return detour.start
    return None


def _verdict(decisions: Sequence[Decision]) -> Verdict:
    """One refuted size refutes; all sizes must be proved to prove."""
    for verdict in (Verdict.REFUTED, Verdict.UNDECIDED, Verdict.NO_VIOLATION):
        if any(decision.verdict is verdict for decision in decisions):
            return verdict
    return Verdict.PROVED


def run_audit(
    out: str | Path, *, quick: bool = False, progress: Callable[[int, int, str], object] | None = None
) -> Ledger:
    """Decide every entry and write ``audit.json``, ``audit.html`` and ``audit.md`` to the folder ``out``.

    A keyboard interrupt writes what is decided so far, marked incomplete.

    Parameters
    ----------
    out : folder, created if needed
    quick : only the sizes that take seconds
    progress : called with (entries done, entries in all, label) before each entry

    Raises
    ------
    InputError : ``out`` cannot be written.
    """
    folder = output_directory(out)
    start = time.perf_counter()
    entries = list(all_entries())
    records: list[dict[str, object]] = []
    complete = True
    try:
        for number, entry in enumerate(entries):
            if progress is not None:
                progress(number, len(entries), entry.label)
            records.append(decide_entry(entry, quick=quick))
    except KeyboardInterrupt:
        complete = False
    _add_survival(records)
    ledger = Ledger(records=tuple(records), seconds=time.perf_counter() - start, complete=complete, quick=quick)
    document = ledger.document()
    write_json(folder / "audit.json", document)
    html, markdown = html_report(document), markdown_report(document)
    write_atomically(folder / "audit.html", lambda file: file.write_text(html, encoding="utf-8"))
    write_atomically(folder / "audit.md", lambda file: file.write_text(markdown, encoding="utf-8"))
    return ledger


def _add_survival(records: list[dict[str, object]]) -> None:
    """For each refuted entry: does the conclusion hold without it, and which weaker step serves (entries' verdicts)?"""
    verdicts: dict[str, set[str]] = {}
    for record in records:
        name, verdict = f"{record['label']}/{record['kind']}", str(record["verdict"])
        verdicts.setdefault(name, set()).add(verdict)
        verdicts.setdefault(f"{name}/{record['reading']}", set()).add(verdict)
    for record in records:
        named = {"conclusion_without_it": "survives_by", "weaker_step_that_serves": "serves_by"}
        for field, source in named.items():
            name = str(record.pop(source, ""))
            if record["verdict"] == Verdict.REFUTED.value and name:
                found = verdicts.get(name, set())
                record[field] = {"entry": name, "verdict": next(iter(found)) if len(found) == 1 else None}
