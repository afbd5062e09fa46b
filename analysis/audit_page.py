"""Write the page on what the audit settles, ``docs/researchers/audit.md``.

Run as ``python -m analysis.audit_page --ledger DIR --out PAGE``. ``DIR`` is the folder of ``ratt-opt audit --out
DIR``. Every verdict and number of the page is read from its ``audit.json`` or computed here as an exact worst-case
ratio; ``--figure FILE`` and ``--instances FILE`` name pictures beside the page. With ``--record``, the decisions of
``ratt-opt audit --search-whole --out DIR`` become those that later audits re-check.
"""

import argparse
import json
from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path

from ratt_audit.report.chains import chain_lines
from ratt_audit.report.findings import (
    BY_ATTACK,
    BY_READING,
    FAILS,
    HOLDS,
    WHOLE,
    Finding,
    findings,
    line_outcomes,
    title,
)
from ratt_audit.report.pages import finding_lines
from ratt_audit.report.records import LedgerDocument, WholeRecord, WorstRecord
from ratt_audit.whole.recorded import Recorded
from ratt_opt import caa, worst_case_ratio
from ratt_opt._files import write_atomically
from ratt_opt.worst_ratio.closed_form import pattern_free_ratio

__all__ = ["CASES", "page", "ratio_table", "realistic_table", "theorem1"]

RECORD = Path(__file__).parents[1] / "ratt_audit" / "whole" / "recorded.json"
CURVATURE = Fraction(1, 2)
PLANNERS = ("ratt", "myopic", "greedy")
CASES = (
    ("submodular", 3, 1, 0),
    ("submodular", 4, 0, 0),
    ("submodular", 4, 1, 0),
    ("submodular", 4, 0, 3),
    ("submodular", 4, 1, 3),
    ("nondecreasing", 3, 1, 0),
    ("nondecreasing", 4, 0, 0),
    ("nondecreasing", 4, 1, 0),
    ("nondecreasing", 4, 0, 3),
    ("nondecreasing", 4, 1, 3),
    ("nondecreasing", 5, 1, 0),
    ("nondecreasing", 5, 0, 6),
    ("nondecreasing", 6, 2, 0),
)
"""Family, N, alpha_s, alpha_c: seconds each."""

OPENING = """# What the audit settles

Theorem 1 of the paper rests on an appendix of {lines} numbered lines. `ratt-opt audit` decides every one of them
by machine, twice: as a *step* (this line from the one before) and *cumulatively* (this line from the start of its
chain). A statement "for every set function of this class with these roles" is a linear program over the function's
values: a feasible dual is a proof, a feasible primal a counterexample. Both are rounded to rationals and checked
exactly; no verdict below is a float, and none is typed in by hand.

In short: {holds} lines follow from the line before in every reading of the text. {fails} certainly fail ({names});
{attack} more depend on whose worst attack `A*` is, and {reading} on another reading. The theorem itself is proved
without them: from RATT's choices, one robot at a time.

This page is written by commands:

<!-- slow -->
```bash
ratt-opt audit --search-whole --out ledger
python -m analysis.audit_page --ledger ledger --out docs/researchers/audit.md --figure worst_ratio.png \\
    --instances whole_instances.png
```

The two pictures are of November 2026: `analysis/worst_ratio.py` and `analysis/whole_instances.py` of
commit df08edb7 drew them.
"""


def opening(document: LedgerDocument) -> str:
    """The first section, with the ledger's counts."""
    outcome = line_outcomes(document["entries"])
    return OPENING.format(
        lines=sum(map(len, outcome.values())),
        holds=len(outcome[HOLDS]),
        fails=len(outcome[FAILS]),
        names=", ".join(f"`{label}`" for label in outcome[FAILS]) or "none",
        attack=len(outcome[BY_ATTACK]),
        reading=len(outcome[BY_READING]),
    )


def page(document: LedgerDocument, ratios: Finding, figure: str = "", instances: str = "") -> str:
    """Return the page as Markdown; ``figure`` and ``instances`` name pictures beside it."""
    counts = ", ".join(f"{number} {verdict}" for verdict, number in document["counts"].items())
    lines = [opening(document), f"The ledger has {len(document['entries'])} entries: {counts}.", ""]
    for finding in (*findings(document), realistic_table(document), ratios):
        lines += finding_lines(finding)
        if instances and finding.heading == WHOLE:
            lines += [f"![Robots, groups and values of the smallest instance of each step that fails]({instances})", ""]
    lines += ["## The lines themselves", ""]
    for chain in chain_lines(document):
        lines += finding_lines(chain, level=3)
    if figure:
        lines += [f"![Exact worst ratios against curvature, beside the bounds]({figure})", ""]
    return "\n".join(lines)


