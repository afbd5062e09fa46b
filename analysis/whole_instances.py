"""Draw the smallest whole instances of the steps that fail, to be followed by hand.

Run as ``python -m analysis.whole_instances --ledger DIR --out PICTURE [--record]``. ``DIR`` is the folder of
``ratt-opt audit --out DIR``; every number of the picture is read from its ``audit.json``. With ``--record``, the
decisions of ``ratt-opt audit --search-whole --out DIR`` become those that later audits re-check.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import EntryKind
from ratt_audit.appendix.printed import numbered
from ratt_audit.report.findings import FAILS, line_outcomes
from ratt_opt._files import write_atomically

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from ratt_audit.report.records import InstanceRecord, LedgerDocument, WholeRecord
    from ratt_audit.whole.recorded import Recorded

__all__ = ["draw", "record", "shown"]

RECORD = Path(__file__).parents[1] / "ratt_audit" / "whole" / "recorded.json"

BAIT, GREEDY = "#e69f00", "#0072b2"
KEY = "Boxes: groups that A* leaves. Orange: bait. Blue: greedy. Cross: blinded. o(b1): the optimum's choice for b1."


def shown(document: LedgerDocument) -> list[WholeRecord]:
    """Pick each step that fails in every reading, with its smallest instance."""
    found = [record for record in document.get("whole_instances", []) if record["instance"] is not None]
    failing = line_outcomes(document["entries"])[FAILS]
    steps = [[r for r in found if (r["label"], r["kind"]) == (label, EntryKind.STEP)] for label in failing]
    return [min(each, key=_size) for each in steps if each]


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


def _size(record: WholeRecord) -> tuple[int, int, int]:
    found = record["instance"]
    assert found is not None
    return found["n_robots"], found["alpha_s"], found["alpha_c"]


def draw(records: Sequence[WholeRecord], path: Path) -> None:
    """Draw one panel an instance."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.4 * len(records), 4.6), layout="constrained")
    for axes, record in zip(figure.subplots(1, len(records), squeeze=False)[0], records, strict=True):
        _panel(axes, record)
    figure.supxlabel(KEY, fontsize=9.5)
    figure.savefig(path, dpi=150)


def _panel(axes: Axes, record: WholeRecord) -> None:
    found = record["instance"]
    assert found is not None
    axes.set_axis_off()
    axes.set_xlim(-0.6, 3.6)
    axes.set_ylim(-3.6, 1.8)
    n, s, c = _size(record)
    axes.set_title(f"{numbered(record['label'])}: N = {n}, blinded {s}, links cut {c}", fontsize=11)
    _groups(axes, found)
    for row, line in enumerate(_lines(record, found)):
        axes.text(-0.5, -1.0 - 0.42 * row, line, fontsize=9.5, va="top")


def _groups(axes: Axes, found: InstanceRecord) -> None:
    """Draw each group that A* leaves as a row of robots; a cross marks a blinded one."""
    from matplotlib.patches import FancyBboxPatch

    heights = [1.2 - 1.25 * k for k in range(len(found["groups"]))]
    for y, group in zip(heights, found["groups"], strict=True):
        box = FancyBboxPatch(
            (-0.35, y - 0.42), len(group) - 0.12, 0.84, boxstyle="round,pad=0.05", fill=False, edgecolor="#555555"
        )
        axes.add_patch(box)
        for x, robot in enumerate(group):
            colour = BAIT if robot in found["bait"] else GREEDY
            axes.plot(x, y, "o", markersize=24, color=colour, alpha=0.3 if robot in found["sensing"] else 1)
            axes.annotate(found["elements"][robot], (x + 0.24, y), ha="left", va="center", fontsize=10)
            if robot in found["sensing"]:
                axes.plot(x, y, "x", markersize=22, color="#a00000", markeredgewidth=2)


def _lines(record: WholeRecord, found: InstanceRecord) -> list[str]:
    """Say in words what the panel shows."""
    values = [f"{name} = {value}" for name, value in found["values_in_play"].items()]
    return [
        f"A* is a worst attack on {record['worst_for']}; {found['curvature']}",
        f"worst cases: RATT's plan {found['ratt_worst']:g}, the optimum {found['optimum']:g}",
        "The line says, with common factors divided out,",
        f"    {found['line']}",
        f"but {', '.join(values)}:",
        f"    it lacks {found['violation']}.",
    ]


def main(arguments: list[str] | None = None) -> None:
    """Draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ledger", type=Path, required=True, help="folder of ratt-opt audit")
    parser.add_argument("--out", type=Path, required=True, help="picture, such as whole_instances.png")
    parser.add_argument("--record", action="store_true", help="let later audits re-check these decisions")
    options = parser.parse_args(arguments)
    document = json.loads((options.ledger / "audit.json").read_text(encoding="utf-8"))
    records = shown(document)
    if not records:
        parser.error(f"{options.ledger} holds no whole instances: run ratt-opt audit --out {options.ledger}")
    if options.record:
        if not document.get("whole_searched"):
            parser.error(f"{options.ledger} was not searched: run ratt-opt audit --search-whole --out {options.ledger}")
        record(document["whole_instances"])
    draw(records, options.out)
    print(f"written: {options.out}")


if __name__ == "__main__":
    main()
