"""The ledger: every entry decided, with its evidence, written as JSON, HTML and Markdown."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ratt_audit.appendix.roles import Side
from ratt_audit.decisions import decide_entry
from ratt_audit.engine.decide import CURVATURE_GRID, Verdict
from ratt_audit.engine.pace import paced
from ratt_audit.entries import all_entries
from ratt_audit.report.findings import findings
from ratt_audit.report.pages import html_report, markdown_report, per_chain
from ratt_audit.whole.search import WholeSearch
from ratt_audit.whole_lines import decide_whole_line, refuted_lines
from ratt_opt._files import output_directory, write_json, write_together
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from ratt_audit.appendix.entry import Entry, EntryName
    from ratt_audit.report.findings import Finding
    from ratt_audit.report.records import EntryRecord, LedgerDocument, OtherEntry, WholeRecord

__all__ = ["FILES", "Ledger", "run_audit"]

FILES = ("audit.json", "audit.html", "audit.md")
"""Files that :func:`run_audit` writes."""

FORMAT = "ratt-opt audit, version 1"


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
