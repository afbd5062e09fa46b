"""Conclusions from the ledger's records: the theorem, the numbered lines, the readings, the repairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import EntryKind, EntryName
from ratt_audit.appendix.misprints import MISPRINTS
from ratt_audit.appendix.printed import numbered
from ratt_audit.appendix.readings import LEFT_SIDE
from ratt_audit.appendix.theorems import PATTERN_FREE_ND, PATTERN_FREE_SUB, THEOREM1, THEOREM1_SUB

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_audit.report.records import EntryHead, EntryRecord, LedgerDocument, WholeRecord

__all__ = ["BY_ATTACK", "BY_READING", "FAILS", "HOLDS", "WHOLE", "Finding", "findings", "line_outcomes", "title"]

STEP = EntryKind.STEP
PLAN, OPTIMUM, TEAM = "the plan's", "the optimum's", "the team's only"
REFUTED, PROVED = "refuted", "proved"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One section of the summary: a heading, sentences, and a table whose first row is its head (empty: no table)."""

    heading: str
    sentences: tuple[str, ...]
    table: tuple[tuple[str, ...], ...] = ()


def title(record: EntryHead) -> str:
    """Label, kind and reading of an entry."""
    reading = f" ({record['reading']})" if record["reading"] else ""
    return f"{numbered(record['label'])}, {record['kind']}{reading}"


def findings(document: LedgerDocument) -> tuple[Finding, ...]:
    """Return the sections in reading order; sections without anything to say are left out."""
    records = document["entries"]
    sections = (
        _theorems(records),
        _lines(records),
        _readings(records),
        _whole(document.get("whole_instances", []), searched=document.get("whole_searched", True)),
        _repairs(records),
        _misprints(records),
        _own_claims(records),
    )
    return tuple(section for section in sections if len(section.table) > 1)


def _theorems(records: list[EntryRecord]) -> Finding:
    rows = [r for r in records if r["kind"] == EntryKind.THEOREM]
    first = [r for r in rows if r["label"] in (THEOREM1.label, THEOREM1_SUB.label)]
    sentences = []
    if _all_proved(first):
        hold = "Both bounds of Theorem 1 hold: each is proved from RATT's choices alone, without the appendix."
        sentences.append(hold)
    if _all_proved([r for r in rows if r["label"] in (PATTERN_FREE_ND.label, PATTERN_FREE_SUB.label)]):
        sentences.append(
            "They are not the best: the pattern-free bounds 1-k and (1-c)^2 are proved as well, and are larger for "
            "every curvature strictly between 0 and 1; the survivor bounds are at least as large; if attacks can "
            "keep every group to one unblinded robot RATT is optimal. The machine decides teams up to the size shown; "
            "written proofs for any number of robots are in the documentation of pattern_free_bound, group_size_bound "
            "and survivor_bound. What Theorem 1 needs is RATT's choices, one robot at a time: no pattern, no "
            "distribution of attacks, no A*."
        )
    table = [("entry", "statement", "verdict", "for which sizes")]
    table += [(numbered(r["label"]), r["statement"], r["verdict"], r["sizes"]) for r in rows]
    return Finding(heading="Does the theorem survive?", sentences=tuple(sentences), table=tuple(table))


HOLDS, BY_ATTACK, BY_READING, FAILS = (
    "holds in every reading",
    "depends on whose worst attack A* is",
    "depends on another reading",
    "fails in every reading",
)


def line_outcomes(records: Sequence[EntryRecord]) -> dict[str, list[str]]:
    """Outcome -> labels of the numbered lines, by what becomes of them as steps; all counts are of these lists."""
    outcome: dict[str, list[str]] = {HOLDS: [], BY_ATTACK: [], BY_READING: [], FAILS: []}
    for label, group in _grouped([r for r in records if r["kind"] == STEP]).items():
        refuted = sum(r["verdict"] == REFUTED for r in group)
        mixed = BY_ATTACK if all(_whose(r["reading"]) for r in group) else BY_READING
        outcome[HOLDS if not refuted else FAILS if refuted == len(group) else mixed].append(label)
    return outcome


def _lines(records: list[EntryRecord]) -> Finding:
    """Numbered lines of the paper by what becomes of them as steps."""
    outcome = line_outcomes(records)
    cumulative = _grouped([r for r in records if r["kind"] == EntryKind.CUMULATIVE])
    lost = [label for label, group in cumulative.items() if all(r["verdict"] == REFUTED for r in group)]
    table = [("numbered lines whose step ...", "how many", "which")]
    for name, labels in outcome.items():
        table.append(
            (name, str(len(labels)), "all others" if name == HOLDS else ", ".join(map(numbered, labels)) or "none")
        )
    some, none = _equalities(records)
    table.append(("is printed with =, which holds in some reading only", str(len(some)), ", ".join(some) or "none"))
    table.append(("is printed with =, but holds with >= only", str(len(none)), ", ".join(none) or "none"))
    text = f"Of {sum(map(len, outcome.values()))} numbered lines, {len(outcome[HOLDS])} follow from the line before in"
    text = f"{text} every reading, {len(outcome[FAILS])} in none."
    end = "A failing step is a gap in the argument, not a false result: from the start of its chain each line is proved"
    end = f"{end} in some reading ({len(cumulative)} lines)."
    if lost:
        end = f"Even from the start of its chain, these lines fail in every reading: {', '.join(lost)}."
    return Finding(heading="Which steps hold?", sentences=(text, end), table=tuple(table))


