"""Branch and bound: the one loop, and the calls that a search answers.

A search divides its solutions into nodes. It says when to stop, bounds a node, and branches; solutions that a bound
suggests are offered where they are found, while the node is bounded. Nodes are those of least bound first
(``open_nodes.py``); a search for a largest value negates its bounds.

Whatever ends the loop, no node is lost and the bounds hold: ``stop`` may say so between two nodes, and ``bound`` and
``branch`` may raise (``OutOfBudget``, an interrupt) within one. The next run goes on with the node that was in hand.

Source: branch and bound (Land and Doig 1960); the division into calls is that of Bonobo.jl (Kröger and others 2022).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ratt_opt.budget import Stop
    from ratt_opt.search.open_nodes import OpenNode, OpenNodes

__all__ = ["NodeSearch", "divide_next", "divide_nodes"]

N = TypeVar("N", bound="OpenNode")
B = TypeVar("B")


class NodeSearch(Protocol[N, B]):
    """Calls of the loop; ``B`` is what a search knows of a node once it is bounded."""

    def stop(self) -> Stop | None:
        """Return why to stop before the next node, if anything: the bracket is closed, or the budget is spent."""

    def bound(self, node: N, /) -> B | None:
        """Bound the node in hand and offer solutions; ``None`` if no solution of it is of interest."""

    def branch(self, bounded: B, /) -> Iterable[N]:
        """Return the children of a node that stays open; none if it is a single solution."""


def divide_nodes(
    nodes: OpenNodes[N], search: NodeSearch[N, Any], trace: Callable[[], object] | None = None
) -> Stop | None:
    """Bound and divide nodes until the search stops or none is left; return why it stopped, ``None`` for the latter.

    ``trace`` : called after each node
    """
    while True:
        if (stop := search.stop()) is not None:
            return stop
        if not nodes:
            return None
        divide_next(nodes, search)
        if trace is not None:
            trace()


def divide_next(nodes: OpenNodes[N], search: NodeSearch[N, Any]) -> None:
    """Bound and divide the next node, for searches that take turns with others."""
    bounded = search.bound(nodes.take())
    if bounded is not None:
        nodes.keep(search.branch(bounded))
    nodes.done()
