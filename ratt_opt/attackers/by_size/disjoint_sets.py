"""Disjoint sets of given sizes from lists, all below a threshold: an exact search with potentials and memory.

Robots are decided one by one: each either lies in the next set, whose first robot it is, or in the *rest*: the robots
that are blinded or left alone. Every set has a cost, what it takes off the room between the threshold and a bound
on the whole (``cover_bound.py``); a choice that costs more than the room has no completion. What is left to do
depends only on which robots are decided and which sizes remain, so states that failed once are remembered.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attackers.by_size.low_lists import spend_look
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.by_size.low_lists import MaskArray
    from ratt_opt.budget import Budget

__all__ = ["Columns", "DisjointSets", "Rest"]

WORK = 4_000_000
"""Sets looked at between two looks at the clock: some hundredths of a second."""
MEMORY = 1 << 20
"""States remembered; later ones replace earlier ones."""
MOST_REMEMBERED = 10
"""Numbers of a state (sizes to come, and two of the rest) that fit into one key, six bits each."""
REST, NONE = -1, -2
"""A robot goes to the rest; nothing is left to do with it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Columns:
    """Sets of each size of a vector, by their lowest robot, cheapest first.

    ``masks``, ``values``, ``costs`` : (K,); ``starts`` : (C, N + 1), those of size ``c`` whose lowest bit is ``r`` are
    ``starts[c, r]:starts[c, r + 1]``; ``counts`` : (C,) sets to choose of each size; ``rest_costs`` : (N,) of leaving
    robot ``r`` in the rest; ``room`` : costs have to stay below this; ``taken`` : mask of robots that are in neither
    """

    masks: MaskArray
    values: FloatArray
    costs: FloatArray
    starts: IntArray
    counts: IntArray
    rest_costs: FloatArray
    room: float
    taken: int = 0


@dataclass(frozen=True, slots=True)
class Rest:
    """The robots outside the sets: ``size`` of them, ``n_blinded`` of these blinded, the others left alone.

    ``single`` : (N,) individual values by bit, largest first; ``must`` : mask of the robots that cannot be blinded
    """

    size: int
    n_blinded: int
    single: FloatArray
    must: int = 0

    def alone(self, rest: int) -> float:
        """Largest individual value in a rest (mask) whose strongest robots are blinded; -inf where none is left."""
        return float(_left_alone(np.uint64(rest), np.uint64(self.must), self.n_blinded, self.single))


class DisjointSets:
    """Finds the sets whose largest value is least; :meth:`run` goes on until all families are decided.

    Parameters
    ----------
    threshold : only families of a smaller largest value count
    """

    def __init__(self, columns: Columns, rest: Rest, threshold: float) -> None:
        depths, n_classes = len(rest.single) + 1, len(columns.counts)
        self._columns = columns
        arrays = columns.masks, columns.values, columns.costs, columns.starts, columns.rest_costs, rest.single
        self._data = arrays, np.array([rest.must, rest.size, rest.n_blinded], dtype=np.int64)
        counts, numbers = np.zeros((depths, n_classes + 2), dtype=np.int64), np.zeros((2, depths))
        places = np.zeros((3, depths), dtype=np.int64)
        counts[0] = [*columns.counts, rest.size, rest.size - rest.n_blinded]
        numbers[1, 0], places[0, 0] = -np.inf, -1
        self._counters = np.zeros(2, dtype=np.int64)
        decided = np.zeros((2, depths), dtype=np.uint64)
        decided[0, 0] = columns.taken
        self._state = decided, counts, numbers, places, self._counters
        self._memory = np.zeros((2, MEMORY), dtype=np.uint64)
        self._best = np.full(int(columns.counts.sum()) + 1, -1, dtype=np.int64)
        self.value = threshold
        """Least largest value found, or the threshold."""

    def family(self) -> list[int]:
        """Masks of the best family found; empty where none was."""
        return [int(self._columns.masks[k]) for k in self._best.tolist() if k >= 0]

    def run(self, budget: Budget, looks: float = np.inf) -> bool:
        """Search to the end (true), or until the clock was looked at so often.

        Raises
        ------
        OutOfBudget : the time is up, or too few nodes are left for the next look at the clock.
        """
        limits = np.array([self.value, self._columns.room])
        while looks > 0:
            spend_look(budget)
            finished = _search(self._data, limits, WORK, self._state, self._memory, self._best)
            self.value = float(limits[0])
            if finished:
                return True
            looks -= 1
        return False


@numba.njit(cache=True)
def _count(mask: Any) -> int:
    number = 0
    while mask:
        mask &= mask - np.uint64(1)
        number += 1
    return number


@numba.njit(cache=True)
def _left_alone(rest: Any, must: Any, n_blinded: int, single: Any) -> float:
    """Largest individual value in the rest once its strongest robots that may be are blinded; -inf if none is left."""
    for i in range(len(single)):
        bit = np.uint64(1) << np.uint64(i)
        if rest & bit:
            if n_blinded > 0 and not must & bit:
                n_blinded -= 1
            else:
                return float(single[i])
    return -np.inf


@numba.njit(cache=True)
def _slot(decided: Any, packed: Any, size: int) -> int:
    h = (decided * np.uint64(0x9E3779B97F4A7C15)) ^ (packed * np.uint64(0xC2B2AE3D27D4EB4F))
    h ^= h >> np.uint64(29)
    h *= np.uint64(0xBF58476D1CE4E5B9)
    h ^= h >> np.uint64(32)
    return int(h & np.uint64(size - 1))


