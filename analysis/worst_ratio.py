"""Worst ratio against curvature, beside the bounds: ``python -m analysis.worst_ratio --out DIR [--quick]``.

Writes ``worst_ratio.csv`` (every bracket with its exact ends), ``worst_ratio.png`` and ``worst_ratio.svg``.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import asdict, dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ratt_opt import caa, worst_case_ratio
from ratt_opt.report.palette import PLANNERS
from ratt_opt.worst_ratio.closed_form import pattern_free_ratio

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["CASES", "Point", "draw", "sweep", "theorem1"]

CASES = (
    ("submodular", 4, 0, 0),
    ("submodular", 4, 1, 0),
    ("submodular", 4, 0, 3),
    ("submodular", 4, 1, 3),
    ("nondecreasing", 4, 0, 0),
    ("nondecreasing", 4, 1, 0),
    ("nondecreasing", 4, 0, 3),
    ("nondecreasing", 5, 1, 0),
    ("nondecreasing", 6, 2, 0),
)
"""Family, N, alpha_s, alpha_c."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """One bracket with the bounds that theorems give for it."""

    family: str
    n_robots: int
    alpha_s: int
    alpha_c: int
    curvature: float
    planner: str
    lower: float
    upper: float
    exact_lower: str
    exact_upper: str
    stop: str
    lower_from: str
    theorem1: float
    pattern_free: float


def theorem1(family: str, curvature: Fraction, alpha_cs: int) -> Fraction:
    """Right side of ratt.tex, eqn:appro_non_descrease or eqn:appro_submodular; without links cut, its first term."""
    kept = 1 - curvature
    first, second = (kept / (1 + curvature), kept) if family == "submodular" else (kept**3, kept**2)
    return min(first, second / alpha_cs) if alpha_cs else first


def sweep(
    cases: Iterable[tuple[str, int, int, int]],
    curvatures: Sequence[Fraction],
    *,
    planners: Sequence[str] = ("ratt",),
    time_limit: float | None = 30.0,
) -> list[Point]:
    """Bracket every case at every curvature."""
    points = []
    for family, n, alpha_s, alpha_c in cases:
        for planner in planners:
            for k in curvatures:
                found = worst_case_ratio(
                    n, alpha_s, alpha_c, curvature=k, family=family, planner=planner, time_limit=time_limit
                )
                point = Point(
                    family=family,
                    n_robots=n,
                    alpha_s=alpha_s,
                    alpha_c=alpha_c,
                    curvature=float(k),
                    planner=planner,
                    lower=found.lower,
                    upper=found.upper,
                    exact_lower=str(found.exact_lower),
                    exact_upper=str(found.exact_upper),
                    stop=found.stop.value,
                    lower_from=found.lower_from,
                    theorem1=float(theorem1(family, k, caa(n, alpha_c).alpha_cs)),
                    pattern_free=float(pattern_free_ratio(k, family)),
                )
                points.append(point)
    return points


def draw(points: Sequence[Point]) -> Figure:
    """Draw one panel per family: exact worst ratios as lines, the theorems' bounds dashed."""
    import matplotlib.pyplot as plt

    families = list(dict.fromkeys(point.family for point in points))
    figure, axes = plt.subplots(
        1, len(families), figsize=(5.6 * len(families), 4.6), squeeze=False, layout="constrained"
    )
    for axis, family in zip(axes[0], families, strict=True):
        _panel(axis, [point for point in points if point.family == family])
        axis.set_title("submodular, curvature k" if family == "submodular" else "non-decreasing, total curvature c")
    return figure


COLOURS = [PLANNERS[name].colour for name in ("maxmin", "ratt", "greedy", "nonrobust_optimum", "myopic")]
"""Colours in the order of drawing: each curve is narrower than the last, so that equal ones lie in one another."""


def _panel(axis: Axes, points: Sequence[Point]) -> None:
    cases = list(dict.fromkeys((p.n_robots, p.alpha_s, p.alpha_c, p.planner) for p in points))
    widths = [8.5, 6.0, 4.0, 2.4, 1.2]
    for index, case in enumerate(cases):
        line = [p for p in points if (p.n_robots, p.alpha_s, p.alpha_c, p.planner) == case]
        x, colour = [p.curvature for p in line], COLOURS[index % 5]
        label = rf"{case[3].upper()}, N={case[0]}, $\alpha_s$={case[1]}, $\alpha_c$={case[2]}"
        look: dict[str, Any] = {"lw": widths[index % 5], "solid_capstyle": "butt", "color": colour, "zorder": 2 + index}
        axis.plot(x, [p.upper for p in line], label=label, **look)
        axis.fill_between(x, [p.lower for p in line], [p.upper for p in line], color=colour, alpha=0.3)
    grid = sorted({p.curvature for p in points})
    one = {p.curvature: p for p in points}
    axis.plot(grid, [one[k].pattern_free for k in grid], "k--", lw=1.4, label="pattern-free theorem", zorder=20)
    best = [max(p.theorem1 for p in points if p.curvature == k) for k in grid]
    axis.plot(grid, best, "k:", lw=1.8, label="Theorem 1 (its largest over these cases)", zorder=20)
    axis.set(xlim=(0, 1), ylim=(0, 1.02), xlabel="curvature", ylabel="exact worst value of the plan / optimum")
    axis.spines[["top", "right"]].set_visible(False)
    axis.grid(alpha=0.3)
    axis.legend(fontsize=8, loc="upper right")


def write_csv(points: Sequence[Point], path: Path) -> None:
    """Write the points with a header row."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(asdict(points[0])))
        writer.writeheader()
        writer.writerows(asdict(point) for point in points)


def main(arguments: list[str] | None = None) -> None:
    """Run the study and write its table and figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--quick", action="store_true", help="four curvatures instead of twenty-one")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    steps = 3 if options.quick else 20
    points = sweep(CASES, [Fraction(i, steps) for i in range(steps + 1)])
    write_csv(points, options.out / "worst_ratio.csv")
    figure = draw(points)
    for ending in ("png", "svg"):
        figure.savefig(options.out / f"worst_ratio.{ending}", dpi=150)
    wide = [point for point in points if point.exact_lower != point.exact_upper]
    print(f"{len(points)} brackets, {len(points) - len(wide)} closed exactly")
    for point in wide:
        print(f"open: {point}")


if __name__ == "__main__":
    main()
