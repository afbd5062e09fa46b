"""A legend outside the axes, whole whatever it lists: its columns fit the figure, which grows by its rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from matplotlib.legend import Legend

__all__ = ["legend_outside"]


def legend_outside(figure: Figure, handles: Sequence[Any], labels: Sequence[str], *, loc: Any, **look: Any) -> Legend:
    """Add a legend and make the figure taller by its height; the layout of ``figure`` must be constrained.

    ``loc`` : where it goes, as matplotlib names it: "outside upper center"
    ``look`` : further arguments of the legend
    """
    for columns in range(len(labels), 0, -1):
        legend: Legend = figure.legend(handles, labels, loc=loc, ncols=columns, frameon=False, **look)
        box = legend.get_window_extent()
        if box.width <= figure.bbox.width or columns == 1:
            break
        legend.remove()
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + box.height / figure.dpi)
    return legend