def _equalities(records: Sequence[EntryRecord]) -> tuple[list[str], list[str]]:
    """Lines printed with = that hold so in some reading but not in all, and in none."""
    some: list[str] = []
    none: list[str] = []
    for label, group in _grouped([r for r in records if r["kind"] == EntryKind.AS_WRITTEN]).items():
        refuted = sum(r["verdict"] == REFUTED for r in group)
        if refuted:
            (none if refuted == len(group) else some).append(label)
    return some, none


def _misprints(records: list[EntryRecord]) -> Finding:
    """Places that are judged as meant, and what the ledger says of both if they are statements."""
    verdicts = {r["label"]: r["verdict"] for r in records}
    table = [("where", "printed", "meant", "as printed", "as meant")]
    for one in MISPRINTS:
        found = (verdicts.get(one.label, "-"), verdicts.get(one.repaired, "-"))
        table.append((one.where, one.printed, one.meant, *found))
    text = "Misprints are no failures: these places are judged by what they mean, and if that matters in both ways."
    return Finding(heading="Misprints", sentences=(text,), table=tuple(table))


def _readings(records: list[EntryRecord]) -> Finding:
    """Lines decided under several readings of whose worst attack A* is."""
    table = [("step", *(f"A* is {who} worst attack" for who in (PLAN, OPTIMUM)), "A* is worst for the team only")]
    fails = {PLAN: False, OPTIMUM: False}
    for label, group in _grouped([r for r in records if r["kind"] == STEP]).items():
        found = {who: r["verdict"] for r in group if (who := _whose(r["reading"]))}
        if len(found) > 1:
            table.append((numbered(label), *(found.get(who, "-") for who in (PLAN, OPTIMUM, TEAM))))
            fails = {who: fails[who] or found.get(who) == REFUTED for who in fails}
    sentences = ["A* is worst within the group of the line here; the next table takes whole teams."]
    if all(fails.values()):
        sentences.append("So no single reading of A* makes every step hold.")
    if any(r["label"] == LEFT_SIDE and r["verdict"] == REFUTED and _whose(r["reading"]) == OPTIMUM for r in records):
        sentences.append(
            "And with the optimum's worst attack the appendix speaks of RATT's value under that attack, Theorem 1 "
            f"about RATT's own worst case: going from one to the other ({LEFT_SIDE}) is refuted."
        )
    return Finding(heading="Whose worst attack is A*?", sentences=tuple(sentences), table=tuple(table))


WHOLE = "Which lines fail in whole instances?"
NO_INSTANCE = "holds in whole instances"


def _whole(records: Sequence[WholeRecord], *, searched: bool) -> Finding:
    """Refuted lines on whole instances: the smallest one for each plan whose worst attack A* may be."""
    sides = list(dict.fromkeys(record["worst_for"] for record in records))
    table = [("line", *(f"A* is a worst attack on {side}" for side in sides))]
    for (label, kind), group in _by_line(records).items():
        table.append((f"{numbered(label)}, {kind}", *(_whole_cell(group.get(side)) for side in sides)))
    text = (
        "A whole instance is a set function, budgets on a complete graph, RATT's plan by RATT itself, an optimal plan "
        "and a worst attack A* that leaves the groups of the line's pattern. Each one was found by exact linear "
        "programs and re-checked by the exact attack and by enumerating all plans."
    )
    counts = [_failing_steps(records, side) for side in sides]
    tail = ["Teams that the table does not name were not decided."]
    if not searched and records:
        tail.append(
            "This run re-checked the instances of an earlier search; its verdicts on smaller teams are as that search "
            "left them, which ratt-opt audit --search-whole repeats."
        )
    return Finding(heading=WHOLE, sentences=(text, *counts, *tail), table=tuple(table))


def _by_line(records: Sequence[WholeRecord]) -> dict[tuple[str, str], dict[str, WholeRecord]]:
    lines: dict[tuple[str, str], dict[str, WholeRecord]] = {}
    for record in records:
        lines.setdefault((record["label"], record["kind"]), {})[record["worst_for"]] = record
    return lines


def _failing_steps(records: Sequence[WholeRecord], side: str) -> str:
    steps = [r for r in records if r["worst_for"] == side and r["kind"] == STEP]
    failing = [numbered(r["label"]) for r in steps if r["instance"] is not None]
    fail = "1 step fails" if len(failing) == 1 else f"{len(failing)} steps fail"
    named = f" ({', '.join(failing)})" if failing else ""
    return f"If A* is a worst attack on {side}, {fail} in whole instances{named}."


