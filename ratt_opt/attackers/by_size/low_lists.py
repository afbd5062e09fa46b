"""All sets of one size whose value is below a threshold, as bit masks.

A depth-first search over the robots in the order given. With ``q`` robots still to choose, the information of a set is
the average, over the robots ``i`` chosen, of what ``q`` copies of ``i`` would give; the value is concave in the
information, so it is at least the average ``(1/q) sum_i value(q copies of i)``. With the next robot fixed the others
contribute at least the smallest of the rest.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import team_criterion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget

    MaskArray = NDArray[np.uint64]

__all__ = ["MOST_ROBOTS", "Filter", "LowList", "list_low_sets", "spend_look"]

MOST_ROBOTS = 63
"""A set is one 64-bit mask."""
WORK = 10_000_000
"""Criteria of single targets between two looks at the clock: a tenth of a second or less."""
QUICK = 4_000_000
"""The same for a list that is wanted only if it is short."""
NODES_OF_A_LOOK = 10_000
"""Nodes that the work between two looks counts as: about as many partial sets are looked at."""
LONGEST = 200
"""Looks at the clock before a list is given up, ten seconds or so: what is that long to list is longer to search."""
MOST_SETS = 2_000_000
"""Sets listed at most: 32 MiB, and about a second for each bound that goes through them."""


@dataclass(frozen=True, slots=True)
class LowList:
    """``masks`` (K,) of the sets of ``size`` robots found, and their ``values`` (K,), lowest first."""

    size: int
    masks: MaskArray
    values: FloatArray

    def where(self, kept: BoolArray) -> LowList:
        """Those that are kept (K,)."""
        return LowList(self.size, self.masks[kept], self.values[kept])

    def below(self, threshold: float) -> LowList:
        """Those worth less than a threshold."""
        count = int(np.searchsorted(self.values, threshold))
        return LowList(self.size, self.masks[:count], self.values[:count])


@dataclass(frozen=True, slots=True)
class Filter:
    """Only sets worth less than ``threshold`` whose robots' ``costs`` (F,) add up to less than ``room`` are listed."""

    threshold: float
    costs: FloatArray
    room: float = np.inf

    @classmethod
    def below(cls, threshold: float, n_robots: int) -> Filter:
        """No costs."""
        return cls(threshold, np.zeros(n_robots))


def list_low_sets(
    team: PackedTeam, order: IntArray, size: int, wanted: Filter, budget: Budget, *, quick: bool = False
) -> LowList | None:
    """Every set of ``size`` robots that is wanted, or ``None`` where they are too many or too long to find.

    Parameters
    ----------
    order : (F,) robots to choose from, F <= 63; bit ``k`` of a mask is ``order[k]``; strongest first is best, as
        the search goes from the last to the first
    quick : give up before the first look at the clock, after a few milliseconds

    Raises
    ------
    OutOfBudget : the time is up, or too few nodes are left for the next look at the clock.
    """
    information = np.ascontiguousarray(team.information[order[::-1]])
    n_robots = len(information)
    sums = np.zeros((size + 1, *team.prior.shape))
    sums[0] = team.prior
    counters = np.zeros(2, dtype=np.int64)
    state = np.zeros(size + 1, dtype=np.int64), sums, np.zeros((2, size + 1, n_robots + 1)), counters
    data = (team.code, team.weights, team.baseline), information, np.ascontiguousarray(wanted.costs[::-1])
    limits = wanted.threshold, wanted.room, QUICK if quick else WORK
    masks, values = np.zeros(4096, dtype=np.uint64), np.zeros(4096)
    for _ in range(1 if quick else LONGEST):
        spend_look(budget)
        if _collect(data, limits, state, (masks, values)):
            ranked = np.argsort(values[: counters[1]], kind="stable")
            return LowList(size, masks[ranked], values[ranked])
        if counters[1] > MOST_SETS:
            return None
        if counters[1] + n_robots >= len(masks):
            masks = np.concatenate([masks, np.zeros_like(masks)])
            values = np.concatenate([values, np.zeros_like(values)])
    return None


def spend_look(budget: Budget) -> None:
    """Count the nodes of the work until the next look at the clock.

    Raises
    ------
    OutOfBudget : the time is up, or so many nodes are not left.
    """
    if budget.nodes_left(NODES_OF_A_LOOK) < NODES_OF_A_LOOK:
        raise OutOfBudget(Stop.NODES)
    budget.spend(NODES_OF_A_LOOK)


