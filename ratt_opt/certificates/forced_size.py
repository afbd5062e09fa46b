"""Covers of all sets of a forced size by cases, compiled: targets of two coordinates.

A case has robots that are in the set, and robots that are decided. It closes where those in the set are worth the
threshold alone, where too few robots are left, or where the ``missing`` smallest of the values with ``missing`` copies
of one undecided robot are worth it on average (the verifier's leaf -3 says why that is enough). Otherwise one robot
is decided: the one for which the averages of both cases rise most, the product counting.

Measured on RATT's plans for 30 robots: a fifth to two fifths fewer leaves than deciding the weakest robot first.
Imported only where a certificate is written: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.certificates.plan_sets import COVERING
from ratt_opt.certificates.verifier.work import tell, tick
from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import team_criterion

if TYPE_CHECKING:
    from ratt_opt.attack.least_sets.packed_team import PackedTeam

__all__ = ["forced_size_tree"]

MOST_CASES = 30_000_000
"""Most criteria of single targets in a cover's leaves: the verifier looks at them, a microsecond or less each."""
MOST_LOOKED_AT = 1_000_000_000
"""Most criteria of single targets looked at to find a cover: five to ten seconds."""
AT_ONCE = 10_000_000
"""The same between two looks at the clock."""
TRIED = 8
"""Robots, those of the smallest values, that are tried before one is decided."""
LEAST_RISE = 1e-3
"""Of the rise that would close a case: what a case that does not rise at all counts for in the product."""


def forced_size_tree(team: PackedTeam, size: int, threshold: float, max_nodes: int) -> list[int] | None:
    """A cover of all sets of ``size`` robots of the team that proves them worth ``threshold``, in preorder.

    ``None`` where a set is worth less, or the cover is beyond ``max_nodes`` or the limits of this file.

    Raises
    ------
    UndecidedError : the time is up.
    """
    n_robots, n_targets = team.information.shape[:2]
    sums = np.zeros((n_robots + 2, n_targets, 3))
    sums[0] = team.prior
    # At each place of the stack: who is decided, how many are in and out; then places, nodes, cases, looked at.
    decided, counts = np.zeros((n_robots + 2, n_robots), dtype=np.bool_), np.zeros((n_robots + 2, 2), dtype=np.int64)
    state, counters = (sums, decided, counts), np.array([1, 0, 0, 0])
    tree = np.zeros(max_nodes + 1, dtype=np.int64)
    data = (team.code, team.weights, team.baseline), np.ascontiguousarray(team.information)
    while counters[0] > 0:
        tick()
        tell(COVERING, int(counters[1]))
        limits = counters[3] + AT_ONCE, MOST_CASES
        if not _cover(data, (size, threshold), state, (tree, counters), limits) or counters[3] > MOST_LOOKED_AT:
            return None
    return [int(node) for node in tree[: counters[1]]]


@numba.njit(cache=True)
def _cover(data: Any, wanted: Any, state: Any, found: Any, limits: Any) -> bool:
    """Go on until all is covered or the work is done; false where that fails or is too large."""
    (sums, decided, counts), (tree, counters), (size, threshold) = state, found, wanted
    work, most_cases = limits
    n_robots, n_targets = decided.shape[1], sums.shape[1]
    rest, values = np.empty(n_robots, dtype=np.int64), np.empty(n_robots)
    while counters[0] > 0 and counters[3] < work:
        if counters[1] >= len(tree) or counters[2] > most_cases:
            return False
        top = counters[0] - 1
        number, missing = 0, size - counts[top, 0]
        for i in range(n_robots):
            if not decided[top, i]:
                rest[number] = i
                number += 1
        node = -2
        if counts[top, 1] <= n_robots - size:
            node = _leaf(data, sums[top], (rest[:number], values[:number]), missing, threshold)
            counters[3] += (number + 1) * n_targets
            if node == 0:
                return False
            counters[2] += 0 if node == 1 else n_targets * (1 if node == -1 else number)
        if node == 1:
            node = _decision(data, sums[top], (rest[:number], values[:number]), missing, threshold)
            counters[3] += min(TRIED, missing) * number * n_targets
            decided[top, node] = True
            sums[top + 1], decided[top + 1], counts[top + 1] = sums[top] + data[1][node], decided[top], counts[top]
            counts[top + 1, 0] += 1
            counts[top, 1] += 1
            counters[0] += 2
        counters[0] -= 1
        tree[counters[1]] = node
        counters[1] += 1
    return True


@numba.njit(cache=True)
def _leaf(data: Any, sums: Any, others: Any, missing: int, threshold: float) -> int:
    """-1 or -3 where the case closes so; 0 where its set is complete and worth less; 1 otherwise, with the values."""
    (code, weights, baseline), _ = data
    rest, values = others
    if baseline - team_criterion(code, weights, sums) >= threshold:
        return -1
    if missing == 0:
        return 0
    _value_each(data, sums, rest, missing, values)
    return -3 if np.sort(values)[:missing].mean() >= threshold else 1


@numba.njit(cache=True)
def _value_each(data: Any, sums: Any, rest: Any, copies: int, values: Any) -> None:
    """``values[k]`` is the value of ``sums`` and so many copies of the robot ``rest[k]``."""
    (code, weights, baseline), information = data
    one = np.empty_like(sums)
    for k in range(len(rest)):
        for j in range(len(one)):
            for t in range(3):
                one[j, t] = sums[j, t] + copies * information[rest[k], j, t]
        values[k] = baseline - team_criterion(code, weights, one)


@numba.njit(cache=True)
def _decision(data: Any, sums: Any, others: Any, missing: int, threshold: float) -> int:
    """The robot to decide; ``others``: those undecided, and the values with ``missing`` copies of each."""
    (code, weights, baseline), information = data
    rest, values = others
    ranked = np.argsort(values, kind="mergesort")
    total = values[ranked[:missing]].sum()
    need = threshold - total / missing
    least, best, chosen = LEAST_RISE * need, -1.0, rest[ranked[0]]
    left, worths = np.empty(len(rest) - 1, dtype=np.int64), np.empty(len(rest) - 1)
    for k in ranked[: min(TRIED, missing)]:
        out = need
        if len(rest) > missing:
            out = (values[ranked[missing]] - values[k]) / missing
        left[:k], left[k:] = rest[:k], rest[k + 1 :]
        inside = sums + information[rest[k]]
        if missing > 1:
            _value_each(data, inside, left, missing - 1, worths)
            average = np.sort(worths)[: missing - 1].mean()
        else:
            average = baseline - team_criterion(code, weights, inside)
        score = max(min(out, need), least) * max(min(average - threshold + need, need), least)
        if score > best:
            best, chosen = score, rest[k]
    return int(chosen)
