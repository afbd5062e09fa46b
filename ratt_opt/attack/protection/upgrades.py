"""Effect on the adversary of links that are protected, or added."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import networkx as nx

from ratt_opt._validation import check_distinct, check_link
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Problem

__all__ = ["Addition", "Protection", "Upgrade", "checked_links"]


class Upgrade(Protocol):
    """A kind of change: which links may be chosen, and which of them block an attack."""

    problem: Problem
    candidates: tuple[Link, ...]

    def changed(self, links: Iterable[Link]) -> Problem:
        """The problem of the team that has these candidates."""

    def together(self) -> Sequence[frozenset[int]]:
        """The groups of the team that has all candidates, before any attack."""

    def needed(self, groups: Sequence[frozenset[int]]) -> int:
        """Count the chosen links needed to block the attack that separates these groups."""


class Protection:
    """Links that cannot be cut: one of them between two groups of an attack blocks it.

    Raises ``InputError`` : a candidate is no link.
    """

    def __init__(self, problem: Problem, candidates: Iterable[Link] | None) -> None:
        links = problem.communication.links
        given = links if candidates is None else checked_links(candidates)
        for link in sorted(given - links):
            raise InputError("candidates", "must be links of the graph", link)
        self.problem, self.candidates = problem, tuple(sorted(given - problem.protected_links))

    def changed(self, links: Iterable[Link]) -> Problem:
        """The problem in which these links cannot be cut."""
        return replace(self.problem, protected_links=self.problem.protected_links | set(links))

    def together(self) -> Sequence[frozenset[int]]:
        """Return the connected groups of the team as it is."""
        return self.problem.communication.groups()

    def needed(self, groups: Sequence[frozenset[int]]) -> int:  # noqa: ARG002  (the same for every attack)
        """One, whatever the groups."""
        return 1


class Addition:
    """New links, which the adversary may cut like others: what its budget does not cover blocks the attack.

    Raises ``InputError`` : a candidate is a link already, or its ends are not two robots.
    """

    def __init__(self, problem: Problem, candidates: Iterable[Link] | None) -> None:
        n_robots, links = problem.n_robots, problem.communication.links
        missing = [(i, j) for i in range(n_robots) for j in range(i + 1, n_robots) if (i, j) not in links]
        given = missing if candidates is None else sorted(checked_links(candidates))
        for link in () if given is missing else sorted(set(given).difference(missing)):
            raise InputError("candidates", "must be pairs of robots without a link", link)
        self.problem, self.candidates = problem, tuple(given)

    def changed(self, links: Iterable[Link]) -> Problem:
        """The problem with these links."""
        graph: nx.Graph = nx.Graph()
        graph.add_nodes_from(range(self.problem.n_robots))
        graph.add_edges_from(self.problem.communication.links)
        graph.add_edges_from(links)
        return replace(self.problem, graph=graph)

    def together(self) -> Sequence[frozenset[int]]:
        """Return the connected groups of the team with all candidates added."""
        links = self.problem.communication.links.union(self.candidates)
        return CommunicationGraph(self.problem.n_robots, links).groups()

    def needed(self, groups: Sequence[frozenset[int]]) -> int:
        """Return one more than the links left to the adversary after those of the graph that it has to cut."""
        return self.problem.alpha_c - len(self.problem.communication.links_between(groups)) + 1


def checked_links(given: Iterable[Link]) -> frozenset[Link]:
    """Pairs of robots as ``(i, j)``, ``i < j``.

    Raises ``InputError`` : one is no pair, or given twice.
    """
    pairs = (check_link("candidates", link) for link in given)
    return check_distinct("candidates", ((min(i, j), max(i, j)) for i, j in pairs))
