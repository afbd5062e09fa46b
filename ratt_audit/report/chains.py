"""The lines that the ledger speaks of, chain by chain: what each states, and what the machine reads at a small size."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import EntryKind
from ratt_audit.appendix.printed import numbered, printed_line
from ratt_audit.report.findings import Finding

if TYPE_CHECKING:
    from ratt_audit.report.records import EntryRecord, LedgerDocument

__all__ = ["chain_lines"]

HEAD = ("line", "printed", "in words", "as the machine reads the step, smallest size at which it says anything")
SAYS_NOTHING = "0 >= 0"
TEXT = (
    "Each chain is read downwards: a line follows the one above it. u is RATT's plan, u* the optimum, A* a worst "
    "attack, V1, V2, ... the groups, b their baits and g their greedy robots; in the last column b1, g1, ... are "
    "RATT's elements of these robots, o(...) the optimum's."
)
SUMMED = "Lines that sum up"


def chain_lines(document: LedgerDocument) -> tuple[Finding, ...]:
    """One table a chain with two lines or more, then one of the lines that stand alone; the first says how to read."""
    chains: dict[str, dict[str, EntryRecord]] = {}
    written: set[str] = set()
    for record in document["entries"]:
        if record["kind"] == EntryKind.STEP:
            chains.setdefault(record["chain"], {}).setdefault(record["label"], record)
        elif record["kind"] == EntryKind.AS_WRITTEN:
            written.add(record["label"])
    long = {f"Chain {name}": lines for name, lines in chains.items() if len(lines) > 1}
    alone = {label: record for lines in chains.values() if len(lines) == 1 for label, record in lines.items()}
    tables = long | ({SUMMED: alone} if alone else {})
    return tuple(
        Finding(heading=heading, sentences=() if place else (TEXT,), table=(HEAD, *_rows(lines, written)))
        for place, (heading, lines) in enumerate(tables.items())
    )


def _rows(lines: dict[str, EntryRecord], written: set[str]) -> list[tuple[str, ...]]:
    return [
        (numbered(label), printed_line(label) or "-", _states(record, equal=label in written), _read(record))
        for label, record in lines.items()
    ]


def _states(record: EntryRecord, *, equal: bool) -> str:
    """The line itself, with the relation that the paper prints."""
    where, separator, line = record["statement"].partition(": ")
    if not (separator and where.startswith("from ")):
        return record["statement"]
    return f"= {line.removeprefix('>= ')}" if equal else line


def _read(record: EntryRecord) -> str:
    """The step as a linear claim on values of f."""
    texts = [claim["claim"] for claim in record["claims"]]
    return next(
        (text for text in texts if text != SAYS_NOTHING), "both sides are the same expression" if texts else "-"
    )
