"""The ledger as one self-contained HTML page, and as Markdown with the refuted entries in full."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from latex2mathml.converter import convert

from ratt_audit.appendix.printed import Formula
from ratt_audit.report.chains import chain_lines
from ratt_audit.report.findings import findings, title

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_audit.report.findings import Finding
    from ratt_audit.report.records import (
        ClaimRecord,
        EntryRecord,
        FactorRecord,
        LedgerDocument,
        RealRecord,
        WitnessRecord,
    )

__all__ = ["evidence", "finding_lines", "html_report", "markdown_report", "per_chain", "proof_lines", "shown_claim"]

_STYLE = """
body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1a1a;background:#fff}
table{border-collapse:collapse;margin:1rem 0}
td,th{border:1px solid #bbb;padding:.2rem .6rem;text-align:left;vertical-align:top}
.wide{overflow-x:auto}
details{border-left:.35rem solid #999;margin:.4rem 0;padding:.2rem .8rem}
details.proved{border-color:#0b5394}details.refuted{border-color:#e0451b}
details.no-violation-found{border-color:#f3c6dd}details.not-decidable-here{border-color:#1c1c1c}
summary{cursor:pointer}pre{white-space:pre-wrap;overflow-wrap:anywhere;background:#f4f4f4;padding:.6rem}
"""


def html_report(document: LedgerDocument) -> str:
    """Return the page; all text from the ledger is escaped."""
    state = "" if document["complete"] else "<p><strong>The run was interrupted: entries are missing.</strong></p>"
    body = [
        "<h1>Proof ledger</h1>",
        f"<p>{escape(_counts(document))}</p>",
        state,
        "<p>A proof is a sum of elementary inequalities with multipliers that are never negative; a "
        "counterexample is an explicit function. Both were checked in rational arithmetic. Every claim and "
        "proof is in <code>audit.json</code>; this page prints one claim per entry.</p>",
        *(_finding(finding) for finding in findings(document)),
        "<h2>Verdicts per chain</h2>",
        _verdicts(document),
        "<h2>The lines that the entries speak of</h2>",
        *(_finding(chain, level=3) for chain in chain_lines(document)),
        "<h2>All entries</h2>",
        *(_entry(record) for record in document["entries"]),
    ]
    head = f'<meta charset="utf-8"><title>Proof ledger</title><style>{_STYLE}</style>'
    return f'<!doctype html>\n<html lang="en"><head>{head}</head><body>\n' + "\n".join(body) + "\n</body></html>\n"


def _finding(finding: Finding, level: int = 2) -> str:
    sentences = f"<p>{escape(' '.join(finding.sentences))}</p>" if finding.sentences else ""
    return f"<h{level}>{escape(finding.heading)}</h{level}>{sentences}{_table(finding.table)}"


def _verdicts(document: LedgerDocument) -> str:
    columns = list(document["counts"])
    rows = [(name, *(str(cell) for cell in counts.values())) for name, counts in per_chain(document).items()]
    return _table([("chain", *columns), *rows])


def _table(rows: Sequence[Sequence[str]]) -> str:
    head, *rest = rows
    cells = ["".join(f"<td>{_cell(cell)}</td>" for cell in row) for row in rest]
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    titles = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    return f'<div class="wide"><table><tr>{titles}</tr>{body}</table></div>'


def _cell(text: str) -> str:
    return convert(text) if isinstance(text, Formula) else escape(text)


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


def markdown_report(document: LedgerDocument) -> str:
    """Return the report as text; every cell is escaped."""
    state = "" if document["complete"] else " The run was interrupted: entries are missing."
    lines = ["# Proof ledger", "", f"{_counts(document)}{state}", ""]
    for finding in findings(document):
        lines += finding_lines(finding)
    lines += ["## Verdicts per chain", ""]
    columns = list(document["counts"])
    lines += [_row(["chain", *columns]), _row(["---"] * (len(columns) + 1))]
    lines += [_row([name, *(str(counts[c]) for c in columns)]) for name, counts in per_chain(document).items()]
    lines += ["", "## The lines that the entries speak of", ""]
    for chain in chain_lines(document):
        lines += finding_lines(chain, level=3)
    lines += ["## Refuted entries", ""]
    for record in document["entries"]:
        if record["verdict"] == "refuted":
            lines += _refuted(record)
    lines += ["## All entries", "", _row(["entry", "statement", "verdict", "sizes and curvature"]), _row(["---"] * 4)]
    for record in document["entries"]:
        scope = "; ".join([record["sizes"], *record.get("curvature", [])])
        lines.append(_row([title(record), record["statement"], record["verdict"], scope]))
    return "\n".join([*lines, ""])


def finding_lines(finding: Finding, *, level: int = 2) -> list[str]:
    """One section of the summary: heading, sentences, table."""
    head, *rows = finding.table
    lines = [
        f"{'#' * level} {_escape(finding.heading)}",
        "",
        *([_escape(" ".join(finding.sentences)), ""] if finding.sentences else []),
    ]
    return [*lines, _row(list(head)), _row(["---"] * len(head)), *(_row(list(row)) for row in rows), ""]


def _counts(document: LedgerDocument) -> str:
    counts = ", ".join(f"{number} {verdict}" for verdict, number in document["counts"].items())
    return f"{len(document['entries'])} entries: {counts}. {document['seconds']:.0f} s."


def _refuted(record: EntryRecord) -> list[str]:
    lines = [f"### {_escape(title(record))}", "", _escape(record["statement"]), ""]
    lines += [_escape(f"Given: {record['hypotheses']}."), ""]
    return [*lines, *(f"- {_escape(line)}" for line in evidence(record)), ""]


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(_escape(cell) for cell in cells)} |"


def _escape(text: str) -> str:
    if isinstance(text, Formula):
        return f"${text}$"
    for symbol in "\\|*_<>[]":
        text = text.replace(symbol, f"\\{symbol}")
    return text


SHOWN_SETS = 60
"""Most values of a counterexample that a report prints."""


def per_chain(document: LedgerDocument) -> dict[str, dict[str, int]]:
    """Verdict counts of each chain, in order of appearance, then of all."""
    table: dict[str, dict[str, int]] = {}
    for record in document["entries"]:
        row = table.setdefault(record["chain"], dict.fromkeys(document["counts"], 0))
        row[record["verdict"]] += 1
    table["all"] = dict(document["counts"])
    return table


def shown_claim(record: EntryRecord) -> ClaimRecord | None:
    """The claim whose evidence a report prints: the first refuted one, else the first with a proof that has steps."""
    claims = record["claims"]
    refuted = [claim for claim in claims if claim["witness"] is not None]
    stepped = [claim for claim in claims if claim["proofs"] and claim["proofs"][0]["steps"]]
    return next(iter(refuted or stepped or claims), None)


def evidence(record: EntryRecord) -> list[str]:
    """Counterexample or enumeration, the rest of the step, and whether the conclusion survives."""
    claim = shown_claim(record)
    is_refuted = claim is not None and claim["witness"] is not None
    lines = [f"{record['sizes']}: {record['detail']}"] if "detail" in record else []
    lines += record.get("counterexamples", [])
    if claim is not None and claim["witness"] is not None:
        lines += _witness_lines(claim, claim["witness"])
    lines += [_factor_line(best) for best in record.get("best_factors", [])]
    found = record.get("realistic")
    if found:
        lines += _realistic_lines(found)
    elif is_refuted and "realistic" in record:
        lines.append("not tried on EKF objectives: no roles, numbers that are no values, or many robots")
    if record.get("follows_from"):
        lines.append(f"a direct step that serves the proof: the line follows from {record['follows_from']} (proved)")
    serves = record.get("weaker_step_that_serves")
    if serves:
        lines.append(f"a weaker step that serves the proof: {serves['entry']} ({serves['verdict']})")
    survival = record.get("conclusion_without_it")
    if survival:
        verdict = survival["verdict"] or "different verdicts for different readings"
        lines.append(f"the conclusion without this step ({survival['entry']}): {verdict}")
    return lines


def _factor_line(best: FactorRecord) -> str:
    where = "" if best["curvature"] is None else f" at curvature {best['curvature']}"
    if best["factor"] == "0":
        return f"no positive factor on the right saves the step{where}"
    how = "and no larger factor (within 1/1000)" if best["cannot_exceed_by_1/1000"] else "a valid factor"
    return f"with the factor {best['factor']} on the right the step holds{where}, {how}"


def _witness_lines(claim: ClaimRecord, witness: WitnessRecord) -> list[str]:
    lines = [f"smallest counterexample found: {claim['size']}; {claim['scope']}; the claim {claim['claim']}"]
    lines.append(f"fails by {witness['violation']} for the function with values {_values(witness)}")
    if witness["ratt_chooses_the_roles"] is not None:
        said = "does" if witness["ratt_chooses_the_roles"] else "does not"
        lines.append(f"run on this function, RATT {said} choose the elements the claim calls its own")
    if witness["auxiliary"]:
        lines.append("other numbers: " + ", ".join(f"{k} = {v}" for k, v in witness["auxiliary"].items()))
    return lines


def _realistic_lines(found: RealRecord) -> list[str]:
    """The search on EKF objectives in words."""
    seen, broken = found["section_vi_instances"], found["section_vi_violations"]
    lines = [f"on Section VI scenarios ({found['objective']}): violated in {broken} of {seen} cases it applies to"]
    worst = found["worst"]
    if worst is None:
        return lines
    size = f"{worst['relative_violation']:.3g} of the largest value in it"
    if worst["violated_exactly"]:
        lines.append(f"worst geometry found: violated by {size}, replayed without rounding; {worst['origin']}")
    elif worst["relative_violation"] > 0:
        lines.append(f"worst geometry found: violated by {size} in rounding, not confirmed exactly; {worst['origin']}")
    else:
        margin = f"margin {-worst['relative_violation']:.3g}"
        lines.append(f"worst geometry found: not violated ({margin}); {worst['origin']}")
    return lines


def _values(witness: WitnessRecord) -> str:
    """The values that the claim and its premises speak of."""
    shown = [f"{name} = {value}" for name, value in witness["values_in_play"].items()]
    if len(shown) > SHOWN_SETS:
        shown[SHOWN_SETS:] = [f"... ({len(shown) - SHOWN_SETS} more sets)"]
    return f"{', '.join(shown)} (all {len(witness['values'])} values are in audit.json)"


def proof_lines(claim: ClaimRecord) -> list[str]:
    """The printed proof of a claim: multiplier times inequality, one per line; their sum is the claim."""
    lines = []
    for proof in claim["proofs"]:
        where = "all curvatures" if proof["curvature"] is None else f"curvature {proof['curvature']}"
        lines.append(f"{where}, from {proof['curvature_domain']}; the sum of:")
        lines += [f"[{multiplier}] x ({inequality})   {reason}" for multiplier, reason, inequality in proof["steps"]]
        if not proof["steps"]:
            lines.append("nothing: both sides are the same expression")
    return lines
