"""Open nodes of a branch and bound that may be stopped at any moment and goes on later.

A node is in hand from ``take`` to ``done``. If a limit or an interrupt ends the search in between, it is still in hand:
it counts for the bound, and the next ``take`` returns it again. Children that were kept before are divided twice then,
which costs time and proves the same. ``branch_and_bound.py`` is the loop over them.
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from itertools import chain
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

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

    ``most`` : nodes that are taken by their bounds (memory); once there are as many, new ones are taken in depth, the
    last one first. With 0 all are.
    """

    def __init__(self, nodes: Iterable[N], most: float = float("inf")) -> None:
        self._heap = list(nodes)
        heapify(self._heap)
        self._deep: list[N] = []
        self._hand: list[N] = []
        self._most = most

    def __len__(self) -> int:
        return len(self._heap) + len(self._deep) + len(self._hand)

    def __iter__(self) -> Iterator[N]:
        return chain(self._hand, self._deep, self._heap)

    @property
    def bound(self) -> Any:
        """Least bound of all nodes, the one in hand included; infinite if there is none."""
        return min((node.bound for node in chain(self._hand, self._deep, self._heap[:1])), default=float("inf"))

    @property
    def in_hand(self) -> N | None:
        """The node that was taken and is not done, if any."""
        return self._hand[0] if self._hand else None

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

    def prune(self, is_closed: Callable[[N], bool]) -> None:
        """Drop the node of the least bound, and the last one in depth, as long as they are closed."""
        while self._deep and is_closed(self._deep[-1]):
            self._deep.pop()
        while self._heap and is_closed(self._heap[0]):
            heappop(self._heap)

    def clear(self) -> None:
        """Drop every node: all are closed."""
        self._heap.clear()
        self._deep.clear()
        self._hand.clear()
