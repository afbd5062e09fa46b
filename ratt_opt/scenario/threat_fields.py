"""Fields that every input file shares: links, budgets, protections, objective."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Protocol

from pydantic import AfterValidator

from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat
from ratt_opt.scenario.record import Whole
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective

if TYPE_CHECKING:
    import networkx as nx

    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["OBJECTIVES", "Link", "check_threat_fields", "objective_class"]

OBJECTIVES: dict[str, type[InformationObjective]] = {
    "trace": TraceObjective,
    "logdet": LogDetObjective,
    "maxeig": MaxEigenvalueObjective,
}


def _ordered(link: tuple[int, int]) -> tuple[int, int]:
    if link[0] == link[1]:
        raise InputError("", "must join two different robots", list(link))
    return (min(link), max(link))


Link = Annotated[tuple[Whole, Whole], AfterValidator(_ordered)]
"""Two robots that can communicate; stored with the lower one first."""


class _ThreatFields(Protocol):
    @property
    def alpha_s(self) -> int: ...
    @property
    def alpha_c(self) -> int: ...
    @property
    def links(self) -> tuple[tuple[int, int], ...] | None: ...
    @property
    def protected_robots(self) -> tuple[int, ...]: ...
    @property
    def protected_links(self) -> tuple[tuple[int, int], ...]: ...


def check_threat_fields(fields: _ThreatFields, n_robots: int, graph: nx.Graph | None) -> None:
    """Check links, budgets and protections against each other.

    Raises
    ------
    InputError : a link names no robot or is repeated, a budget is out of range, or a protection names nothing.
    """
    links = fields.links or ()
    known: set[tuple[int, int]] = set()
    for k, link in enumerate(links):
        if link[1] >= n_robots:
            raise InputError(f"links[{k}]", f"must join robots in [0, {n_robots - 1}]", list(link))
        if link in known:
            raise InputError(f"links[{k}]", "must not be repeated", list(link))
        known.add(link)
    complete = CommunicationGraph.complete(n_robots)
    communication = complete if graph is None else CommunicationGraph.from_networkx(graph, n_robots)
    protections = frozenset(fields.protected_robots), frozenset(fields.protected_links)
    Threat(communication, fields.alpha_s, fields.alpha_c, *protections)


def objective_class(objective: str) -> type[InformationObjective]:
    """The set function called ``"trace"``, ``"logdet"`` or ``"maxeig"``.

    Raises
    ------
    InputError : any other name.
    """
    if objective not in OBJECTIVES:
        raise InputError("objective", "must be trace, logdet or maxeig", objective)
    return OBJECTIVES[objective]
