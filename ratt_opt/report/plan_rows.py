"""The recommended plan as rows: what each robot does, and what becomes of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.report.description import describe

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.findings import Findings

__all__ = ["PLAN_COLUMNS", "PLAN_HEADS", "plan_rows"]

PLAN_COLUMNS = (
    *("robot", "name", "element", "control", "speed", "turn_rate"),
    *("x", "y", "heading", "bait", "under attack", "group"),
)
_UNITS = {"speed": "m/s", "turn_rate": "rad/s", "x": "m", "y": "m", "heading": "rad"}
PLAN_HEADS = tuple(name.replace("_", " ") + (f" [{_UNITS[name]}]" if name in _UNITS else "") for name in PLAN_COLUMNS)
"""Heads of the columns in a table for readers."""


def plan_rows(report: Findings) -> Iterator[tuple[object, ...]]:
    """Yield one row of ``PLAN_COLUMNS`` a robot: the recommended plan, and its role under the worst attack.

    ``speed`` [m/s] and ``turn_rate`` [rad/s] are the control in numbers; positions [m] and headings [rad] are those
    after it. All are empty if the source does not tell.
    """
    plan, known = report.recommended, describe(report.problem, report.source)
    home = {i: k for k, group in enumerate(plan.groups) for i in group}
    for i, element in enumerate(plan.elements.tolist()):
        given = known.pose_after(element) or []
        pose: list[object] = [*given, *[""] * (3 - len(given))]
        control: list[object] = ["", ""] if known.controls is None else known.controls[element].tolist()
        told = (i, known.robot_names[i], element, known.label(element), *control, *pose)
        yield *told, int(i in plan.bait), plan.role(i), home[i]
