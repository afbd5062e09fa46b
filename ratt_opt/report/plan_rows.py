"""The recommended plan as rows: what each robot does, and what becomes of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.report.description import describe

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.findings.bound import Findings

__all__ = ["PLAN_COLUMNS", "plan_rows"]

PLAN_COLUMNS = ("robot", "name", "element", "control", "x", "y", "heading", "bait", "under attack", "group")


def plan_rows(report: Findings) -> Iterator[tuple[object, ...]]:
    """Yield one row of ``PLAN_COLUMNS`` a robot: the recommended plan, and its role under the worst attack.

    Positions [m] and headings [rad] are those after the control; empty where the source does not tell.
    """
    plan, known = report.recommended, describe(report.problem, report.source)
    home = {i: k for k, group in enumerate(plan.groups) for i in group}
    for i, element in enumerate(plan.elements.tolist()):
        given = known.pose_after(element) or []
        pose: list[object] = [*given, *[""] * (3 - len(given))]
        role = "blinded" if i in plan.worst_case.attack.sensing else "sees" if i in plan.best_group else "cut off"
        yield i, known.robot_names[i], element, known.label(element), *pose, int(i in plan.bait), role, home[i]
