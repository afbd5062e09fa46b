"""The ledger as one self-contained HTML page: a table of counts, then every entry with its evidence."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from ratt_opt.audit.report.findings import findings
from ratt_opt.audit.report.words import evidence, per_chain, proof_lines, shown_claim, title

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.audit.report.document import EntryRecord, LedgerDocument
    from ratt_opt.audit.report.findings import Finding

__all__ = ["html_report"]

_STYLE = """
body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1a1a;background:#fff}
table{border-collapse:collapse;margin:1rem 0}
td,th{border:1px solid #bbb;padding:.2rem .6rem;text-align:left;overflow-wrap:anywhere}
details{border-left:.35rem solid #999;margin:.4rem 0;padding:.2rem .8rem}
details.proved{border-color:#0072b2}details.refuted{border-color:#d55e00}
details.no-violation-found{border-color:#e69f00}
summary{cursor:pointer}pre{white-space:pre-wrap;overflow-wrap:anywhere;background:#f4f4f4;padding:.6rem}
"""


def html_report(document: LedgerDocument) -> str:
    """Return the page; all text from the ledger is escaped."""
    counts = ", ".join(f"{number} {verdict}" for verdict, number in document["counts"].items())
    state = "" if document["complete"] else "<p><strong>The run was interrupted: entries are missing.</strong></p>"
    body = [
        "<h1>Proof ledger</h1>",
        f"<p>{len(document['entries'])} entries: {escape(counts)}. {document['seconds']:.0f} s.</p>",
        state,
        "<p>A proof is a sum of elementary inequalities with multipliers that are never negative; a "
        "counterexample is an explicit function. Both were checked in rational arithmetic. Every claim and "
        "proof is in <code>audit.json</code>; this page prints one claim per entry.</p>",
        *(_finding(finding) for finding in findings(document)),
        "<h2>Verdicts per chain</h2>",
        _verdicts(document),
        "<h2>All entries</h2>",
        *(_entry(record) for record in document["entries"]),
    ]
    head = f'<meta charset="utf-8"><title>Proof ledger</title><style>{_STYLE}</style>'
    return f'<!doctype html>\n<html lang="en"><head>{head}</head><body>\n' + "\n".join(body) + "\n</body></html>\n"


def _finding(finding: Finding) -> str:
    sentences = f"<p>{escape(' '.join(finding.sentences))}</p>" if finding.sentences else ""
    return f"<h2>{escape(finding.heading)}</h2>{sentences}{_table(finding.table)}"


def _verdicts(document: LedgerDocument) -> str:
    columns = list(document["counts"])
    rows = [(name, *(str(cell) for cell in counts.values())) for name, counts in per_chain(document).items()]
    return _table([("chain", *columns), *rows])


def _table(rows: Sequence[Sequence[str]]) -> str:
    head, *rest = rows
    cells = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rest]
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    return f"<table><tr>{''.join(f'<th>{escape(name)}</th>' for name in head)}</tr>{body}</table>"


def _entry(record: EntryRecord) -> str:
    style = record["verdict"].replace(" ", "-")
    scope = "; ".join([record["sizes"], *record.get("curvature", [])])
    parts = [
        f"<p>{escape(record['statement'])}</p>",
        f"<p>Hypotheses: {escape(record['hypotheses'])}.</p>",
        f"<p>Decided by {escape(record['decided_by'])}: {escape(scope)}. {record['seconds']:.2f} s.</p>",
    ]
    if lines := evidence(record):
        parts.append("<ul>" + "".join(f"<li>{escape(line)}</li>" for line in lines) + "</ul>")
    claim = shown_claim(record)
    if claim is not None and claim["witness"] is None:
        text = "\n".join([f"Claim ({claim['size']}): {claim['claim']}", *proof_lines(claim)])
        parts.append(f"<pre>{escape(text)}</pre>")
    summary = f"<summary><strong>{escape(record['verdict'])}</strong> {escape(title(record))}</summary>"
    return f'<details class="{escape(style)}">{summary}{"".join(parts)}</details>'