@numba.njit(cache=True)
def _packed(counts: Any) -> Any:
    """The remaining sizes as one number (each at most 63; exact up to ten of them)."""
    packed = np.uint64(1)
    for c in range(len(counts)):
        packed = (packed << np.uint64(6)) | np.uint64(counts[c])
    return packed


@numba.njit(cache=True)
def _search(data: Any, limits: Any, work: int, state: Any, memory: Any, best: Any) -> bool:  # noqa: PLR0917
    """Go on until all is decided (true) or the work is done.

    limits : threshold, lowered by what is found, and room
    state : masks (2, D): decided, in the rest; counts (D, C + 2): sizes to come, places in the rest, robots that cannot
        be blinded that it may still hold; numbers (2, D): cost, largest value; places (3, D): option, next set, choice
    """
    decided, counts, numbers, _, counters = state
    remember = counts.shape[1] <= MOST_REMEMBERED
    depth, spent = counters[0], 0
    while depth >= 0:
        if spent >= work:
            counters[0] = depth
            return False
        chosen, looked = _next_option(data, limits, state, depth)
        spent += looked
        if chosen == NONE:
            # Where the sets so far are no longer below the threshold, the state itself has not failed.
            if remember and depth > 1 and numbers[1, depth] < limits[0]:
                packed = _packed(counts[depth])
                k = _slot(decided[0, depth], packed, memory.shape[1])
                memory[0, k], memory[1, k] = decided[0, depth], packed
            depth -= 1
            continue
        _choose(data, state, depth, chosen)
        if numbers[1, depth + 1] >= limits[0]:
            continue
        if counts[depth + 1, :-2].sum() == 0:
            _note(data, limits, state, depth, best)
            continue
        if remember:
            packed = _packed(counts[depth + 1])
            k = _slot(decided[0, depth + 1], packed, memory.shape[1])
            if memory[0, k] == decided[0, depth + 1] and memory[1, k] == packed:
                continue
        depth += 1
    counters[0] = depth
    return True


@numba.njit(cache=True)
def _first_undecided(decided: Any) -> int:
    r = 0
    while decided >> np.uint64(r) & np.uint64(1):
        r += 1
    return r


@numba.njit(cache=True)
def _next_option(data: Any, limits: Any, state: Any, depth: int) -> Any:
    """What to do next with the first undecided robot: a set, ``REST`` or ``NONE``; and how many sets were looked at."""
    (masks, values, costs, starts, rest_costs, _), budgets = data
    decided, counts, numbers, places, _ = state
    n_classes, cost, now = counts.shape[1] - 2, numbers[0, depth], decided[0, depth]
    r, looked = _first_undecided(now), 1
    if places[0, depth] == -1:
        places[0, depth], places[1, depth] = 0, starts[0, r]
        kept = np.int64(np.uint64(budgets[0]) >> np.uint64(r) & np.uint64(1))
        if counts[depth, -2] > 0 and counts[depth, -1] >= kept and cost + rest_costs[r] < limits[1]:
            return REST, looked
    while places[0, depth] < n_classes:
        c, e = places[0, depth], places[1, depth]
        if counts[depth, c] == 0 or e >= starts[c, r + 1] or cost + costs[e] >= limits[1]:
            places[0, depth] += 1
            if places[0, depth] < n_classes:
                places[1, depth] = starts[places[0, depth], r]
            continue
        places[1, depth] += 1
        looked += 1
        if not masks[e] & now and values[e] < limits[0]:
            return e, looked
    return NONE, looked


@numba.njit(cache=True)
def _choose(data: Any, state: Any, depth: int, chosen: int) -> None:
    """Fill in the next depth."""
    (masks, values, costs, _, rest_costs, _), budgets = data
    decided, counts, numbers, places, counters = state
    child, now = depth + 1, decided[0, depth]
    counts[child], places[2, depth], places[0, child] = counts[depth], chosen, -1
    numbers[:, child], decided[1, child] = numbers[:, depth], decided[1, depth]
    counters[1] += 1
    if chosen == REST:
        r = _first_undecided(now)
        bit = np.uint64(1) << np.uint64(r)
        decided[0, child], decided[1, child] = now | bit, decided[1, depth] | bit
        counts[child, -2] -= 1
        if np.uint64(budgets[0]) & bit:
            counts[child, -1] -= 1
        numbers[0, child] += rest_costs[r]
    else:
        decided[0, child] = now | masks[chosen]
        counts[child, places[0, depth]] -= 1
        numbers[0, child] += costs[chosen]
        numbers[1, child] = max(numbers[1, depth], values[chosen])


@numba.njit(cache=True)
def _note(data: Any, limits: Any, state: Any, depth: int, best: Any) -> None:
    """All sets are chosen: keep them where they are better."""
    (_, _, _, _, _, single), (must, n_rest, n_blinded) = data
    decided, _, numbers, places, _ = state
    everyone = (np.uint64(1) << np.uint64(len(single))) - np.uint64(1)
    rest = decided[1, depth + 1] | (everyone & ~decided[0, depth + 1])
    if _count(rest & np.uint64(must)) > n_rest - n_blinded:
        return
    value = max(numbers[1, depth + 1], _left_alone(rest, np.uint64(must), n_blinded, single))
    if value < limits[0]:
        limits[0] = value
        k = 0
        for d in range(depth + 1):
            if places[2, d] >= 0:
                best[k] = places[2, d]
                k += 1
        best[k:] = -1