def realistic_table(document: LedgerDocument) -> Finding:
    """Refuted statements on EKF objectives."""
    table = [("refuted", "criterion", "Section VI scenarios that break it", "worst geometry found")]
    for record in document["entries"]:
        found = record.get("realistic")
        if record["verdict"] != "refuted" or not found:
            continue
        seen = f"{found['section_vi_violations']} of {found['section_vi_instances']}"
        table.append((title(record), found["objective"], seen, _worst(found["worst"])))
    text = (
        "A counterexample may be far from any robot. So each refuted statement was tried on the trace (non-decreasing) "
        "or log-det (submodular) objectives of Section VI, and on geometries moved to break it; violations are "
        "relative to the largest value involved and replayed without rounding."
    )
    return Finding(heading="Do real objectives break them?", sentences=(text,), table=tuple(table))


def _worst(worst: WorstRecord | None) -> str:
    if worst is None:
        return "-"
    size = worst["relative_violation"]
    if worst["violated_exactly"]:
        return f"broken by {size:.2g}"
    return f"not broken, margin {-size:.2g}" if size <= 0 else f"broken by {size:.2g} in rounding only"


def ratio_table(cases: Sequence[tuple[str, int, int, int]]) -> Finding:
    """The smallest ratio of each planner over all instances, beside both bounds."""
    head = ("functions", "N", "blinded", "links cut", *PLANNERS, "Theorem 1", "pattern-free")
    text = (
        f"Each number is the smallest ratio of the planner's worst case to the optimum over all set functions of "
        f"curvature at most {CURVATURE}: attained by an explicit instance that the library replays, and proved from "
        f"below by rational multipliers or by a theorem (worst-ratio page). Theorem 1 speaks of RATT only; without "
        f"links cut its bound divides by zero, and its first term stands here."
    )
    return Finding(heading="Exact worst ratios", sentences=(text,), table=(head, *(_ratio_rows(cases))))


def _ratio_rows(cases: Sequence[tuple[str, int, int, int]]) -> Iterator[tuple[str, ...]]:
    for family, n, alpha_s, alpha_c in cases:
        brackets = [
            worst_case_ratio(n, alpha_s, alpha_c, curvature=CURVATURE, family=family, planner=planner, time_limit=120)
            for planner in PLANNERS
        ]
        ends = [(str(b.exact_lower), str(b.exact_upper)) for b in brackets]
        exact = [low if low == high else f"[{low}, {high}]" for low, high in ends]
        bounds = (theorem1(family, CURVATURE, caa(n, alpha_c).alpha_cs), pattern_free_ratio(CURVATURE, family))
        yield (family, str(n), str(alpha_s), str(alpha_c), *exact, *map(str, bounds))


def theorem1(family: str, curvature: Fraction, alpha_cs: int) -> Fraction:
    """Right side of ratt.tex, eqn:appro_non_descrease or eqn:appro_submodular; without links cut, its first term."""
    kept = 1 - curvature
    first, second = (kept / (1 + curvature), kept) if family == "submodular" else (kept**3, kept**2)
    return min(first, second / alpha_cs) if alpha_cs else first


def record(records: Sequence[WholeRecord], path: Path = RECORD) -> None:
    """Write the decisions and the values of each instance, one line of the paper a line of text."""
    lines = [json.dumps(_as_recorded(each), separators=(",", ":")) for each in records]
    write_atomically(path, lambda file: file.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8"))


def _as_recorded(one: WholeRecord) -> Recorded:
    found = one["instance"]
    return {
        "label": one["label"],
        "kind": one["kind"],
        "worst_for": one["worst_for"],
        "teams": [(each["team"], each["verdict"]) for each in one["teams"]],
        "values": None if found is None else found["values"],
    }


def main(arguments: list[str] | None = None) -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ledger", type=Path, required=True, help="folder of ratt-opt audit")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--figure", default="", help="picture to show, as seen from the page")
    parser.add_argument("--instances", default="", help="picture of the whole instances, as seen from the page")
    parser.add_argument("--record", action="store_true", help="let later audits re-check these decisions")
    options = parser.parse_args(arguments)
    document = json.loads((options.ledger / "audit.json").read_text(encoding="utf-8"))
    if document["quick"] or not document["complete"]:
        parser.error(f"{options.ledger} holds a quick or interrupted audit: run ratt-opt audit --out {options.ledger}")
    if options.record:
        if not document.get("whole_searched"):
            parser.error(f"{options.ledger} was not searched: run ratt-opt audit --search-whole --out {options.ledger}")
        record(document["whole_instances"])
    options.out.write_text(page(document, ratio_table(CASES), options.figure, options.instances), encoding="utf-8")
    print(f"written: {options.out}")


if __name__ == "__main__":
    main()
