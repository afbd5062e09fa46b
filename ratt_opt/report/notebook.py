"""Views of results in a notebook: a table of the planners, the plan, and the figure."""

from __future__ import annotations

import io
from html import escape
from typing import TYPE_CHECKING

from ratt_opt._rounding import bracket_text
from ratt_opt._values import counted
from ratt_opt.report.figure import plan_figure
from ratt_opt.report.picture import picture_of
from ratt_opt.report.tables import share_text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.findings import AssessedPlan, Findings

__all__ = ["html_table", "plan_view", "report_view"]


def html_table(caption: str, columns: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Return a table with a caption and headed columns; every text is escaped. Cells know the name of their column."""
    names = list(columns)
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in names)
    body = "".join(f"<tr>{''.join(map(_cell, names, row))}</tr>" for row in rows)
    return f"<table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(name: str, value: object) -> str:
    return f'<td data-column="{escape(name)}">{escape(str(value))}</td>'


def plan_view(plan: AssessedPlan) -> str:
    """Return one plan as a table: what each robot does, and its role under attack."""
    attack = plan.worst_case.attack
    rows = [
        (i, element, "yes" if i in plan.bait else "", plan.role(i)) for i, element in enumerate(plan.elements.tolist())
    ]
    kept = bracket_text(plan.worst_case.lower, plan.worst_case.upper)
    lost = f"{counted(len(attack.sensing), 'robot')} blinded and {counted(len(attack.links), 'link')} cut"
    title = f"{plan.planner}: keeps {kept} with {lost}"
    return html_table(title, ("robot", "element", "bait", "under attack"), rows)


def report_view(report: Findings) -> str:
    """Return the planners' table and the figure, which needs no file beside it."""
    rows = [
        (
            plan.planner,
            bracket_text(plan.worst_case.lower, plan.worst_case.upper),
            share_text(plan.worst_case.lower, report.upper),
        )
        for plan in report.plans
    ]
    table = html_table(
        "planners under their worst attacks", ("planner", "worst-case value", "share of the best possible"), rows
    )
    drawing = io.StringIO()
    plan_figure(report, picture_of(report.source, report)).savefig(drawing, format="svg", metadata={"Date": None})
    svg = drawing.getvalue()
    return table + svg[svg.index("<svg") :]
