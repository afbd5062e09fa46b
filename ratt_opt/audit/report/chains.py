"""The lines that the ledger speaks of, chain by chain: what each states, and what the machine reads at a small size."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import EntryKind
from ratt_opt.audit.report.findings import Finding

if TYPE_CHECKING:
    from ratt_opt.audit.report.records import EntryRecord, LedgerDocument

__all__ = ["chain_lines"]

HEAD = ("line", "states", "as the machine reads the step, smallest size at which it says anything")
SAYS_NOTHING = "0 >= 0"
TEXT = (
    "Each chain is read downwards: a line follows the one above it. u is RATT's plan, u* the optimum, A* a worst "
    "attack, V1, V2, ... the groups, b their baits and g their greedy robots; in the last column b1, g1, ... are "
    "RATT's elements of these robots, o(...) the optimum's."
)


def chain_lines(document: LedgerDocument) -> tuple[Finding, ...]:
    """One table a chain with two lines or more, in the order of the ledger; the first says how to read them."""
    chains: dict[str, dict[str, EntryRecord]] = {}
    written: set[str] = set()
    for record in document["entries"]:
        if record["kind"] == EntryKind.STEP:
            chains.setdefault(record["chain"], {}).setdefault(record["label"], record)
        elif record["kind"] == EntryKind.AS_WRITTEN:
            written.add(record["label"])
    found: list[Finding] = []
    for chain, lines in chains.items():
        rows = [(label, _states(record, equal=label in written), _read(record)) for label, record in lines.items()]
        if len(rows) > 1:
            found.append(Finding(heading=f"Chain {chain}", sentences=() if found else (TEXT,), table=(HEAD, *rows)))
    return tuple(found)


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
