"""All criteria, found by the names that files, tables and the command line use."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from ratt_opt.errors import InputError
from ratt_opt.setfunctions.criteria.names import CLASSES

if TYPE_CHECKING:
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["CERTIFIED", "CRITERIA", "WITH_OUTPUT", "get_criterion"]

CRITERIA: dict[str, type[InformationObjective]] = {
    name: getattr(import_module(f"ratt_opt.setfunctions.criteria.{name}"), kind) for name, kind in CLASSES.items()
}
"""Criteria by name, in the order of ``names.py``."""

CERTIFIED = tuple(CRITERIA.values())
"""Criteria whose tangents the verifier knows."""

WITH_OUTPUT = {name: kind for name, kind in CRITERIA.items() if kind.supports_output}
"""Criteria that support a part of the state, ``output=C``, by name."""


def get_criterion(name: str) -> type[InformationObjective]:
    """The criterion of that name. InputError : there is none."""
    if name not in CRITERIA:
        *names, last = CRITERIA
        raise InputError("objective", f"must be {', '.join(names)} or {last}", name)
    return CRITERIA[name]
