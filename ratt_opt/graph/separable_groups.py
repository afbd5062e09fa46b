"""Every group that an attack may leave on a sparse graph, and partitions into such groups, in compiled code.

A connected set of robots can only be split off when its links to all others are within the budget and none is
protected. On sparse graphs such *separable* groups are few (thousands for thirty robots with six links each),
so every attack is a choice of disjoint ones that cover the team. Imported only if needed: compiling takes
seconds, once per machine (cached).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.budget import Budget
from ratt_opt.graph.communication import neighbour_masks
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.graph.communication import CommunicationGraph, Link
    from ratt_opt.graph.threat import Threat

__all__ = ["IMPOSSIBLE", "LARGEST_MASK", "PartitionSearch", "SeparableGroups", "separable_groups"]

LARGEST_MASK = 60
"""Most robots: a group is a bit mask of 64."""
IMPOSSIBLE = 10_000
"""Blinded robots that no budget holds."""


@dataclass(frozen=True, slots=True)
class SeparableGroups:
    """All separable groups of a threat.

    ``masks`` : (G,) groups by bit mask over *places*, sorted by lowest place; ``start`` : (N + 1,) first group of each
    lowest place; ``robots`` : (N,) robot at each place; ``neighbours`` : (N,) bit mask of each place's neighbours
    """

    threat: Threat
    masks: IntArray
    start: IntArray
    robots: IntArray
    neighbours: IntArray

    def members(self, group: int) -> IntArray:
        """Robots of one group, ascending."""
        mask = int(self.masks[group])
        return np.sort(self.robots[[p for p in range(len(self.robots)) if mask >> p & 1]])

    def by_robots(self) -> IntArray:
        """(G,) the groups by bit mask over robots instead of places."""
        return np.asarray(sum((self.masks >> place & 1) << int(i) for place, i in enumerate(self.robots)))

    def links(self) -> IntArray:
        """(G,) links that separate each from the other robots."""
        outside = [np.bitwise_count(near & ~self.masks).astype(np.int64) for near in self.neighbours]
        return np.asarray(sum((self.masks >> place & 1) * lost for place, lost in enumerate(outside)))


def separable_groups(threat: Threat, most: int, budget: Budget | None = None) -> SeparableGroups | None:
    """Tabulate the separable groups; ``None`` if there are more than ``most``, or more robots than a mask holds.

    ``None`` too if the ``budget`` is spent before; what was listed of the last few graphs is kept, and gone on with.

    The places are the robots in the order in which :class:`PartitionSearch` covers them: those in the most groups
    first, so that what is left afterwards are few small groups.
    """
    if threat.graph.n_robots > LARGEST_MASK:
        return None
    listing = _listing(threat.graph, threat.alpha_c, threat.protected_links)
    masks = listing.masks(min(most, LONGEST_LIST), budget or Budget())
    return None if masks is None else SeparableGroups(threat, *listing.placed(masks))


LONGEST_LIST = 1_000_000
"""Groups listed at most: eight megabytes."""
STEPS = 20_000
"""Nodes of the enumeration between two looks at the clock: some hundredths of a second."""


@lru_cache(maxsize=4)
def _listing(graph: CommunicationGraph, alpha_c: int, protected_links: frozenset[Link]) -> _Listing:
    return _Listing(graph, alpha_c, protected_links)


class _Listing:
    """The enumeration of one graph's separable groups, as far as it has come."""

    def __init__(self, graph: CommunicationGraph, alpha_c: int, protected_links: frozenset[Link]) -> None:
        self._n_robots, self._alpha_c = graph.n_robots, alpha_c
        self._neighbours = np.array(neighbour_masks(graph.n_robots, graph.links), dtype=np.int64)
        self._locked = np.array(neighbour_masks(graph.n_robots, protected_links), dtype=np.int64)
        self._found = np.zeros(LONGEST_LIST + 1, dtype=np.int64)
        self._stack = np.zeros((2 * graph.n_robots + 2, 3), dtype=np.int64)
        self._position = np.zeros(3, dtype=np.int64)
        self._placed: tuple[IntArray, IntArray, IntArray, IntArray] | None = None

    def masks(self, most: int, budget: Budget) -> IntArray | None:
        """All groups by bit mask over robots; ``None`` if they are more than ``most``, or the budget is spent."""
        is_done = False
        while not is_done and self._position[2] <= most and not budget.is_over:
            given = self._neighbours, self._locked, self._alpha_c
            is_done = _enumerate(given, self._found, self._stack, self._position, STEPS)
        count = int(self._position[2])
        return self._found[:count] if is_done and count <= most else None

    def placed(self, masks: IntArray) -> tuple[IntArray, IntArray, IntArray, IntArray]:
        """The fields of :class:`SeparableGroups` for all groups, read only."""
        if self._placed is None:
            self._placed = _placed(masks, self._neighbours)
            for one in self._placed:
                one.flags.writeable = False
        return self._placed


