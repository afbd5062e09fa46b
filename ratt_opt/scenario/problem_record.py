"""Common part of both kinds of input: links, budgets and protections, and the problem that they become."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Annotated

import networkx as nx
import numpy as np
from pydantic import AfterValidator

from ratt_opt._validation import check_number
from ratt_opt.errors import InputError
from ratt_opt.problem import Problem
from ratt_opt.scenario.record import Record, Whole
from ratt_opt.setfunctions.criteria.registry import WITH_OUTPUT, get_criterion

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["Link", "ProblemRecord", "near_pairs"]


MOST_ROBOTS = 2000
"""Robots; their complete graph has two million links, whose sets take about half a gigabyte."""
MOST_ENTRIES = 2**25
"""Numbers in all information matrices together (256 MiB); the objective holds a few arrays of that size."""


def _ordered(link: tuple[int, int]) -> tuple[int, int]:
    if link[0] == link[1]:
        raise InputError("", "must join two different robots", list(link))
    return (min(link), max(link))


def near_pairs(places: FloatArray, reach: float) -> tuple[tuple[int, int], ...]:
    """Return the pairs ``(i, j)``, ``i < j``, of ``places`` (N, 2 or more) that are at most ``reach`` [m] apart."""
    apart = np.linalg.norm(places[:, None, :2] - places[None, :, :2], axis=-1)
    close = np.argwhere(np.triu(apart <= reach, 1))
    return tuple((int(i), int(j)) for i, j in close)


Link = Annotated[tuple[Whole, Whole], AfterValidator(_ordered)]
"""Two robots that can communicate; stored with the lower one first."""


class ProblemRecord(Record):
    """A record that becomes a max-min problem; a subclass declares the fields, in the order of its file."""

    if TYPE_CHECKING:
        alpha_s: int
        alpha_c: int
        links: tuple[tuple[int, int], ...] | None
        protected_robots: tuple[int, ...]
        protected_links: tuple[tuple[int, int], ...]

        @property
        def n_robots(self) -> int:
            """Number of robots N."""

        @property
        def n_targets(self) -> int:
            """Number of targets M."""

        @property
        def _owners(self) -> IntArray:
            """(E,) owner of each element."""

        @property
        def _matrices(self) -> tuple[FloatArray, FloatArray, FloatArray | None]:
            """Priors (M, d, d), information (E, M, d, d) and weights (M,) or ``None``."""

        @property
        def _places(self) -> FloatArray | None:
            """(N, 2 or more) where the robots are, x and y [m] first, or ``None``."""

    def __repr__(self) -> str:
        sizes = f"{self.n_robots} robots, {self.n_targets} targets"
        return f"{type(self).__name__}({sizes}, alpha_s={self.alpha_s}, alpha_c={self.alpha_c})"

    __str__ = __repr__

    @property
    def storable(self) -> ProblemRecord:
        """Return the record in a form that a file can hold; the record itself unless no file can name its parts."""
        return self

    @property
    def digest(self) -> str:
        """SHA-256 of what a file holds, as canonical JSON (sorted fields, shortest round-trip floats, UTF-8)."""
        document = self.storable.model_dump(mode="json")
        text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()

    @property
    def graph(self) -> nx.Graph | None:
        """The communication graph, or ``None`` for the complete one."""
        return None if self.links is None else self._graph_of(self.links)

    def problem(self, objective: str = "trace") -> Problem:
        """Return the max-min problem for one criterion: ``"trace"``, ``"logdet"``, ``"maxeig"``.

        Raises
        ------
        InputError : there is no criterion of that name, or none of a part of the state, or a matrix breaks its rule.
        """
        return Problem(
            self._criterion(objective),
            self._owners,
            self.graph,
            self.alpha_s,
            self.alpha_c,
            frozenset(self.protected_robots),
            frozenset(self.protected_links),
            self._at_most,
        )

    def _criterion(self, objective: str) -> InformationObjective:
        kind = get_criterion(objective)
        if self._output is None:
            return kind(*self._matrices)
        if objective not in WITH_OUTPUT:
            raise InputError("objective", f"must be {' or '.join(WITH_OUTPUT)}, as an output is given", objective)
        return WITH_OUTPUT[objective](*self._matrices, output=self._output)

    @property
    def _output(self) -> FloatArray | None:
        """(q, d) the part of the state that counts, or ``None`` for the whole."""
        return None

    @property
    def _at_most(self) -> int | None:
        """Robots that may choose another element than their idle one, or ``None`` for all."""
        return None

    def pairs_within(self, reach: float) -> tuple[tuple[int, int], ...]:
        """Pairs of robots ``(i, j)``, ``i < j``, at most ``reach`` [m] apart, ascending; linked or not.

        Raises
        ------
        InputError : ``reach`` is negative, or the input does not say where the robots are.
        """
        places = self._places
        if places is None:
            raise InputError("reach", "needs an input that says where the robots are (robot_positions)", "none")
        return near_pairs(places, check_number("reach", reach, low=0))

    def _graph_of(self, links: Iterable[tuple[int, int]]) -> nx.Graph:
        graph: nx.Graph = nx.Graph()
        graph.add_nodes_from(range(self.n_robots))
        graph.add_edges_from(links)
        return graph

    def _check_links(self) -> None:
        """Refuse links that name no robot or are repeated; a problem refuses the rest (budgets, protections)."""
        for k, link in enumerate(self.links or ()):
            if link[1] >= self.n_robots:
                raise InputError(f"links[{k}]", f"must join robots in [0, {self.n_robots - 1}]", list(link))
        lists: dict[str, Sequence[object]] = {
            "links": self.links or (),
            "protected_robots": self.protected_robots,
            "protected_links": self.protected_links,
        }
        for name, entries in lists.items():
            known: set[object] = set()
            for k, entry in enumerate(entries):
                if entry in known:
                    raise InputError(f"{name}[{k}]", "must not be repeated", entry)
                known.add(entry)

    def _check_sizes(self, n_elements: int, dimension: int) -> None:
        """Refuse what would not fit in memory, before anything is made of it."""
        if self.n_robots > MOST_ROBOTS:
            raise InputError("robots", f"must be at most {MOST_ROBOTS}", self.n_robots)
        entries = n_elements * self.n_targets * dimension**2
        if entries > MOST_ENTRIES:
            rule = f"must have at most {MOST_ENTRIES} entries in all information matrices"
            raise InputError("team", rule, f"{n_elements} elements, {self.n_targets} targets")
