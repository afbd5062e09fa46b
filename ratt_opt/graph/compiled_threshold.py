"""The threshold test of ``threshold.py`` for up to 20 robots, in compiled code.

A set of robots can only be split off when the links to all others are within the budget, so both the
groups and what is left beside them are among these *separable* sets; on most graphs they are few.
Imported only for such teams: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.budget import Budget
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import neighbour_masks
from ratt_opt.graph.separable_groups import count_ones
from ratt_opt.graph.threshold import LARGEST_COMPILED, UNREACHABLE, GroupSplit, fewest_blinded, largest_survivors
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import FloatArray
    from ratt_opt.graph.threat import Threat

__all__ = ["CompiledThresholdTest"]

FAR = int(UNREACHABLE)
AT_ONCE = 20_000_000
"""Groups times numbers of blinded robots looked at between two looks at the clock: some hundredths of a second."""


@numba.njit(cache=True)
def _links_inside(neighbours: Any) -> Any:
    """(2**N,) links inside each set of robots."""
    n_robots = len(neighbours)
    inside = np.zeros(1 << n_robots, dtype=np.int16)
    for i in range(n_robots):
        for mask in range(1 << i):
            inside[mask | (1 << i)] = inside[mask] + count_ones(mask & neighbours[i])
    return inside


@numba.njit(cache=True)
def _connected(masks: Any, neighbours: Any) -> Any:
    answer = np.zeros(len(masks), dtype=np.bool_)
    for k, mask in enumerate(masks):
        reached, fresh = mask & -mask, mask & -mask
        while fresh:
            grown = 0
            for i in range(len(neighbours)):
                if (fresh >> i) & 1:
                    grown |= neighbours[i]
            fresh = grown & mask & ~reached
            reached |= fresh
        answer[k] = reached == mask
    return answer


@numba.njit(cache=True)
def _group_of(mask: int, groups: Any, is_group: Any, start: Any, best: Any, tables: Any) -> int:  # noqa: PLR0917
    """Fill ``best`` (K,) with the fewest links for ``mask`` by number of blinded robots; returns the last improver.

    The groups of the lowest robot are listed or, if that is fewer, all subsets are tried.
    """
    inside, row, need, links = tables
    width, pick = len(best), -1
    low = mask & -mask
    others, position = mask ^ low, 0
    lowest, size = count_ones(low - 1), count_ones(others)
    listed = start[lowest + 1] - start[lowest]
    by_list = size >= 30 or listed < (1 << size)
    best[:] = FAR
    part = others
    while True:
        if by_list:
            if position >= listed:
                break
            group = groups[start[lowest] + position]
            position += 1
            usable = group & ~mask == 0
        else:
            group = part | low
            usable = is_group[group]
        rest = mask ^ group
        if usable and row[rest] >= 0 and need[group] < width:
            cost = inside[mask] - inside[group] - inside[rest]
            for k in range(need[group], width):
                total = links[row[rest], k - need[group]] + cost
                if total < best[k]:
                    best[k] = total
                    if k == width - 1:
                        pick = group
        if not by_list:
            if part == 0:
                break
            part = (part - 1) & others
    return pick


@numba.njit(cache=True)
def _fill(masks: Any, groups: Any, is_group: Any, start: Any, tables: Any, first: int, steps: int) -> int:  # noqa: PLR0917
    """Fill the rows of ``tables`` from ``first`` on until that many groups were looked at; returns the next row."""
    links = tables[3]
    best = np.zeros(links.shape[1], dtype=np.int16)
    k = first
    while k < len(masks) and steps > 0:
        mask = masks[k]
        low = mask & -mask
        lowest = count_ones(low - 1)
        steps -= 1 + min(start[lowest + 1] - start[lowest], 1 << count_ones(mask ^ low))
        _group_of(mask, groups, is_group, start, best, tables)
        links[k] = best
        k += 1
    return k


class CompiledThresholdTest:
    """Decides for one plan whether an attack can push the team value to a threshold; see ``ThresholdTest``.

    ``threat`` : N robots, at most ``LARGEST_COMPILED``; ``values`` : (2**N,) value of every set of robots, by bit mask
    """

    def __init__(self, threat: Threat, values: FloatArray) -> None:
        n_robots = threat.graph.n_robots
        if n_robots > LARGEST_COMPILED:
            raise InputError("graph", f"must have at most {LARGEST_COMPILED} robots for a threshold test", n_robots)
        self.threat, self.values = threat, values
        neighbours = np.array(neighbour_masks(n_robots, threat.graph.links), dtype=np.int64)
        self._inside = _links_inside(neighbours)
        held = _links_inside(np.array(neighbour_masks(n_robots, threat.protected_links), dtype=np.int64))
        # Reversing a table by bit mask gives the complements.
        between = self._inside[-1] - self._inside - self._inside[::-1]
        separable = (between <= threat.alpha_c) & (held[-1] == held + held[::-1])
        self._masks = np.flatnonzero(separable)
        self._row = np.full(2**n_robots, -1, dtype=np.int32)
        self._row[self._masks] = np.arange(len(self._masks))
        groups = self._masks[1:][_connected(self._masks[1:], neighbours)]
        self._is_group = np.zeros(2**n_robots, dtype=np.bool_)
        self._is_group[groups] = True
        lowest = np.bitwise_count((groups & -groups) - 1)
        order = np.argsort(lowest, kind="stable")
        self._groups = groups[order]
        self._start = np.searchsorted(lowest[order], np.arange(n_robots + 1))

    def split(self, threshold: float, budget: Budget | None = None) -> GroupSplit | None:
        """Return an attack's groups and survivors with team value at most ``threshold``, or ``None``.

        Raises
        ------
        OutOfBudget : the time of ``budget`` is up, or the user interrupted.
        """
        budget = Budget() if budget is None else budget
        need = fewest_blinded(self.threat, self.values, threshold).astype(np.int16)
        links = np.full((len(self._masks), self.threat.alpha_s + 1), FAR, dtype=np.int16)
        links[0] = 0
        tables = (self._inside, self._row, need, links)
        row, steps = 1, AT_ONCE // links.shape[1]
        while row < len(self._masks):
            budget.check()
            row = _fill(self._masks, self._groups, self._is_group, self._start, tables, row, steps)
        if links[-1, -1] > self.threat.alpha_c:
            return None
        return self._trace(tables, threshold)

    def _trace(self, tables: tuple[NDArray[Any], ...], threshold: float) -> GroupSplit:
        groups, survivors = [], []
        rest, blinded = len(self.values) - 1, self.threat.alpha_s
        while rest:
            best = np.zeros(blinded + 1, dtype=np.int16)
            group = int(_group_of(rest, self._groups, self._is_group, self._start, best, tables))
            groups.append(group)
            survivors.append(largest_survivors(self.threat, self.values, group, threshold))
            rest, blinded = rest ^ group, blinded - int(tables[2][group])
        return GroupSplit(tuple(groups), tuple(survivors))