def _whole_cell(record: WholeRecord | None) -> str:
    """The smallest instance, after the smaller teams on which the line holds."""
    if record is None:
        return "-"
    parts = []
    undecided = _teams(record, None)
    held = [team for team in _teams(record, PROVED) if team not in undecided]
    if held:
        parts.append(f"{NO_INSTANCE} at (N, alpha_s, alpha_c) = {', '.join(held)}")
    if undecided:
        parts.append(f"not decided at {', '.join(undecided)}")
    found = record["instance"]
    if found is not None:
        team = f"({found['n_robots']}, {found['alpha_s']}, {found['alpha_c']})"
        parts.append(f"fails at {team}, {found['curvature']}: {found['line']} lacks {found['violation']}")
    return "; ".join(parts) or "no team of the searched sizes has the pattern"


def _teams(record: WholeRecord, verdict: str | None) -> list[str]:
    """Budgets of the teams with this verdict (``None``: left open); those of the failing team are left out."""
    is_asked = {verdict} if verdict else {t["verdict"] for t in record["teams"]} - {PROVED, REFUTED}
    found = [t for t in record["teams"] if t["verdict"] in is_asked]
    budgets = list(dict.fromkeys(_budgets(t["team"]) for t in found))
    failing = {_budgets(t["team"]) for t in record["teams"] if t["verdict"] == REFUTED}
    return [budget for budget in budgets if budget not in failing]


def _budgets(team: str) -> str:
    """``(N, alpha_s, alpha_c)`` of a team's text."""
    numbers = [part.split(" = ")[1] for part in team.split(";", maxsplit=1)[0].split(", ")]
    return f"({', '.join(numbers)})"


def _whose(reading: str) -> str | None:
    if not reading.startswith("A*"):
        return None
    return TEAM if "team only" in reading else OPTIMUM if "optimum" in reading else PLAN


def _repairs(records: list[EntryRecord]) -> Finding:
    table = [
        ("refuted", "smallest counterexample", "what still holds of it, or serves instead", "conclusion without it")
    ]
    for record in records:
        if record["verdict"] == REFUTED and record["chain"] != "tightness" and record["kind"] != EntryKind.CUMULATIVE:
            survival = record.get("conclusion_without_it")
            without = (survival and survival["verdict"]) or "-"
            table.append((title(record), _size(record), _left(record), without))
    whole = sum(row[3] == PROVED for row in table[1:])
    text = f"{len(table) - 1} statements are refuted; for {whole} of them the conclusion is proved without"
    text = f"{text} the statement."
    return Finding(heading="Refuted, and what serves instead", sentences=(text,), table=tuple(table))


def _size(record: EntryRecord) -> str:
    refuted = next((claim for claim in record["claims"] if claim["witness"] is not None), None)
    if refuted is None:
        return str(next(iter(record.get("counterexamples", [])), "-"))
    return f"{refuted['size']}; {refuted['scope']}"


def _left(record: EntryRecord) -> str:
    """Best factors, a direct way from an earlier line, or a repaired claim, each with the ledger's verdict."""
    parts = []
    factors = record.get("best_factors", [])
    if any(item["factor"] != "0" for item in factors):
        parts.append("; ".join(f"factor {item['factor']} at curvature {item['curvature']}" for item in factors))
    elif factors:
        parts.append("no positive factor")
    if record.get("follows_from"):
        parts.append(f"follows directly from {record['follows_from']} (proved)")
    serves = record.get("weaker_step_that_serves")
    if serves:
        named = EntryName.parse(serves["entry"])
        other = [named.reading] if named.reading and named.reading != record["reading"] else []
        parts.append(f"{', '.join([named.label, named.kind, *other])} ({serves['verdict']})")
    searched = "best_factors" in record or not record["claims"]
    return "; ".join(parts) or ("nothing weaker found" if searched else "not looked for in a quick run")


def _own_claims(records: list[EntryRecord]) -> Finding:
    """Tightness of the bounds."""
    table = [("entry", "statement", "verdict", "evidence")]
    for r in records:
        if r["chain"] == "tightness":
            cases = r.get("counterexamples") or [r["detail"]]
            table.append((numbered(r["label"]), r["statement"], r["verdict"], cases[0]))
    return Finding(heading="How tight are the bounds?", sentences=(), table=tuple(table))


def _all_proved(records: list[EntryRecord]) -> bool:
    return bool(records) and all(r["verdict"] == PROVED for r in records)


def _grouped(records: Sequence[EntryRecord]) -> dict[str, list[EntryRecord]]:
    groups: dict[str, list[EntryRecord]] = {}
    for record in records:
        groups.setdefault(record["label"], []).append(record)
    return groups
