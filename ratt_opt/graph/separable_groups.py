"""Every group that an attack may leave on a sparse graph, and partitions into such groups.

A connected set of robots can only be split off when its links to all others are within the budget and none is
protected. On sparse graphs such *separable* groups are few (thousands for thirty robots with six links each),
so every attack is a choice of disjoint ones that cover the team.
"""

from __future__ import annotations

from ctypes import POINTER, Structure, byref, c_int, c_int64, c_void_p
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt.budget import Budget
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import neighbour_masks
from ratt_opt.graph.group_list import groups_of
from ratt_opt.native.library import address, checked, function

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.graph.communication import CommunicationGraph
    from ratt_opt.graph.group_list import GroupList
    from ratt_opt.graph.threat import Threat

__all__ = ["LARGEST_MASK", "PartitionSearch", "SeparableGroups", "separable_groups"]

LARGEST_MASK = 60
"""Most robots: a group is a bit mask of 64."""


@dataclass(frozen=True, slots=True)
class SeparableGroups:
    """Separable groups of a threat, at first all.

    ``masks`` : (G,) groups by bit mask over *places*, sorted by lowest place; ``links`` : (G,) that separate each from
    the other robots; ``start`` : (N + 1,) first group of each lowest place; ``robots`` : (N,) robot at each place;
    ``neighbours`` : (N,) bit mask of each place's neighbours
    """

    threat: Threat
    masks: IntArray
    links: IntArray
    start: IntArray
    robots: IntArray
    neighbours: IntArray

    def members(self, group: int) -> IntArray:
        """Robots of one group, ascending."""
        mask = int(self.masks[group])
        return np.sort(self.robots[[p for p in range(len(self.robots)) if mask >> p & 1]])

    def among(self, kept: BoolArray) -> SeparableGroups:
        """Some of them, ``kept`` (G,)."""
        before = np.concatenate([[0], np.cumsum(kept)])
        return replace(self, masks=self.masks[kept], links=self.links[kept], start=before[self.start])


def separable_groups(threat: Threat, most: int, budget: Budget | None = None) -> SeparableGroups | None:
    """Tabulate the separable groups; ``None`` if there are more than ``most``, or more robots than a mask holds.

    ``None`` too if the ``budget`` is spent before; what was listed of the last few graphs is kept, and gone on with.

    The places are the robots in the order in which :class:`PartitionSearch` covers them: those in the most groups
    first, so that what is left afterwards are few small groups.
    """
    if threat.graph.n_robots > LARGEST_MASK:
        return None
    groups = groups_of(threat)
    if not groups.has_listed(min(most, LONGEST_LIST), budget or Budget()):
        return None
    return SeparableGroups(threat, *_placed(threat.graph, groups))


LONGEST_LIST = 1_000_000
"""Groups listed at most: sixteen megabytes."""


@lru_cache(maxsize=2)
def _placed(graph: CommunicationGraph, groups: GroupList) -> tuple[IntArray, ...]:
    """The fields of :class:`SeparableGroups` for all groups, read only."""
    masks, links = (array.astype(np.int64) for array in groups.so_far())
    n_robots, neighbours = graph.n_robots, neighbour_masks(graph.n_robots, graph.links)
    robots = np.argsort([-int((masks >> i & 1).sum()) for i in range(n_robots)], kind="stable")
    place = np.argsort(robots).tolist()
    moved = np.zeros_like(masks)
    for i in range(n_robots):
        moved |= (masks >> i & 1) << place[i]
    near = [sum(1 << place[j] for j in range(n_robots) if neighbours[i] >> j & 1) for i in robots.tolist()]
    lowest = np.bitwise_count((moved & -moved) - 1).astype(np.int64)
    order = np.lexsort((moved, lowest))
    start = np.searchsorted(lowest[order], np.arange(n_robots + 1))
    placed = moved[order], links[order], start, robots, np.array(near, dtype=np.int64)
    for one in placed:
        one.flags.writeable = False
    return placed


LEVEL = np.dtype([("left", np.uint64), *((name, np.int64) for name in ("cut", "next", "group"))])
"""``PartitionLevel`` of ``native/src/records.h``."""
FOUND, NONE = 1, 0
GROUPS_AT_ONCE = 1_000_000
"""Groups looked at by one call of the search, most of which do not fit: some milliseconds."""


class PartitionsRecord(Structure):
    """``Partitions`` of ``native/src/records.h``."""

    _fields_: ClassVar = [
        ("most_cut", c_int64),
        *((name, c_void_p) for name in ("groups", "starts", "neighbours", "levels")),
        *((name, c_int64) for name in ("depth", "nodes")),
    ]


class PartitionSearch:
    """All partitions of the team into separable groups within the budget of links, one after the other; resumable.

    Raises ``InputError`` : an array has another type or shape.
    """

    def __init__(self, groups: SeparableGroups) -> None:
        count, n_robots = len(groups.masks), len(groups.robots)
        self._levels = np.zeros(n_robots + 1, LEVEL)
        self._levels[0] = (1 << n_robots) - 1, 0, 0, -1
        shapes = {"masks": count, "start": n_robots + 1, "neighbours": n_robots}
        arrays = [checked(name, getattr(groups, name), np.int64, (size,)) for name, size in shapes.items()]
        if groups.start[-1] != count:
            raise InputError("masks", f"must be the {groups.start[-1]} groups that have a place", count)
        self._kept = arrays
        self._record = PartitionsRecord(groups.threat.alpha_c, *map(address, arrays), address(self._levels), 0, 0)
        self.finished = False

    @property
    def nodes(self) -> int:
        """Groups tried."""
        return int(self._record.nodes)

    def next_within(self, nodes: int, budget: Budget) -> list[int] | None:
        """Spend up to ``nodes`` more of the budget on :meth:`next`; raises ``OutOfBudget`` if none is left."""
        before = self.nodes
        chosen = self.next(budget.nodes_left(nodes))
        budget.nodes += self.nodes - before
        return chosen

    def next(self, nodes: int) -> list[int] | None:
        """Groups of the next partition; ``None`` once ``finished``, or after ``nodes`` nodes or some milliseconds."""
        call = function("next_partition_into_groups", c_int, POINTER(PartitionsRecord), *[c_int64] * 2)
        code = call(byref(self._record), nodes, GROUPS_AT_ONCE)
        if code == FOUND:
            return [int(group) for group in self._levels["group"][: self._record.depth + 1]]
        self.finished = code == NONE
        return None