def _placed(masks: IntArray, neighbours: IntArray) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    n_robots = len(neighbours)
    bits = [masks >> i & 1 for i in range(n_robots)]
    robots = np.argsort([-int(bit.sum()) for bit in bits], kind="stable")
    place = np.argsort(robots).tolist()
    moved = np.bitwise_or.reduce([bits[i] << place[i] for i in range(n_robots)])
    near = np.array([sum(1 << int(place[j]) for j in range(n_robots) if neighbours[i] >> j & 1) for i in robots])
    lowest = np.bitwise_count((moved & -moved) - 1).astype(np.int64)
    order = np.lexsort((moved, lowest))
    start = np.searchsorted(lowest[order], np.arange(n_robots + 1))
    return moved[order], start, robots, near.astype(np.int64)


@numba.njit(cache=True)
def count_ones(mask: int) -> int:
    """Bits of a mask that are set."""
    ones = 0
    while mask:
        mask &= mask - 1
        ones += 1
    return ones


@numba.njit(cache=True)
def _enumerate(given: Any, found: Any, stack: Any, position: Any, steps: int) -> bool:
    """Go on with listing connected sets with at most that many outgoing links, none locked; whether these are all.

    Each set grows from its lowest robot; a robot next to it is taken in or left out, and what is left out
    already costs its links. It ends, for now, after ``steps``, or if ``found`` (G,) is full.

    ``given`` : (N,) neighbours and locked ones by bit mask, most links; ``stack`` : (2 N + 2, 3) robots inside,
    outside, links between them; ``position`` : robots begun with, depth of the stack, sets found
    """
    neighbours, locked, budget = given
    n_robots = len(neighbours)
    for _ in range(steps):
        if position[1] == 0:
            first = position[0]
            if first == n_robots:
                return True
            below = (1 << first) - 1
            stack[0, 0], stack[0, 1], stack[0, 2] = 1 << first, below, count_ones(neighbours[first] & below)
            position[0], position[1] = first + 1, 1 if locked[first] & below == 0 else 0
            continue
        top = position[1] - 1
        inside, outside, cost = stack[top, 0], stack[top, 1], stack[top, 2]
        if cost > budget:
            position[1] = top
            continue
        pick = _most_linked(neighbours, inside, outside)
        if pick < 0:
            if position[2] == len(found):
                return False
            found[position[2]] = inside
            position[2] += 1
        elif locked[pick] & inside == 0:
            stack[top, 0], stack[top, 1] = inside, outside | (1 << pick)
            stack[top, 2] = cost + count_ones(neighbours[pick] & inside)
            top += 1
        if pick >= 0 and locked[pick] & outside == 0:
            stack[top, 0], stack[top, 1] = inside | (1 << pick), outside
            stack[top, 2] = cost + count_ones(neighbours[pick] & outside)
            top += 1
        position[1] = top
    return False


@numba.njit(cache=True)
def _most_linked(neighbours: Any, inside: int, outside: int) -> int:
    """The robot next to ``inside``, in neither set, with the most links to both; -1 if there is none."""
    pick, most_links = -1, -1
    for i in range(len(neighbours)):
        links = count_ones(neighbours[i] & inside)
        if (inside | outside) >> i & 1 or links == 0:
            continue
        links += count_ones(neighbours[i] & outside)
        if links > most_links:
            pick, most_links = i, links
    return pick


