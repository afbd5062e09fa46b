"""Three forms of a problem besides matrices: a table, a sum of parts, and a network to be cut."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Literal, Self

import networkx as nx
import numpy as np
from pydantic import Field, model_validator

from ratt_opt.errors import InputError
from ratt_opt.problem import Problem
from ratt_opt.scenario.information_input import InformationInput
from ratt_opt.scenario.problem_record import Link
from ratt_opt.scenario.record import NonNegative, Number, Positive, Record, Whole
from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.setfunctions.best_elements import Coverage, FacilityLocation

if TYPE_CHECKING:
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["Form", "NetworkInput", "SumInput", "TableInput", "TeamInput"]

MOST_TABLED, MOST_NODES = 20, 2000
"""Elements of a table, of which the file has ``2**n`` values; robots of a network."""


class TeamInput(Record, ABC):
    """Robots, links and budgets of a problem whose set function a subclass gives.

    ``robot`` : (E,) owner of each element; ``links`` : of robots, or ``None`` for all
    """

    robot: Annotated[tuple[Whole, ...], Field(min_length=1)]
    alpha_s: Whole
    alpha_c: Whole
    links: tuple[Link, ...] | None = None
    protected_robots: tuple[Whole, ...] = ()
    protected_links: tuple[Link, ...] = ()

    @model_validator(mode="after")
    def _check_team(self) -> Self:
        if max(self.robot) >= MOST_NODES:
            raise InputError("robot", f"must name robots below {MOST_NODES}", max(self.robot))
        assert self.stated
        return self

    @property
    @abstractmethod
    def function(self) -> SetFunction:
        """The set function over the elements."""

    @cached_property
    def stated(self) -> Problem:
        """The problem. InputError : a field breaks its rule."""
        graph: nx.Graph | None = None
        if self.links is not None:
            graph = nx.empty_graph(max(self.robot) + 1)
            graph.add_edges_from(self.links)
        budgets = self.alpha_s, self.alpha_c
        return Problem(self.function, self.robot, graph, *budgets, self.protected_robots, self.protected_links)


class TableInput(TeamInput):
    """A set function by its values: ``values`` (2**E,), by bit masks over the elements."""

    format: Literal["ratt-opt table"] = "ratt-opt table"
    version: Literal[1] = 1
    values: Annotated[tuple[Number, ...], Field(min_length=1, max_length=2**MOST_TABLED)]

    @property
    def function(self) -> SetFunction:
        """The table."""
        if len(self.values) != 2 ** min(len(self.robot), MOST_TABLED + 1):
            raise InputError("values", f"must have 2**{len(self.robot)} entries, one per set", len(self.values))
        return TableFunction(self.values)


class SumInput(TeamInput):
    """A sum of parts that are worth their best element: coverage or facility location.

    ``covers`` : (E,) lists of the items that each element covers, with ``weights`` (items,), for ``"coverage"``;
    ``utility`` : (E, customers), for ``"facility location"``.
    """

    format: Literal["ratt-opt sum"] = "ratt-opt sum"
    version: Literal[1] = 1
    kind: Literal["coverage", "facility location"]
    covers: tuple[tuple[Whole, ...], ...] | None = None
    weights: tuple[Positive, ...] | None = None
    utility: tuple[tuple[NonNegative, ...], ...] | None = None

    @property
    def function(self) -> Coverage | FacilityLocation:
        """Coverage or facility location."""
        given = self.covers if self.kind == "coverage" else self.utility
        field = "covers" if self.kind == "coverage" else "utility"
        if given is None or len(given) != len(self.robot):
            rule = f"must have {len(self.robot)} entries, one per element, for {self.kind}"
            raise InputError(field, rule, "none" if given is None else len(given))
        if self.kind == "coverage":
            return self._coverage()
        if len({len(row) for row in self.utility or ()}) > 1:
            raise InputError("utility", "must have rows of one length", "rows of several lengths")
        return FacilityLocation(self.utility or ())

    def _coverage(self) -> Coverage:
        if self.weights is None:
            raise InputError("weights", "must be given for coverage", "none")
        covers = np.zeros((len(self.robot), len(self.weights)), dtype=np.bool_)
        for row, items in zip(covers, self.covers or (), strict=True):
            if items and max(items) >= len(self.weights):
                raise InputError("covers", f"must name items below {len(self.weights)}", max(items))
            row[list(items)] = True
        return Coverage(covers, self.weights)


class NetworkInput(Record):
    """Fewest cuts: links of least weight whose removal leaves groups of at most ``size``.

    ``robots`` : their number; ``weights`` : (links,) and ``sizes`` : (robots,) whole numbers, or ``None`` for ones
    """

    format: Literal["ratt-opt network"] = "ratt-opt network"
    version: Literal[1] = 1
    robots: Annotated[Whole, Field(le=MOST_NODES, gt=0)]
    links: tuple[Link, ...]
    size: Annotated[Whole, Field(gt=0)]
    weights: tuple[Whole, ...] | None = None
    sizes: tuple[Whole, ...] | None = None

    @model_validator(mode="after")
    def _check_network(self) -> Self:
        for name, given, length in (("weights", self.weights, len(self.links)), ("sizes", self.sizes, self.robots)):
            if given is not None and len(given) != length:
                raise InputError(name, f"must have {length} entries", len(given))
        if len(set(self.links)) < len(self.links):
            raise InputError("links", "must not repeat a link", f"{len(self.links)} links")
        for link in self.links:
            if link[1] >= self.robots:
                raise InputError("links", f"must join robots below {self.robots}", list(link))
        if self.sizes is not None and max(self.sizes) > self.size:
            raise InputError("size", "must be at least that of every robot", self.size)
        return self

    @cached_property
    def graph(self) -> nx.Graph:
        """The network."""
        graph: nx.Graph = nx.empty_graph(self.robots)
        graph.add_edges_from(self.links)
        return graph

    @property
    def weight_of(self) -> dict[tuple[int, int], int] | None:
        """Weights by link, or ``None`` for ones."""
        return None if self.weights is None else dict(zip(self.links, self.weights, strict=True))


Form = InformationInput | TableInput | SumInput | NetworkInput
"""The forms that an instance's problem may have; ``format`` of the record says which."""