@numba.njit(cache=True)
def _worths(criterion: Any, sums: Any, information: Any, places: Any, worths: Any) -> None:
    """``worths[i]`` is the value of ``sums`` and ``left`` copies of robot ``i``, for ``i >= first``."""
    (code, weights, baseline), (first, left) = criterion, places
    one = np.empty_like(sums)
    for i in range(first, len(information)):
        for j in range(len(one)):
            for t in range(one.shape[1]):
                one[j, t] = sums[j, t] + left * information[i, j, t]
        worths[i] = baseline - team_criterion(code, weights, one)


@numba.njit(cache=True)
def _smallest_after(worths: Any, first: int, count: int, smallest: Any) -> None:
    """``smallest[p]`` is the sum of the ``count`` smallest worths after position ``p``; infinite where too few."""
    n_robots = len(smallest) - 1
    kept = np.empty(count + 1)
    number, total = 0, 0.0
    smallest[n_robots] = 0.0
    for p in range(n_robots - 1, first - 1, -1):
        smallest[p] = total if number == count else np.inf
        if count == 0:
            smallest[p] = 0.0
            continue
        if number == count and worths[p] >= kept[number - 1]:
            continue
        k = number if number < count else count - 1
        if number == count:
            total -= kept[k]
        else:
            number += 1
        while k > 0 and kept[k - 1] > worths[p]:
            kept[k] = kept[k - 1]
            k -= 1
        kept[k] = worths[p]
        total += worths[p]


@numba.njit(cache=True)
def _record(data: Any, limits: Any, position: Any, found: Any, number: int) -> int:
    """Record the sets whose other robots stand before ``position``; return ``number`` plus how many there are."""
    (worths, costs), (threshold, room), (masks, values) = data, limits, found
    mask, n_robots = np.uint64(0), len(costs)
    for robot in position[:-1]:
        mask |= np.uint64(1) << np.uint64(n_robots - robot)
    for i in range(position[-1], n_robots):
        if worths[i] < threshold and costs[i] < room:
            masks[number] = mask | (np.uint64(1) << np.uint64(n_robots - 1 - i))
            values[number] = worths[i]
            number += 1
    return number


@numba.njit(cache=True)
def _collect(data: Any, limits: Any, state: Any, found: Any) -> bool:
    """Go on until every set is decided (true), the work is done or the arrays are full.

    data : criterion (code, weights (M,), baseline); information (F, M, T); costs (F,)
    limits : threshold, room, work
    state : position (size + 1,) next robot at each depth; sums (size + 1, M, T); worths and sums of the smallest (2,
        size + 1, F + 1); counters (2,): depth, sets found
    """
    criterion, information, costs = data
    threshold, room, work = limits
    position, sums, worth_arrays, counters = state
    n_robots, n_targets = information.shape[0], information.shape[1]
    size = len(position) - 1
    spent = np.zeros(size + 1)
    depth, done, fresh = counters[0], 0, True
    for d in range(depth):
        spent[d + 1] = spent[d] + costs[position[d] - 1]
    while depth >= 0:
        left, worths, smallest = size - depth, worth_arrays[0, depth], worth_arrays[1, depth]
        p = position[depth]
        if fresh:
            if done >= work or counters[1] + n_robots >= len(found[0]):
                counters[0] = depth
                return False
            done += (n_robots - p) * n_targets
            _worths(criterion, sums[depth], information, (p, left), worths)
            _smallest_after(worths, p, left - 1, smallest)
            fresh = False
        if left == 1:
            limits_left = threshold, room - spent[depth]
            counters[1] = _record((worths, costs), limits_left, position[: depth + 1], found, counters[1])
            depth -= 1
            continue
        while p <= n_robots - left and (worths[p] + smallest[p] >= left * threshold or spent[depth] + costs[p] >= room):
            p += 1
        if p > n_robots - left:
            depth -= 1
            continue
        position[depth] = p + 1
        spent[depth + 1] = spent[depth] + costs[p]
        for j in range(n_targets):
            for t in range(information.shape[2]):
                sums[depth + 1, j, t] = sums[depth, j, t] + information[p, j, t]
        depth += 1
        position[depth] = p + 1
        fresh = True
    counters[0] = depth
    return True
