"""The ledger as Markdown: counts, the refuted entries in full, one line for every other entry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.audit.report.findings import findings
from ratt_opt.audit.report.words import evidence, per_chain, title

if TYPE_CHECKING:
    from ratt_opt.audit.report.document import EntryRecord, LedgerDocument
    from ratt_opt.audit.report.findings import Finding

__all__ = ["finding_lines", "markdown_report"]


def markdown_report(document: LedgerDocument) -> str:
    """Return the report as text; every cell is escaped."""
    lines = ["# Proof ledger", "", _opening(document), ""]
    for finding in findings(document):
        lines += finding_lines(finding)
    lines += ["## Verdicts per chain", ""]
    columns = list(document["counts"])
    lines += [_row(["chain", *columns]), _row(["---"] * (len(columns) + 1))]
    lines += [_row([name, *(str(counts[c]) for c in columns)]) for name, counts in per_chain(document).items()]
    lines += ["", "## Refuted entries", ""]
    for record in document["entries"]:
        if record["verdict"] == "refuted":
            lines += _refuted(record)
    lines += ["## All entries", "", _row(["entry", "statement", "verdict", "sizes and curvature"]), _row(["---"] * 4)]
    for record in document["entries"]:
        scope = "; ".join([record["sizes"], *record.get("curvature", [])])
        lines.append(_row([title(record), record["statement"], record["verdict"], scope]))
    return "\n".join([*lines, ""])


def finding_lines(finding: Finding) -> list[str]:
    """One section of the summary: heading, sentences, table."""
    head, *rows = finding.table
    lines = [f"## {finding.heading}", "", *([_escape(" ".join(finding.sentences)), ""] if finding.sentences else [])]
    return [*lines, _row(list(head)), _row(["---"] * len(head)), *(_row(list(row)) for row in rows), ""]


def _opening(document: LedgerDocument) -> str:
    state = "" if document["complete"] else " The run was interrupted: entries are missing."
    counts = ", ".join(f"{number} {verdict}" for verdict, number in document["counts"].items())
    return f"{len(document['entries'])} entries: {counts}. {document['seconds']:.0f} s.{state}"


def _refuted(record: EntryRecord) -> list[str]:
    lines = [f"### {_escape(title(record))}", "", _escape(record["statement"]), ""]
    lines += [_escape(f"Given: {record['hypotheses']}."), ""]
    return [*lines, *(f"- {_escape(line)}" for line in evidence(record)), ""]


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(_escape(cell) for cell in cells)} |"


def _escape(text: str) -> str:
    for symbol in "\\|*_<>[]":
        text = text.replace(symbol, f"\\{symbol}")
    return text
