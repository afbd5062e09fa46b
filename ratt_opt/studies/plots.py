"""Drawing shared by the studies: colours of the planners, bars and bands with intervals, saving."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.report.labels import halo
from ratt_opt.report.latex import in_symbols
from ratt_opt.report.legend import legend_outside
from ratt_opt.report.lettering import choose_fonts, literal
from ratt_opt.report.palette import PLANNERS, looks_of
from ratt_opt.studies.statistics import headed

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ratt_opt._validation import FloatArray
    from ratt_opt.report.palette import Look
    from ratt_opt.studies.statistics import Estimate, Mean

__all__ = ["IN_TURN", "bands", "bars", "comparison", "new_figure", "points", "save", "use_palette"]

IN_TURN = [PLANNERS[name].colour for name in ("ratt", "nonrobust_optimum", "greedy", "maxmin", "random", "myopic")]
"""Colours of plain curves and bars, one after the other: neighbours differ in lightness too."""


def use_palette() -> None:
    """Let plain matplotlib calls take the library's colours, which stay apart for colour-blind readers and in grey."""
    import matplotlib as mpl
    from matplotlib.rcsetup import cycler

    mpl.rcParams["axes.prop_cycle"] = cycler(color=IN_TURN)


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure [inch] that belongs to no window system."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def bars(axes: Axes, groups: Sequence[str], series: Mapping[str, Sequence[Estimate]]) -> None:
    """Draw one group of bars per entry of ``groups``, one bar per planner of ``series``, with intervals.

    Bars start at zero, which belongs to the picture.
    """
    error = {"elinewidth": 0.9, "ecolor": "#222222"}
    looks = looks_of(list(series))
    for at, width, planner, means, spread in _side_by_side(axes, groups, series):
        look: dict[str, Any] = {"color": looks[planner].colour, "hatch": looks[planner].hatch, "edgecolor": "white"}
        look |= {"linewidth": 0, "label": literal(planner)}
        drawn = axes.bar(at, means, 0.9 * width, yerr=spread, capsize=2, error_kw=error, **look)
        assert drawn.errorbar is not None
        _, caps, lines = drawn.errorbar.lines
        for artist in (*caps, *lines):
            artist.set_path_effects(halo())  # else nobody sees them on a dark bar
    axes.axhline(0, color="black", linewidth=0.8)


def points(axes: Axes, groups: Sequence[str], series: Mapping[str, Sequence[Estimate]]) -> None:
    """Draw what :func:`bars` draws, as points: for numbers far from zero that differ little."""
    looks = looks_of(list(series))
    for at, _, planner, means, spread in _side_by_side(axes, groups, series):
        look: dict[str, Any] = {
            "color": looks[planner].colour,
            "fmt": looks[planner].marker,
            "markeredgecolor": "#222222",
        }
        axes.errorbar(at, means, spread, label=literal(planner), ms=5.5, mew=0.5, ecolor="#222222", capsize=3, **look)


def comparison(means: Sequence[Mean], note: str, unit: str = "") -> Figure:
    """Draw one metric's means of planners: a panel for each attacker, a group of marks for each case.

    Bars if the numbers are large against their differences from zero, as values are; points on a line at zero for
    differences.

    ``unit`` : of values
    """
    attackers, cases = (list(dict.fromkeys(getattr(mean, name) for mean in means)) for name in ("attacker", "case"))
    shared, groups = _told_apart(cases)
    figure = new_figure(max(5.0, min(1.2 + 1.5 * len(cases), 14.0)), 0.8 + 2.8 * len(attackers))
    every = figure.subplots(len(attackers), 1, squeeze=False, sharex=True)[:, 0]
    for axes, attacker in zip(every, attackers, strict=True):
        series: dict[str, list[Estimate]] = {}
        for mean in means:
            if mean.attacker == attacker:
                series.setdefault(mean.planner, []).append(mean.estimate)
        draw = points if means[0].minus else bars
        draw(axes, groups, series)
        axes.axhline(0, color="black", linewidth=0.8)
        axes.set_ylabel(_quantity(means[0], unit))
        axes.set_title(f"attacker: {literal(attacker)}", loc="left", fontsize="medium")
    handles, labels = every[0].get_legend_handles_labels()
    legend_outside(figure, handles, labels, loc="outside upper center")
    figure.supxlabel("\n".join(filter(None, (shared, note))), fontsize="small", wrap=True)
    choose_fonts(figure)
    return figure


def _quantity(mean: Mean, unit: str) -> str:
    """The words of the axis: the metric with its unit, and whose is taken off."""
    minus = f"\ndifference from {literal(mean.minus)}" if mean.minus else ""
    return literal(headed(mean.metric, unit)) + minus


def _told_apart(cases: Sequence[str]) -> tuple[str, list[str]]:
    """Parts of names that all cases share, and those that tell each apart, a line for each part."""
    parts = [case.split() for case in cases]
    common = [part for part in parts[0] if all(part in other for other in parts)] if len(cases) > 1 else parts[0]
    return fill(" ".join(_part(part) for part in common)), [
        "\n".join(_part(part) for part in own if part not in common) for own in parts
    ]


def _part(part: str) -> str:
    """A part of a case's name with the paper's symbols."""
    return in_symbols(literal(part))


def _side_by_side(
    axes: Axes, groups: Sequence[str], series: Mapping[str, Sequence[Estimate]]
) -> Iterator[tuple[FloatArray, float, str, FloatArray, FloatArray]]:
    """Prepare the axes; yield position, width, name, mean and (2, G) interval of every planner's marks."""
    centres, width = np.arange(len(groups), dtype=np.float64), 0.8 / len(series)
    axes.set_xticks(centres, groups)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", alpha=0.3)
    axes.set_axisbelow(True)
    for k, (planner, estimates) in enumerate(series.items()):
        means = np.array([e.mean for e in estimates])
        spread = np.array([[e.mean - e.low for e in estimates], [e.high - e.mean for e in estimates]])
        at = centres + (k - (len(series) - 1) / 2) * width
        spread[~np.isfinite(spread)] = 0
        yield at, width, planner, means, spread


def bands(
    axes: Axes, x: Sequence[float], estimates: Sequence[Estimate], *, look: Look, label: str, dashed: bool = False
) -> None:
    """Draw a curve of means with its confidence band; ``dashed`` if it may run along one drawn before."""
    colour = look.colour
    style: dict[str, Any] = {"linestyle": (0, (3, 3)), "markerfacecolor": "none"} if dashed else {}
    means = [e.mean for e in estimates]
    axes.plot(x, means, color=colour, label=label, marker=look.marker, markersize=7 if dashed else 4.5, **style)
    low, high = ([getattr(e, side) for e in estimates] for side in ("low", "high"))
    if np.isfinite([*low, *high]).all():
        axes.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(alpha=0.3)


def save(figure: Figure, folder: Path, name: str) -> None:
    """Write ``name.png`` and ``name.svg`` into ``folder``; the same rows give the same bytes."""
    from matplotlib import rc_context

    from ratt_opt._files import write_atomically

    with rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}):
        write_atomically(folder / f"{name}.png", lambda file: figure.savefig(file, dpi=120))
        write_atomically(folder / f"{name}.svg", lambda file: figure.savefig(file, metadata={"Date": None}))
