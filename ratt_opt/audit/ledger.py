"""The ledger: every entry decided, with its evidence, written as JSON, HTML and Markdown."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_atomically, write_json
from ratt_opt.audit.appendix import pattern1, pattern2, submodular
from ratt_opt.audit.appendix.chain import entries_of
from ratt_opt.audit.appendix.dominance import dominance_entries
from ratt_opt.audit.appendix.lemmas import lemmas
from ratt_opt.audit.appendix.readings import readings_of_sets, readings_of_the_attack
from ratt_opt.audit.appendix.team_lines import team_lines
from ratt_opt.audit.appendix.theorems import closing_lines, theorems
from ratt_opt.audit.decided import decide_one
from ratt_opt.audit.engine.decide import CURVATURE_GRID, Verdict
from ratt_opt.audit.enumeration.arrangement_claims import arrangement_entries
from ratt_opt.audit.enumeration.running_time import running_time_entries
from ratt_opt.audit.enumeration.size_claims import size_entries
from ratt_opt.audit.enumeration.smallest_teams import smallest_team_entries
from ratt_opt.audit.enumeration.tightness import tightness_entries
from ratt_opt.audit.report.findings import findings
from ratt_opt.audit.report.html_page import html_report
from ratt_opt.audit.report.markdown_page import markdown_report
from ratt_opt.audit.report.records import entry_record
from ratt_opt.audit.report.words import per_chain
from ratt_opt.budget import Budget

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from ratt_opt.audit.appendix.entry import Entry, Reference
    from ratt_opt.audit.report.document import EntryRecord, LedgerDocument, OtherEntry
    from ratt_opt.audit.report.findings import Finding

__all__ = ["Ledger", "all_entries", "decide_entry", "run_audit"]

FORMAT = "ratt-opt audit, version 1"


@dataclass(frozen=True, slots=True, kw_only=True)
class Ledger:
    """All records in the paper's order, as written to ``audit.json``.

    ``complete`` is False when the run was interrupted; the records so far are valid.
    """

    records: tuple[EntryRecord, ...] = field(repr=False)
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
        }


def all_entries() -> Iterator[Entry]:
    """Yield every entry in the paper's order: readings, Pattern 1, Pattern 2, closing lines, the rest."""
    yield from readings_of_the_attack()
    for one in (*pattern1.chains(), *pattern2.chains(), *submodular.chains()):
        yield from entries_of(one)
    yield from chain(readings_of_sets(), team_lines(), closing_lines(), dominance_entries(), theorems(), lemmas())
    yield from chain(arrangement_entries(), smallest_team_entries(), size_entries())
    yield from chain(tightness_entries(), running_time_entries())


def decide_entry(entry: Entry, *, quick: bool = False) -> EntryRecord:
    """Decide one entry and return its record (JSON data); ``quick`` as in :func:`run_audit`."""
    return entry_record(decide_one(entry, quick=quick))


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
    folder, budget = output_directory(out), Budget()
    entries = list(all_entries())
    records: list[EntryRecord] = []
    try:
        for number, entry in enumerate(entries):
            if progress is not None:
                progress(number, len(entries), entry.label)
            records.append(decide_entry(entry, quick=quick))
    except KeyboardInterrupt:
        budget.interrupt()
    _add_other_verdicts(entries[: len(records)], records)
    ledger = Ledger(records=tuple(records), seconds=budget.elapsed, complete=budget.stop() is None, quick=quick)
    document = ledger.document()
    write_json(folder / "audit.json", document)
    html, markdown = html_report(document), markdown_report(document)
    write_atomically(folder / "audit.html", lambda file: file.write_text(html, encoding="utf-8"))
    write_atomically(folder / "audit.md", lambda file: file.write_text(markdown, encoding="utf-8"))
    return ledger


def _add_other_verdicts(entries: Sequence[Entry], records: Sequence[EntryRecord]) -> None:
    """For each refuted entry: does the conclusion hold without it, and which weaker step serves (entries' verdicts)?"""
    verdicts: dict[Reference, set[str]] = {}
    for entry, record in zip(entries, records, strict=True):
        for name in entry.names:
            verdicts.setdefault(name, set()).add(record["verdict"])

    def other(name: Reference) -> OtherEntry:
        found = verdicts.get(name, set())
        return {"entry": str(name), "verdict": next(iter(found)) if len(found) == 1 else None}

    for entry, record in zip(entries, records, strict=True):
        if record["verdict"] == Verdict.REFUTED.value:
            if entry.survives_by is not None:
                record["conclusion_without_it"] = other(entry.survives_by)
            if entry.serves_by is not None:
                record["weaker_step_that_serves"] = other(entry.serves_by)
