"""Draw the worst-case value of each planner's plan beside the best possible one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ratt_opt._rounding import bracket_text, up
from ratt_opt.report.lettering import in_lines, literal
from ratt_opt.report.palette import INK, looks_of
from ratt_opt.report.tables import share_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ratt_opt.findings import Findings

__all__ = ["bar_ends", "draw_bars"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BarRows:
    """Layout of a row of the panel, in rows: a bar with its number above it.

    ``thick`` : height of a bar; more of it leaves less room for the number.
    ``beyond`` : length of the axis in longest bars, so that the dashed line is inside; more of it shortens the bars.
    ``close`` : share of the bound from which the gap to it is drawn instead of the value: one per cent stays visible.
    ``rounding`` : share of the bound; less is rounding: no whisker shows it, and it must not fill the axis.
    """

    thick: float = 0.5
    beyond: float = 1.04
    close: float = 0.5
    rounding: float = 1e-9


ROWS = BarRows()


def bar_ends(report: Findings) -> tuple[bool, list[tuple[float, float]], float]:
    """Return whether bars show what is missing to the bound, the ends of each planner's bar, and the full length."""
    ends = [(plan.worst_case.lower, plan.worst_case.upper) for plan in report.plans]
    missing = min(low for low, _ in ends) >= ROWS.close * report.upper > 0
    if missing:
        ends = [(max(report.upper - high, 0.0), max(report.upper - low, 0.0)) for low, high in ends]
    longest = max([high for _, high in ends] + ([] if missing else [report.upper]))
    return missing, ends, longest if longest > ROWS.rounding * report.upper else max(report.upper, 1.0)


def draw_bars(axes: Axes, report: Findings) -> None:
    """Draw one bar a planner and its number: its proved value, or, if all values are high, its proved shortfall.

    A whisker spans what is not decided of it, so a search that ran out of time shows a whisker, never a value.
    """
    plans = report.plans
    missing, ends, longest = bar_ends(report)
    least = ROWS.rounding * report.upper
    looks = looks_of([plan.planner for plan in plans])
    for row, (plan, (low, high)) in enumerate(zip(plans, ends, strict=True)):
        look, chosen = looks[plan.planner], plan.planner == report.recommended.planner
        axes.barh(row, low, color=look.colour, hatch=look.hatch, height=ROWS.thick, edgecolor="white", linewidth=0)
        if high - low > least:
            axes.errorbar((low + high) / 2, row, xerr=(high - low) / 2, color=INK, capsize=5, linewidth=1.4)
        kept = bracket_text(plan.worst_case.lower, plan.worst_case.upper, digits=6)
        share = share_text(plan.worst_case.lower, report.upper)
        text = f"{kept}, {share}" if share.startswith("optimal") else f"{kept}, {share} of the best"
        weight = "bold" if chosen else "normal"
        above: dict[str, Any] = {"xytext": (4, 2), "textcoords": "offset points", "va": "bottom", "ha": "left"}
        axes.annotate(text, (0, row - ROWS.thick / 2), fontsize=9, weight=weight, **above)
    axes.axvline(0 if missing else report.upper, color=INK, linewidth=1.6, linestyle="--")
    axes.set_title(f"no plan can have more than {up(report.upper, 6)} (dashed)", fontsize=9.5, loc="right")
    axes.set_yticks(range(len(plans)), [in_lines(plan.planner) for plan in plans])
    axes.set_ylim(len(plans) - 1 + ROWS.thick, -1 + ROWS.thick / 2)  # the first on top, its number inside
    axes.set_xlim(0, ROWS.beyond * longest)
    unit = f"[{literal(report.unit)}] " if report.unit else ""
    what = "shortfall from the best possible" if missing else "value"
    axes.set_xlabel(f"{literal(report.objective)}: {what} under the worst attack\n{unit}(whiskers: not decided)")
    axes.spines[["top", "right"]].set_visible(False)
