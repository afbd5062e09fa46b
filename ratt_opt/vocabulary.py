"""One name for each planner and attacker; names of earlier versions are read for one release, with a warning."""

from __future__ import annotations

import warnings
from typing import TypeVar

__all__ = ["ByCurrentName", "current_column", "current_name"]

FORMER = {
    "planner": {"optimum": "maxmin", "nonrobust": "nonrobust_optimum"},
    "attacker": {"exact": "worst", "bounded rational": "bounded_rational"},
}
"""The name of today by the former one."""

T = TypeVar("T")


def current_name(role: str, name: T, *, stacklevel: int = 3) -> T | str:
    """The name of today of a planner or attacker; a former one warns, and everything else is returned as it is."""
    new = FORMER[role].get(name) if isinstance(name, str) else None
    if new is None:
        return name
    warnings.warn(f"the {role} {name!r} is called {new!r} now", FutureWarning, stacklevel=stacklevel)
    return new


def current_column(column: str) -> str:
    """The name of today of a column ``planner/attacker/metric``; other columns as they are."""
    parts = column.split("/")
    if len(parts) != 3:
        return column
    planner, attacker = FORMER["planner"].get(parts[0], parts[0]), FORMER["attacker"].get(parts[1], parts[1])
    return "/".join((planner, attacker, parts[2]))


class ByCurrentName(dict[str, T]):
    """Results by attacker, which answer to former names with a warning."""

    def __missing__(self, name: str) -> T:
        new = current_name("attacker", name, stacklevel=4)
        if new == name:
            raise KeyError(name)
        return self[new]
