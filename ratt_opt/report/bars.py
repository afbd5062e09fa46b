"""Draw what each planner keeps under attack against what any planner could keep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.report.tables import share_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ratt_opt.main_job.result import BoundReport

__all__ = ["draw_bars"]

PLAN = "#0b6e99"
OTHER = "#b8c4ca"
LIMIT = "#c1121f"


def draw_bars(axes: Axes, report: BoundReport) -> None:
    """Draw one bar a planner: its proved worst-case value and share of the upper bound, which a line marks."""
    plans = report.plans
    values = [plan.worst_case.lower for plan in plans]
    chosen = [plan.name == report.recommended.name for plan in plans]
    rows = range(len(plans))
    axes.barh(rows, values, color=[PLAN if c else OTHER for c in chosen], height=0.62)
    spread = max([*values, report.upper, 1e-300])
    for row, plan, value, strong in zip(rows, plans, values, chosen, strict=True):
        inside = value > 0.3 * spread
        place = value - 0.02 * spread if inside else value + 0.02 * spread
        colour = "white" if inside and strong else "black"
        side = "right" if inside else "left"
        axes.text(
            place,
            row,
            f"{value:.6g}, {share_text(report.share(plan))}",
            va="center",
            ha=side,
            fontsize=9,
            color=colour,
        )
    axes.axvline(report.upper, color=LIMIT, linewidth=1.6, linestyle="--")
    axes.set_title(f"no plan can keep more than {report.upper:.6g}", fontsize=9.5, color=LIMIT, loc="right")
    axes.set_yticks(list(rows), [plan.name for plan in plans])
    axes.invert_yaxis()
    axes.set_xlim(0, 1.06 * spread)
    unit = f" [{report.unit}]" if report.unit else ""
    axes.set_xlabel(f"{report.objective} value kept under the worst attack{unit}")
    axes.spines[["top", "right"]].set_visible(False)
