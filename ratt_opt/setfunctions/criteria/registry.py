"""All criteria, found by the names that files, tables and the command line use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.errors import InputError
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import OutputTraceObjective, TraceObjective

if TYPE_CHECKING:
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["CERTIFIED", "CRITERIA", "criterion_called"]

CRITERIA: dict[str, type[InformationObjective]] = {
    criterion.name: criterion for criterion in (TraceObjective, LogDetObjective, MaxEigenvalueObjective)
}
"""A new criterion is a file beside these and a name in this line."""

CERTIFIED: tuple[type[InformationObjective], ...] = (*CRITERIA.values(), OutputTraceObjective)
"""Criteria whose tangents the verifier knows; subclasses of them may have another formula."""


def criterion_called(name: str) -> type[InformationObjective]:
    """The criterion of that name. InputError : there is none."""
    if name not in CRITERIA:
        *names, last = CRITERIA
        raise InputError("objective", f"must be {', '.join(names)} or {last}", name)
    return CRITERIA[name]
