"""A cut that leaves a small largest group, by cheapest cuts one after the other: at once, or as far as time allows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Budget

if TYPE_CHECKING:
    from collections.abc import Collection

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["cheapest_cut", "heuristic_cut"]


def heuristic_cut(
    threat: Threat, budget: Budget | None = None, *, ignoring: Collection[int] = (), most: int = 200
) -> frozenset[Link]:
    """Split the largest group by its cheapest cut while the links, and the seconds, last.

    Once the time is up groups of up to ``most`` still lose robots. Of cuts that cost the same the robot with
    the fewest links is cut off, the lowest among equals.

    ``ignoring`` : robots that do not count for a group's size; a group with one that counts is not split
    ``most`` : larger groups lose the robot with the fewest links [robots]: a cheapest cut of 200 takes a tenth of a
        second, a hundred of them may be asked for, and if links are many the cheapest cut is a robot's anyway
    """
    own, locked = budget or Budget(), float(len(threat.graph.links) + 1)
    weights = np.zeros((threat.graph.n_robots, threat.graph.n_robots))
    for i, j in threat.graph.links:
        weights[i, j] = weights[j, i] = locked if (i, j) in threat.protected_links else 1.0
    groups, left, cut = threat.graph.groups(), threat.alpha_c, set[tuple[int, int]]()
    while True:
        largest = min(groups, key=lambda group: (-len(group.difference(ignoring)), min(group)))
        part = np.array(sorted(largest))
        if len(part) == 1 or len(largest.difference(ignoring)) <= 1 or (len(part) > most and own.is_over):
            return frozenset(cut)
        inside = weights[np.ix_(part, part)]
        side = np.zeros(len(part), dtype=np.bool_)
        side[inside.sum(axis=1).argmin()] = True
        if len(part) <= most and not own.is_over and not _is_dense(inside):
            found = cheapest_cut(inside)
            side = found if inside[np.ix_(found, ~found)].sum() < inside[np.ix_(side, ~side)].sum() else side
        cost = float(inside[np.ix_(side, ~side)].sum())
        if cost > left:
            return frozenset(cut)
        left -= int(cost)
        across = np.argwhere(weights[np.ix_(part[side], part[~side])] > 0)
        ends = zip(part[side][across[:, 0]].tolist(), part[~side][across[:, 1]].tolist(), strict=True)
        cut.update((min(i, j), max(i, j)) for i, j in ends)
        weights[np.ix_(part[side], part[~side])] = weights[np.ix_(part[~side], part[side])] = 0.0
        rest = [group for group in groups if group is not largest]
        groups = (*rest, *_components(part[side], weights), *_components(part[~side], weights))


def _is_dense(weights: FloatArray) -> bool:
    """Test whether any two robots are at most two links apart.

    If links cost alike, the cheapest cut is then the links of one robot.

    Source: Plesnik 1975.
    """
    linked = (weights > 0).astype(np.float32)
    return bool(weights.max() <= 1 and (linked @ linked + linked + np.eye(len(linked), dtype=np.float32) > 0).all())


def _components(robots: np.ndarray, weights: FloatArray) -> list[frozenset[int]]:
    """Connected components of some robots by the links that are left."""
    linked, found, open_ = weights[np.ix_(robots, robots)] > 0, [], np.ones(len(robots), dtype=np.bool_)
    while open_.any():
        group = np.zeros(len(robots), dtype=np.bool_)
        new = group.copy()
        new[open_.argmax()] = True
        while new.any():
            group |= new
            new = linked[new].any(axis=0) & ~group
        found.append(frozenset(robots[group].tolist()))
        open_ &= ~group
    return found


def cheapest_cut(weights: FloatArray) -> BoolArray:
    """(n,) one side of a cheapest cut of a connected graph with symmetric weights (n, n), n >= 2.

    Source: Stoer and Wagner 1997.
    """
    weights, n = weights.copy(), len(weights)
    alive, merged = np.ones(n, dtype=np.bool_), np.eye(n, dtype=np.bool_)
    best = np.inf
    side: BoolArray = merged[0]
    for left in range(n, 1, -1):
        last = int(alive.argmax())
        before, cost = last, 0.0
        held = np.where(alive, weights[last], -np.inf)  # links to the robots taken so far
        held[last] = -np.inf
        for _ in range(left - 1):
            before, last = last, int(held.argmax())
            cost = float(held[last])
            held += weights[last]
            held[last] = -np.inf
        if cost < best:
            best, side = cost, merged[last].copy()
        weights[before] += weights[last]
        weights[:, before] = weights[before]
        weights[before, before] = 0.0
        merged[before] |= merged[last]
        alive[last] = False
    return np.asarray(side)
