"""Open nodes of a branch and bound that may be stopped at any moment and goes on later.

A search is four calls of its own (bound a node, branch, try a solution, say which bound closes all) and this loop::

    while nodes and nodes.bound < goal:
        node = nodes.take()
        ...  # bound the node, offer what it suggests
        nodes.keep(children)
        nodes.done()

A node is in hand from ``take`` to ``done``. If a limit or an interrupt ends the search in between, it is still in hand:
it counts for the bound, and the next ``take`` returns it again. Children that were kept before are divided twice then,
which costs time and proves the same.
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["OpenNodes"]


class OpenNode(Protocol):
    """A part of the solutions: ``bound`` holds for all of them, and nodes are ordered by it, the least first."""

    @property
    def bound(self) -> Any:
        """No solution of the node has a smaller value."""

    def __lt__(self, other: Any, /) -> bool: ...


N = TypeVar("N", bound=OpenNode)


class OpenNodes(Generic[N]):
    """Nodes that are left, the least bound first.

    ``most`` : nodes kept by their bounds (memory); once there are as many, new ones are searched in depth, last in
    first out, and those bound nothing: what they come from does
    """

    def __init__(self, nodes: Iterable[N], most: float = float("inf")) -> None:
        self._heap = list(nodes)
        heapify(self._heap)
        self._deep: list[N] = []
        self._hand: list[N] = []
        self._most = most

    def __len__(self) -> int:
        return len(self._heap) + len(self._deep) + len(self._hand)

    @property
    def is_in_depth(self) -> bool:
        """Tell whether some nodes are not kept by their bounds: :attr:`bound` says nothing about these."""
        return bool(self._deep)

    @property
    def bound(self) -> Any:
        """Least bound of the nodes kept by their bounds, the one in hand included; infinite if there is none."""
        return min((node.bound for node in (*self._hand, *self._heap[:1])), default=float("inf"))

    def take(self) -> N:
        """The node in hand; else the last one in depth; else the one of the least bound."""
        if not self._hand:
            # In hand before it is nowhere else: an interrupt in between loses nothing.
            if self._deep:
                self._hand.append(self._deep[-1])
                self._deep.pop()
            else:
                self._hand.append(self._heap[0])
                heappop(self._heap)
        return self._hand[0]

    def raise_bound(self, node: N) -> None:
        """Replace the node in hand by a node of the same solutions with a larger bound."""
        self._hand[:] = [node]

    def keep(self, children: Iterable[N]) -> None:
        """Keep children of the node in hand."""
        is_full = bool(self._deep) or len(self._heap) >= self._most
        for child in children:
            if is_full:
                self._deep.append(child)
            else:
                heappush(self._heap, child)

    def done(self) -> None:
        """Drop the node in hand: it is closed, or its children are kept."""
        self._hand.clear()

    def clear(self) -> None:
        """Drop every node: all are closed."""
        self._heap.clear()
        self._deep.clear()
        self._hand.clear()