@numba.njit(cache=True)
def _links_between(group: int, others: int, neighbours: Any) -> int:
    links = 0
    while group:
        lowest = group & -group
        links += count_ones(neighbours[count_ones(lowest - 1)] & others)
        group ^= lowest
    return links


@numba.njit(cache=True)
def _still_within(need: Any, budget: int, state: Any, depth: int) -> int:
    """Depth up to which the groups chosen, which may need more than they did, are within the budget."""
    for d in range(depth):
        state[d + 1, 2] = state[d, 2] + need[state[d, 4]]
        if state[d + 1, 2] > budget:
            return d
    return depth


@numba.njit(cache=True)
def _search(groups: Any, need: Any, budgets: Any, limit: int, state: Any, counters: Any) -> bool:  # noqa: PLR0917
    """Continue to the next partition within both budgets; false at the limit, or at depth -1: at the end.

    ``groups`` : masks, start, neighbours of :class:`SeparableGroups`; ``need`` (G,) may have risen since the last call;
    ``budgets`` : blinded robots, cut links;
    ``state`` : (N + 1, 5) robots left, links cut, robots blinded, next position, group chosen, at each depth;
    ``counters`` : depth, nodes
    """
    masks, start, neighbours = groups
    depth = _still_within(need, budgets[0], state, counters[0])
    while depth >= 0:
        left = state[depth, 0]
        lowest = count_ones((left & -left) - 1)
        position, end = max(state[depth, 3], start[lowest]), start[lowest + 1]
        chosen, others, links = -1, 0, 0
        while position < end:
            group = position
            position += 1
            mask = masks[group]
            if mask & ~left or state[depth, 2] + need[group] > budgets[0]:
                continue
            if counters[1] >= limit:
                state[depth, 3], counters[0] = group, depth
                return False
            counters[1] += 1
            others = left & ~mask
            links = state[depth, 1] + _links_between(mask, others, neighbours)
            if links <= budgets[1]:
                chosen = group
                break
        state[depth, 3] = position
        if chosen < 0:
            depth -= 1
            continue
        state[depth, 4] = chosen
        state[depth + 1, 0], state[depth + 1, 1] = others, links
        state[depth + 1, 2], state[depth + 1, 3] = state[depth, 2] + need[chosen], -1
        if others == 0:
            counters[0] = depth
            state[depth + 1, 0] = 0
            return True
        depth += 1
    counters[0] = -1
    return False


class PartitionSearch:
    """All partitions of the team into separable groups within both budgets, one after the other; resumable.

    ``need`` : (G,) robots to blind in each group, at least; may be raised between calls, never lowered
    """

    def __init__(self, groups: SeparableGroups, need: IntArray) -> None:
        self._groups, self.need = groups, need
        n_robots = len(groups.robots)
        self._state = np.zeros((n_robots + 1, 5), dtype=np.int64)
        self._state[0] = (1 << n_robots) - 1, 0, 0, -1, -1
        self._counters = np.zeros(2, dtype=np.int64)
        self._budgets = np.array([groups.threat.n_blinded, groups.threat.alpha_c])
        self.finished = False

    @property
    def nodes(self) -> int:
        """Groups tried."""
        return int(self._counters[1])

    def next_within(self, nodes: int, budget: Budget) -> list[int] | None:
        """Spend up to ``nodes`` more of the budget on :meth:`next`; raises ``OutOfBudget`` if none is left."""
        before = self.nodes
        chosen = self.next(before + budget.nodes_left(nodes))
        budget.nodes += self.nodes - before
        return chosen

    def next(self, limit: int) -> list[int] | None:
        """Groups of the next partition; ``None`` once ``finished`` or at ``limit`` nodes in all."""
        groups = self._groups.masks, self._groups.start, self._groups.neighbours
        if _search(groups, self.need, self._budgets, limit, self._state, self._counters):
            return [int(group) for group in self._state[: int(self._counters[0]) + 1, 4]]
        self.finished = bool(self._counters[0] < 0)
        return None
