"""The groups of robots that an attack may leave: connected, and cut off by no more links than the budget has."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.graph.communication import neighbour_masks
from ratt_opt.native.library import address
from ratt_opt.native.loops import BranchRecord, loops

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import CommunicationGraph, Link
    from ratt_opt.graph.threat import Threat

__all__ = ["LARGEST_MASK", "MOST_CUT", "NARROW", "GroupList", "groups_of"]

MOST_CUT = int(np.iinfo(np.uint8).max)
"""Links that leave a group, up to which their number is a byte."""
LARGEST_MASK = 60
"""Most robots whose groups are listed as bit masks of 64."""
STEPS = 20_000
"""Steps between two looks at the clock, each of which lists one group at most: some milliseconds."""
NARROW = np.iinfo(np.uint32).bits
"""Robots up to which a group's bit mask has 32 bits."""


def groups_of(threat: Threat) -> GroupList:
    """The list of a threat's groups; the last few graphs' are kept."""
    return _kept(threat.graph, threat.alpha_c, threat.protected_links)


@lru_cache(maxsize=2)
def _kept(graph: CommunicationGraph, most_cut: int, protected_links: frozenset[Link]) -> GroupList:
    return GroupList(graph, most_cut, protected_links)


class GroupList:
    """The groups of one graph and link budget, listed as far as has been asked.

    ``robots`` : number of robots

    Bit masks are ``uint32`` up to ``NARROW`` robots, else ``int64``; numbers of links ``uint8`` up to ``MOST_CUT``.

    Raises ``InputError`` : the robots are too many for a mask.
    """

    def __init__(self, graph: CommunicationGraph, most_cut: int, protected_links: frozenset[Link]) -> None:
        most = int(np.iinfo(np.int64).max).bit_length()
        if graph.n_robots > most:
            raise InputError("graph", f"must have at most {most} robots to list its groups", graph.n_robots)
        self.robots, self._most_cut = graph.n_robots, most_cut
        largest_cut = min(most_cut, graph.n_robots**2 // 4)
        self._types = (
            np.dtype(np.uint32 if graph.n_robots <= NARROW else np.int64),
            np.dtype(np.uint8 if largest_cut <= MOST_CUT else np.int64),
        )
        self._neighbours = np.array(neighbour_masks(graph.n_robots, graph.links), dtype=np.uint64)
        self._protected = np.array(neighbour_masks(graph.n_robots, protected_links), dtype=np.uint64)
        self._stack, self._position = np.zeros(2 * graph.n_robots + 2, BranchRecord), np.zeros(2, np.int64)
        self._parts: list[tuple[NDArray[Any], NDArray[Any]]] = []
        self._count = 0

    def __len__(self) -> int:
        """Groups so far."""
        return self._count

    @property
    def is_complete(self) -> bool:
        """Tell whether the list holds every group."""
        return bool(self._position[0] == self.robots and self._position[1] == 0)

    def go_on(self) -> None:
        """List some more."""
        groups, cuts = np.empty(STEPS, np.uint64), np.empty(STEPS, np.uint16)
        links = address(self._neighbours), address(self._protected)
        state, places = (address(self._stack), address(self._position)), (address(groups), address(cuts))
        found = loops.list_groups(self.robots, *links, self._most_cut, *state, STEPS, STEPS, *places)
        self._parts.append((groups[:found].astype(self._types[0]), cuts[:found].astype(self._types[1])))
        self._count += found

    def has_listed(self, most: int, budget: Budget) -> bool:
        """List on, until all are listed, they are more than ``most``, or the budget is spent; whether all are."""
        while not self.is_complete and len(self) <= most and not budget.is_over:
            self.go_on()
        return self.is_complete and len(self) <= most

    def all(self, budget: Budget) -> tuple[NDArray[Any], NDArray[Any]]:
        """Bit masks (G,) of all groups, and links that leave each (G,).

        Raises
        ------
        OutOfBudget : the time is up, or the user interrupted; what is listed is gone on with.
        """
        while not self.is_complete:
            budget.check()
            self.go_on()
        return self.so_far()

    def so_far(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """Bit masks (G,) of the groups so far, and links that leave each (G,)."""
        if len(self._parts) != 1:
            empty = tuple(np.empty(0, kind) for kind in self._types)
            masks, links = (np.concatenate([empty[k], *(part[k] for part in self._parts)]) for k in range(2))
            self._parts = [(masks, links)]
        return self._parts[0]
