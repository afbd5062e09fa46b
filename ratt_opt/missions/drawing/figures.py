"""Curves of one mission, or of the same mission over several seeds: error against belief, and consistency."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import stdtrit

from ratt_opt.report.lettering import choose_fonts, literal
from ratt_opt.report.palette import INK, LOST, SURVIVING
from ratt_opt.running.interrupts import imported_whole

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ratt_opt._validation import FloatArray
    from ratt_opt.missions.result import FlownMission

__all__ = ["mission_figure"]


def mission_figure(missions: Sequence[FlownMission]) -> Figure:
    """RMSE above NEES, step by step; of several seeds the mean with its 95 % interval (Student's t).

    NEES has a logarithmic axis: a filter that claims ten times too much is as far off as one that claims a tenth.
    """
    first = missions[0]
    figure: Figure = imported_whole("matplotlib.figure").Figure(figsize=(8, 6.5), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    steps = np.arange(1, len(first.steps) + 1)
    _curve(above, steps, np.array([m.rmse for m in missions]), "error (RMSE)")
    believed = np.sqrt(np.mean([m.traces for m in missions], axis=0))
    above.plot(steps, believed, color=INK, linestyle=":", label="what the filter states (root of the mean trace)")
    above.set_ylabel("RMSE [m]")
    above.set_ylim(bottom=0)
    _curve(below, steps, np.array([m.nees for m in missions]), "NEES")
    low, high = first.nees_band()
    below.axhspan(low, high, color=LOST, alpha=0.3, label="95 % band of one mission's step")
    below.axhline(first.dimension, color=INK, linewidth=0.8, linestyle="--", label="expected")
    below.set_ylabel("NEES, mean over targets")
    below.set_xlabel("step")
    below.xaxis.get_major_locator().set_params(integer=True)
    below.set_yscale("log")
    below.yaxis.set_major_formatter("{x:g}")
    low, high = below.get_ylim()
    # On a wider axis the ticks between powers of ten would have numbers that touch.
    below.yaxis.set_minor_formatter("{x:g}" if high < 20 * low else "")
    for axes in (above, below):
        axes.legend(frameon=False, fontsize=8.5)
        axes.grid(visible=True, color="#eeeeee", linewidth=0.8)
    said = (f"{name} {literal(str(first.settings[name]))}" for name in ("planner", "attacker", "attacks"))
    above.set_title(fill(", ".join(said)), fontsize="medium")  # lines of 70 letters are as wide as the figure
    choose_fonts(figure)
    return figure


def _curve(axes: Axes, steps: Any, values: FloatArray, label: str) -> None:
    mean, n = values.mean(axis=0), len(values)
    if n > 1:
        half = float(stdtrit(n - 1, 0.975)) * values.std(axis=0, ddof=1) / n**0.5
        lowest = np.maximum(mean - half, 0.0)  # neither is ever negative, so the interval loses nothing
        axes.fill_between(steps, lowest, mean + half, color=SURVIVING, alpha=0.2)
        label = f"{label}, mean of {n} seeds with 95 % interval"
    axes.plot(steps, mean, color=SURVIVING, marker=".", markersize=4, label=label)
