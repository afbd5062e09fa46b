"""Few links whose cut leaves no group above a size, by simulated annealing over the robots' groups, in compiled code.

Imported only if compiled loops are used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.graph.largest_group.counting import largest_left
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from collections.abc import Collection

    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["annealed_cut"]

HOT, COLD, OVERSIZE = 3.0, 0.15, 2.0
"""Temperatures and the price of a robot too many in a group, in links."""
MOVES, MOVES_AT_ONCE = 1_500, 20_000
"""Moves for each robot in a cooling, and moves between two looks at the clock. At 50 to 200 robots more find no better
cut."""
MISSES = 4
"""Sizes in a row that are not met before annealing gives up."""
SPARE_GROUPS = (0.0, 0.05, 0.15, 0.3, 0.6, 1.0)
"""Groups beyond the fewest that hold all robots, one cooling each, in shares of these. Measured on sparse disks: at 50
robots none are needed, at 200 a third or more."""


def annealed_cut(
    threat: Threat, cut: frozenset[Link], lower: int, budget: Budget, *, ignoring: Collection[int] = ()
) -> frozenset[Link]:
    """A cut that leaves a smaller largest group than ``cut`` does, if annealing finds one.

    Sizes are bisected first; as annealing may miss one size and meet a smaller one, the next few are tried after that.

    ``lower`` : no cut leaves a smaller largest group
    ``ignoring`` : robots that do not count for a group's size
    """
    best, low, missed = cut, lower, 0
    size = largest_left(threat.graph, best, ignoring)
    while size > lower and missed < MISSES and budget.stop() is None:
        goal = (low + size) // 2 if low < size else size - 1 - missed
        found = _cut_below(threat, goal, budget, ignoring) if goal >= lower else None
        if found is not None:
            best, size, missed = found, largest_left(threat.graph, found, ignoring), 0
        elif low < size:
            low = goal + 1
        else:
            missed += 1
    return best


def _cut_below(threat: Threat, size: int, budget: Budget, ignoring: Collection[int]) -> frozenset[Link] | None:
    """A cut within the budget that leaves groups of at most ``size`` robots that count, if a few coolings find one."""
    n_robots, links = threat.graph.n_robots, sorted(threat.graph.links)
    arcs = np.array([*links, *(link[::-1] for link in links)], dtype=np.int64).reshape(-1, 2)
    price = np.array([len(links) + 1 if link in threat.protected_links else 1 for link in links] * 2, dtype=np.int64)
    order = np.lexsort(arcs.T[::-1])
    first = np.searchsorted(arcs[order, 0], np.arange(n_robots + 1))
    counts = np.array([i not in ignoring for i in range(n_robots)], dtype=np.int64)
    network = (first, arcs[order, 1].copy(), price[order], counts)
    rng = np.random.default_rng(size)
    fewest = -(-int(counts.sum()) // size)
    for count in dict.fromkeys(fewest + round(share * fewest) for share in SPARE_GROUPS):
        group = rng.integers(0, count, n_robots)
        state = (group, np.bincount(group[counts > 0], minlength=count), group.copy())
        within, moves = threat.alpha_c + 1, MOVES * n_robots
        for start in range(0, moves, MOVES_AT_ONCE):
            if budget.stop() is not None:
                break
            part = (start, min(start + MOVES_AT_ONCE, moves), moves)
            within = int(_cool(network, state, np.array([size, within]), part, rng))
            if within <= threat.alpha_c:
                best = state[2]
                return frozenset((i, j) for i, j in links if best[i] != best[j])
    return None


@numba.njit(cache=True)
def _cool(network: Any, state: Any, goal: Any, part: Any, rng: Any) -> Any:
    """Moves of one cooling: the fewest links cut so far by groups within the size, those groups in place.

    Parameters
    ----------
    network : start (N + 1,) of each robot's arcs; other robot and price (2 E,) of an arc; what each robot counts (N,)
    state : group (N,) of each robot, size (K,) of the groups, best groups (N,) so far
    goal : largest size; fewest links so far; part : first and last move of this call, moves of the cooling
    """
    first, others, price, counts = network
    group, sizes, best = state
    most, fewest = goal
    n_robots, cut, over = len(group), 0, 0
    for i in range(n_robots):
        for a in range(first[i], first[i + 1]):
            cut += price[a] * (group[others[a]] != group[i])
    cut //= 2
    for g in range(len(sizes)):
        over += max(sizes[g] - most, 0)
    for move in range(part[0], part[1]):
        heat = HOT * (COLD / HOT) ** (move / part[2])
        i = int(rng.random() * n_robots)
        degree = first[i + 1] - first[i]
        if degree and rng.random() < 0.95:
            target = group[others[first[i] + int(rng.random() * degree)]]
        else:
            target = int(rng.random() * len(sizes))
        home = group[i]
        if home == target:
            continue
        change, excess = 0, counts[i] * (int(sizes[target] >= most) - int(sizes[home] > most))
        for a in range(first[i], first[i + 1]):
            change += price[a] * (int(group[others[a]] == home) - int(group[others[a]] == target))
        worse = change + OVERSIZE * excess
        if worse <= 0 or rng.random() < np.exp(-worse / heat):
            group[i], cut, over = target, cut + change, over + excess
            sizes[home] -= counts[i]
            sizes[target] += counts[i]
            if over == 0 and cut < fewest:
                fewest = cut
                best[:] = group
    return fewest
