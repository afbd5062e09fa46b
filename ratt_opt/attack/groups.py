"""The groups of robots that an attack may leave: connected, and cut off by no more links than the budget has."""

from __future__ import annotations

from ctypes import c_int, c_int64, c_void_p
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import MOST_ROBOTS
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import neighbour_masks
from ratt_opt.native.library import address, function

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import CommunicationGraph, Link
    from ratt_opt.graph.threat import Threat

__all__ = ["GroupList", "groups_of"]

AT_ONCE = 1 << 16
"""Groups that are listed between two looks at the clock: some milliseconds."""
BRANCH = np.dtype([("inside", np.uint32), ("outside", np.uint32), ("cut", np.int32)])


class GroupList:
    """The groups of one graph and link budget, listed as far as has been asked.

    ``neighbours``, ``protected`` : (N,) bit masks of each robot's neighbours, and of those whose link cannot be cut
    """

    def __init__(self, graph: CommunicationGraph, most_cut: int, protected_links: frozenset[Link]) -> None:
        if graph.n_robots > MOST_ROBOTS:
            raise InputError("graph", f"must have at most {MOST_ROBOTS} robots to list its groups", graph.n_robots)
        self.robots, self._most_cut = graph.n_robots, most_cut
        self.neighbours = np.array(neighbour_masks(graph.n_robots, graph.links), dtype=np.uint32)
        self.protected = np.array(neighbour_masks(graph.n_robots, protected_links), dtype=np.uint32)
        self._stack, self._position = np.zeros(2 * graph.n_robots + 2, BRANCH), np.zeros(2, np.int64)
        self._parts: list[tuple[NDArray[np.uint32], NDArray[np.uint8]]] = []

    def all(self, budget: Budget) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]:
        """Bit masks (G,) and links that leave each (G,).

        Raises
        ------
        OutOfBudget : the time is up, or the user interrupted; what is listed is gone on with.
        """
        call = function(
            "list_groups", c_int64, c_int, *[c_void_p] * 2, c_int, *[c_void_p] * 2, *[c_int64] * 2, *[c_void_p] * 2
        )
        given = address(self.neighbours), address(self.protected), self._most_cut
        while self._position[0] < self.robots or self._position[1] > 0:
            budget.check()
            groups, cuts = np.empty(AT_ONCE, np.uint32), np.empty(AT_ONCE, np.uint8)
            state = address(self._stack), address(self._position)
            count = call(self.robots, *given, *state, 4 * AT_ONCE, AT_ONCE, address(groups), address(cuts))
            self._parts.append((groups[:count].copy(), cuts[:count].copy()))
        if len(self._parts) != 1:
            masks, links = ([part[k] for part in self._parts] for k in range(2))
            whole = np.concatenate([np.empty(0, np.uint32), *masks]), np.concatenate([np.empty(0, np.uint8), *links])
            self._parts = [whole]
        return self._parts[0]


def groups_of(threat: Threat) -> GroupList:
    """The list of a threat's groups; the last few graphs' are kept."""
    return _kept(threat.graph, threat.alpha_c, threat.protected_links)


@lru_cache(maxsize=2)
def _kept(graph: CommunicationGraph, most_cut: int, protected_links: frozenset[Link]) -> GroupList:
    return GroupList(graph, most_cut, protected_links)
