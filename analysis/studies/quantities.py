"""What is measured once per trial, whatever the planners: brackets of the optimum and guarantees."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from analysis.studies.instance import Instance
    from analysis.studies.study import Cell

__all__ = ["QUANTITIES"]


def _optimum(instance: Instance) -> dict[str, Cell]:
    """Return the certified bracket of the optimum, and why the search stopped."""
    result = instance.optimum
    return {"optimum/lower": result.lower, "optimum/upper": result.upper, "optimum/stop": result.stop.value}


QUANTITIES: dict[str, Callable[[Instance], dict[str, Cell]]] = {"optimum": _optimum}
