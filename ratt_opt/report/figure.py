"""The figure of a bound report: the map with the worst attack beside the bars of all planners."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt._files import write_atomically
from ratt_opt._rounding import down
from ratt_opt.errors import InputError, printable
from ratt_opt.report.bars import draw_bars
from ratt_opt.report.lettering import choose_fonts, literal
from ratt_opt.report.map import draw_map, name_things
from ratt_opt.report.tables import share_text
from ratt_opt.running.interrupts import imported_whole

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from matplotlib.figure import Figure

    from ratt_opt.findings import Findings
    from ratt_opt.report.picture import Picture

__all__ = ["draw_or_remark", "plan_figure", "save_figure"]


def draw_or_remark(draw: Callable[[], list[Path]]) -> tuple[list[Path], tuple[str, ...]]:
    """Return the files of figures, and a remark if they cannot be drawn: numbers never wait for a picture.

    InputError : the folder cannot be written.
    """
    try:
        return draw(), ()
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001  (whatever a drawing library or a name does)
        fault = f"{type(error).__name__}: {error}"
        return [], (f"the figures could not be drawn ({printable(fault)[:200]})",)


def plan_figure(report: Findings, picture: Picture) -> Figure:
    """Return the figure: the map beside the bars."""
    plan = report.recommended
    attack = plan.worst_case.attack
    figure: Figure = imported_whole("matplotlib.figure").Figure(figsize=(14, 8), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.35, 1))
    draw_map(left, picture)
    draw_bars(right, report)
    share = share_text(plan.worst_case.lower, report.upper)
    share = share if share.startswith("optimal") else f"{share} of the best possible"
    unit = f" {literal(report.unit)}" if report.unit else ""
    figure.suptitle(
        f"{literal(plan.planner)} plan. "
        f"Worst attack: {len(attack.sensing)} of {report.problem.n_robots} robots blinded, "
        f"{len(attack.links)} of {len(report.problem.communication.links)} links cut.\n"
        f"Worst-case value {down(plan.worst_case.lower, 6)}{unit}: {share}.",
        fontsize=11.5,
    )
    choose_fonts(figure)
    name_things(left, picture)
    return figure


def save_figure(figure: Figure, path: Path) -> None:
    """Write ``path`` in the format of its suffix (png or svg), whole or not at all, without dates.

    A canvas of that format draws once. ``savefig`` draws twice: the first time for margins, which are not cut here.
    """
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    def write(file: Path) -> None:
        if path.suffix == ".svg":
            svg: Any = FigureCanvasSVG(figure)
            svg.print_svg(file, metadata={"Date": None})
        else:
            figure.set_dpi(150)
            png: Any = FigureCanvasAgg(figure)
            png.print_png(file)

    canvas, dpi = figure.canvas, figure.dpi
    try:
        with mpl.rc_context({"svg.hashsalt": "ratt-opt"}):
            write_atomically(path, write)
    finally:
        figure.set_dpi(dpi)
        figure.set_canvas(canvas)
