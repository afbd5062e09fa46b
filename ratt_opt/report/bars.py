"""Draw the worst-case value of each planner's plan beside the best possible one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt._rounding import bracket_text, up
from ratt_opt.report.lettering import literal
from ratt_opt.report.palette import INK, looks_of
from ratt_opt.report.tables import share_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ratt_opt.findings import Findings

__all__ = ["bar_ends", "draw_bars"]

CLOSE = 0.5
"""From this share of the bound on, what is missing is drawn, not what is kept: one per cent stays visible."""
ROOM = 2.5
"""The axis ends at this many times the longest bar, so that the numbers beside the bars have room."""


NOTHING = 1e-9
"""Less than this share of the bound is rounding: no whisker shows it, and it must not fill the axis."""


def bar_ends(report: Findings) -> tuple[bool, list[tuple[float, float]], float]:
    """Return whether bars show what is missing to the bound, the ends of each planner's bar, and the full length."""
    ends = [(plan.worst_case.lower, plan.worst_case.upper) for plan in report.plans]
    missing = min(low for low, _ in ends) >= CLOSE * report.upper > 0
    if missing:
        ends = [(max(report.upper - high, 0.0), max(report.upper - low, 0.0)) for low, high in ends]
    longest = max([high for _, high in ends] + ([] if missing else [report.upper]))
    return missing, ends, longest if longest > NOTHING * report.upper else max(report.upper, 1.0)


def draw_bars(axes: Axes, report: Findings) -> None:
    """Draw one bar a planner and its number: its proved value, or, if all values are high, its proved shortfall.

    A whisker spans what is not decided of it, so a search that ran out of time shows a whisker, never a value.
    """
    plans = report.plans
    missing, ends, longest = bar_ends(report)
    least = NOTHING * report.upper
    looks = looks_of([plan.name for plan in plans])
    for row, (plan, (low, high)) in enumerate(zip(plans, ends, strict=True)):
        look, chosen = looks[plan.name], plan.name == report.recommended.name
        axes.barh(row, low, color=look.colour, hatch=look.hatch, height=0.62, edgecolor="white", linewidth=0)
        if high - low > least:
            axes.errorbar((low + high) / 2, row, xerr=(high - low) / 2, color=INK, capsize=5, linewidth=1.4)
        kept = bracket_text(plan.worst_case.lower, plan.worst_case.upper, digits=6)
        share = share_text(plan.worst_case.lower, report.upper)
        text = f"{kept}, {share}" if share.startswith("optimal") else f"{kept}, {share} of the best"
        at, weight = high + 0.02 * ROOM * longest, "bold" if chosen else "normal"
        room = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}  # no line runs through the words
        axes.text(at, row, text, va="center", ha="left", fontsize=9, weight=weight, bbox=room)
    axes.axvline(0 if missing else report.upper, color=INK, linewidth=1.6, linestyle="--")
    axes.set_title(f"no plan can have more than {up(report.upper, 6)} (dashed)", fontsize=9.5, loc="right")
    axes.set_yticks(range(len(plans)), [literal(plan.name) for plan in plans])
    axes.invert_yaxis()
    axes.set_xlim(0, ROOM * longest)
    unit = f"[{literal(report.unit)}] " if report.unit else ""
    what = "shortfall from the best possible" if missing else "value"
    axes.set_xlabel(f"{literal(report.objective)}: {what} under the worst attack\n{unit}(whiskers: not decided)")
    axes.spines[["top", "right"]].set_visible(False)
