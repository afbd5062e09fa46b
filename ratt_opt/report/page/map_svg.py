"""The map of a page: the drawing of the figure, whose robots and targets tell who they are.

A mouse, a keyboard and a screen reader find them by marks that lie over the drawing.
"""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.report.description import describe, named
from ratt_opt.report.fields import watched_pairs
from ratt_opt.report.legend import legend_outside
from ratt_opt.report.lettering import choose_fonts
from ratt_opt.report.map import draw_map, name_things
from ratt_opt.report.picture import picture_of
from ratt_opt.running.interrupts import imported_whole

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import FloatArray
    from ratt_opt.findings import AssessedPlan, Findings
    from ratt_opt.report.picture import Picture

__all__ = ["page_maps"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PageMap:
    """Sizes of a map on a page.

    ``width``, ``height`` : of the drawing without its legend [inches]. Smaller ones have larger words on the page.
    ``legend`` : height of the legend's letters [points]. Larger ones make the drawing higher.
    ``mark`` : radius around a robot or target that tells who it is [points]. Marks of neighbours overlap if larger.
    """

    width: float = 7.0
    height: float = 5.2
    legend: float = 7.0
    mark: float = 7.0


SIZES = PageMap()


def page_maps(report: Findings) -> dict[str, str]:
    """Draw a map for each attack that the report shows: SVG, which has no name in common with the others."""
    drawn = ((key, view, picture_of(report.source, report, view)) for key, view in report.views.items())
    return {key: _map_svg(key.replace(" ", "-"), picture, report, view) for key, view, picture in drawn}


def _map_svg(key: str, picture: Picture, report: Findings, view: AssessedPlan, sizes: PageMap = SIZES) -> str:
    figsize = (sizes.width, sizes.height)
    figure: Any = imported_whole("matplotlib.figure").Figure(figsize=figsize, layout="constrained")
    axes = figure.add_subplot()
    draw_map(axes, picture)
    axes.get_legend().remove()
    legend_outside(figure, *axes.get_legend_handles_labels(), loc="outside lower center", fontsize=sizes.legend)
    choose_fonts(figure)
    name_things(axes, picture)
    svg = _drawn(figure)
    svg = re.sub(r'(\bid="|href="#|url\(#)', rf"\1{key}-", svg[svg.index("<svg") :])
    label = f"Map of {len(picture.places)} robots under attack; tab through robots and targets for their details"
    svg = svg.replace("<svg ", f'<svg class="map" role="group" aria-label="{escape(label)}" ', 1)

    def at(place: FloatArray) -> tuple[float, float]:
        x, y = axes.transData.transform(place) * 72 / figure.dpi
        return float(x), 72 * float(figure.get_figheight()) - float(y)

    told = [(at(picture.targets[j]), text) for j, text in enumerate(_target_texts(picture))]  # type: ignore[index]
    told += [(at(picture.places[i]), text) for i, text in enumerate(_robot_texts(picture, report, view))]
    marks = (_mark(x, y, sizes.mark, escape(text)) for (x, y), text in told)
    return svg.replace("</svg>", f"{''.join(marks)}</svg>")


def _drawn(figure: Any) -> str:
    """Return a figure as SVG, the same for the same figure."""
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    out = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "ratt-opt"}):
        canvas: Any = FigureCanvasSVG(figure)
        canvas.print_svg(out, metadata={"Date": None})
    return out.getvalue()


def _mark(x: float, y: float, radius: float, text: str) -> str:
    circle = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}"/>'
    return f'<g tabindex="0" role="img" aria-label="{text}"><title>{text}</title>{circle}</g>'


def _target_texts(picture: Picture) -> Iterator[str]:
    for j in range(0 if picture.targets is None else len(picture.targets)):
        text = f"target {named(j, picture.target_names[j] if picture.target_names else '', 'target')}"
        text += "" if picture.weights is None else f", weight {picture.weights[j]:g}"
        if picture.posterior is not None:
            deviation = np.sqrt(np.trace(picture.posterior[j]))
            text += f", root of the trace left after measuring {deviation:.3g} m"
        yield text + (", left unseen" if j in picture.unseen else "")


def _robot_texts(picture: Picture, report: Findings, view: AssessedPlan) -> Iterator[str]:
    known = describe(report.problem, report.source)
    for i, element in enumerate(view.elements.tolist()):
        watches = ", ".join(f"T{j}" for _, j in watched_pairs(picture, [i]))
        guarded = ", protected" if i in picture.protected_robots else ""
        text = f"robot {known.robot(i)}: {known.label(element)}; {view.role(i)}{guarded}"
        yield text + (f"; measures {watches or 'no target'}" if picture.watched is not None else "")
