"""Partitions of a small graph into connected groups, by bit masks over robots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.graph.communication import neighbour_masks

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.graph.threat import Threat

__all__ = ["LARGEST_LATTICE", "SubsetLattice", "connected_partitions", "finest_partitions"]

LARGEST_LATTICE = 14
"""Most robots whose subsets are tabulated: 2.4 million (set, subset) pairs."""


@dataclass(frozen=True, slots=True)
class SubsetLattice:
    """Facts about every subset of robots, indexed by bit mask.

    ``links`` : (2**N,) links inside the subset
    ``protected`` : (2**N,) protected links inside the subset
    ``connected`` : (2**N,) whether the subset is connected in the graph; the empty set is not
    """

    n_robots: int
    links: IntArray
    protected: IntArray
    connected: BoolArray

    @classmethod
    def of(cls, threat: Threat) -> SubsetLattice:
        """Tabulate the graph of ``threat``."""
        n_robots = threat.graph.n_robots
        if n_robots > LARGEST_LATTICE:
            rule = f"must have at most {LARGEST_LATTICE} robots to enumerate connected groups (use worst_case_attack)"
            raise InputError("graph", rule, f"{n_robots} robots")
        masks = np.arange(2**n_robots)
        links, protected = np.zeros_like(masks), np.zeros_like(masks)
        for i, j in threat.graph.links:
            links += (masks >> i & masks >> j) & 1
        for i, j in threat.protected_links:
            protected += (masks >> i & masks >> j) & 1
        return cls(n_robots, links, protected, _connected(neighbour_masks(n_robots, threat.graph.links), masks))

    def crossing(self, first: IntArray, second: IntArray) -> IntArray:
        """Links between disjoint subsets; a huge number if one of them is protected."""
        both = first | second
        count = self.links[both] - self.links[first] - self.links[second]
        locked = self.protected[both] - self.protected[first] - self.protected[second]
        return np.where(locked > 0, 10**6, count)


def _connected(neighbours: list[int], masks: IntArray) -> BoolArray:
    """Test which subsets (bit masks) are connected: grow the lowest robot's component until it is stable."""
    reached = masks & -masks
    while True:
        grown = reached.copy()
        for i, near in enumerate(neighbours):
            grown |= np.where(reached >> i & 1, near, 0)
        grown &= masks
        if np.array_equal(grown, reached):
            return np.asarray((reached == masks) & (masks > 0))
        reached = grown


def connected_partitions(threat: Threat) -> Iterator[tuple[int, ...]]:
    """Yield every partition into connected groups that the link budget can leave, as bit masks by lowest robot."""
    lattice = SubsetLattice.of(threat)
    full = 2**lattice.n_robots - 1
    return _split(lattice, full, threat.alpha_c, {})


def _split(
    lattice: SubsetLattice, rest: int, budget: int, known: dict[int, list[tuple[int, int]]]
) -> Iterator[tuple[int, ...]]:
    if not rest:
        yield ()
        return
    if rest not in known:
        known[rest] = _first_groups(lattice, rest)
    for group, cost in known[rest]:
        if cost > budget:
            break
        for others in _split(lattice, rest ^ group, budget - cost, known):
            yield (group, *others)


def _first_groups(lattice: SubsetLattice, rest: int) -> list[tuple[int, int]]:
    """Connected groups of ``rest`` that hold its lowest robot, with the links to the others, cheapest first."""
    low = rest & -rest
    groups = submasks(rest ^ low) | low
    groups = groups[lattice.connected[groups]]
    cost = lattice.crossing(groups, rest ^ groups)
    order = np.lexsort((groups, cost))
    return list(zip(groups[order].tolist(), cost[order].tolist(), strict=True))


def submasks(mask: int) -> IntArray:
    """All subsets of a bit mask, ascending."""
    subsets = np.zeros(1, dtype=np.int64)
    while mask:
        low = mask & -mask
        subsets = np.concatenate([subsets, subsets | low])
        mask ^= low
    return subsets


def finest_partitions(threat: Threat) -> list[tuple[int, ...]]:
    """Feasible connected partitions that no other feasible one refines, sorted.

    Undoing one step of a refinement keeps groups connected and cuts fewer links, so a partition is
    finest exactly when the cheapest cut of each of its groups exceeds the budget that is left.
    """
    lattice = SubsetLattice.of(threat)
    cheapest: dict[int, int] = {}
    finest = []
    for partition in _split(lattice, 2**lattice.n_robots - 1, threat.alpha_c, {}):
        left = threat.alpha_c - int(lattice.links[-1] - lattice.links[list(partition)].sum())
        if all(_cheapest_split(lattice, group, cheapest) > left for group in partition):
            finest.append(partition)
    return sorted(finest)


def _cheapest_split(lattice: SubsetLattice, group: int, known: dict[int, int]) -> int:
    """Fewest links whose loss splits a group; a huge number if nothing can."""
    if group not in known:
        low = group & -group
        parts = submasks(group ^ low)[:-1] | low if group != low else np.array([], dtype=np.int64)
        known[group] = int(lattice.crossing(parts, group ^ parts).min(initial=10**6))
    return known[group]
