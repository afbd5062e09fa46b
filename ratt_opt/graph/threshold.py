"""A plain exact attacker: which values can an attack push a team of few robots down to?

An attack leaves a partition of the robots into connected groups and a blinded set. For a threshold
``tau`` let ``need(G)`` be the fewest robots of group ``G`` to blind so that the others are worth at most
``tau``. Then ``links(R, k)``, the fewest links that split the robots ``R`` into connected groups with
``sum of need <= k``, follows from the group ``G`` of the lowest robot of ``R``:

    links(R, k) = min over G of  crossing(G, R - G) + links(R - G, k - need(G)).

``tau`` is reachable exactly when ``links(all, alpha_s) <= alpha_c``. This is the definition of the
inner problem, so it relies on no property of the objective.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Budget
from ratt_opt.graph.communication import robots_of
from ratt_opt.graph.connected_partitions import SubsetLattice, submasks

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.graph.threat import Threat

__all__ = ["GroupSplit", "ThresholdTest", "fewest_blinded", "largest_survivors"]

UNREACHABLE = np.int16(10_000)
"""Links that no budget holds."""


@dataclass(frozen=True, slots=True)
class GroupSplit:
    """Groups of robots (bit masks) and the survivors within each."""

    groups: tuple[int, ...]
    survivors: tuple[int, ...]

    def members(self) -> list[list[int]]:
        """Robots of each group, blinded ones included."""
        return [robots_of(group) for group in self.groups]

    @property
    def blinded(self) -> list[int]:
        """Robots that do not survive."""
        return robots_of(sum(self.groups) - sum(self.survivors))


@dataclass(frozen=True, slots=True)
class _Level:
    """Transitions of all sets of robots of one size, sorted by set.

    ``sets`` (S,) bit masks; ``start`` (S,) first transition of each set; ``group``, ``rest``, ``cost`` (T,).
    """

    sets: IntArray
    start: IntArray
    group: IntArray
    rest: IntArray
    cost: IntArray

    def only(self, one_set: int) -> _Level:
        """The transitions of one of the sets."""
        k = int(np.searchsorted(self.sets, one_set))
        part = slice(*np.append(self.start, len(self.group))[k : k + 2].tolist())
        return _Level(self.sets[k : k + 1], np.zeros(1, np.int64), self.group[part], self.rest[part], self.cost[part])


class ThresholdTest:
    """Test whether an attack on one plan can push the team value to a threshold.

    ``threat`` : N robots, at most ``LARGEST_LATTICE``; ``values`` : (2**N,) value of every set of robots, by bit mask;
    ``largest_group`` : consider only attacks whose groups, blinded robots included, have at most this many robots
    """

    def __init__(self, threat: Threat, values: FloatArray, *, largest_group: int | None = None) -> None:
        self.threat = threat
        self.values = values
        self.n_robots = threat.graph.n_robots
        self._masks = np.arange(2**self.n_robots)
        self._sizes = np.bitwise_count(self._masks).astype(np.int64)
        self._levels = _levels(SubsetLattice.of(threat), threat.alpha_c, self._sizes, largest_group or self.n_robots)
        self._level_of = {int(self._sizes[level.sets[0]]): level for level in self._levels}

    def split(self, threshold: float, budget: Budget | None = None) -> GroupSplit | None:
        """Return an attack's groups and survivors with team value at most ``threshold``, or ``None``.

        Raises
        ------
        OutOfBudget : the time of ``budget`` is up, or the user interrupted.
        """
        budget = Budget() if budget is None else budget
        need = fewest_blinded(self.threat, self.values, threshold)
        links = np.full((2**self.n_robots, self.threat.alpha_s + 1), UNREACHABLE, dtype=np.int16)
        links[0] = 0
        for level in self._levels:
            budget.check()
            links[level.sets] = np.minimum.reduceat(_costs(level, links, need), level.start, axis=0)
        if links[-1, -1] > self.threat.alpha_c:
            return None
        return self._trace(links, need, threshold)

    def _trace(self, links: IntArray, need: IntArray, threshold: float) -> GroupSplit:
        groups, survivors = [], []
        rest, blinded = int(self._masks[-1]), self.threat.alpha_s
        while rest:
            one = self._level_of[int(self._sizes[rest])].only(rest)
            pick = int(_costs(one, links, need)[:, blinded].argmin())
            group = int(one.group[pick])
            groups.append(group)
            survivors.append(largest_survivors(self.threat, self.values, group, threshold))
            rest, blinded = int(one.rest[pick]), blinded - int(need[group])
        return GroupSplit(tuple(groups), tuple(survivors))


def fewest_blinded(threat: Threat, values: FloatArray, threshold: float) -> IntArray:
    """(2**N,) fewest robots to blind in each group so that the others are worth at most ``threshold``.

    More than N if it cannot be done (protected robots, or a threshold below the value of no measurement).
    """
    n_robots = threat.graph.n_robots
    sizes = np.bitwise_count(np.arange(2**n_robots)).astype(np.int64)
    kept = np.where(values <= threshold, sizes, -1 - n_robots)
    for i in range(n_robots):
        if i not in threat.protected_robots:
            pairs = kept.reshape(-1, 2, 1 << i)
            np.maximum(pairs[:, 1], pairs[:, 0], out=pairs[:, 1])
    return np.asarray(sizes - kept)


def largest_survivors(threat: Threat, values: FloatArray, group: int, threshold: float) -> int:
    """Largest set of survivors of a group within the threshold; the lowest mask among equals."""
    fixed = sum(1 << i for i in threat.protected_robots if group >> i & 1)
    sets = submasks(group ^ fixed) | fixed
    sets = sets[values[sets] <= threshold]
    return int(sets[np.bitwise_count(sets).argmax()])


def _levels(lattice: SubsetLattice, alpha_c: int, sizes: IntArray, largest_group: int) -> list[_Level]:
    """Transitions of every set of robots, by its number of robots; those over the link budget are dropped."""
    n_robots = lattice.n_robots
    # All (set, group) pairs: a group holds the set's lowest robot and any of its others.
    sets, groups = np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
    all_sets, all_groups = [], []
    for i in range(n_robots - 1, -1, -1):
        bit = 1 << i
        all_sets.append(sets | bit)
        all_groups.append(groups | bit)
        sets = np.concatenate([sets, sets | bit, sets | bit])
        groups = np.concatenate([groups, groups, groups | bit])
    sets, groups = np.concatenate(all_sets), np.concatenate(all_groups)
    keep = lattice.connected[groups] & (sizes[groups] <= largest_group)
    sets, groups = sets[keep], groups[keep]
    cost = lattice.crossing(groups, sets ^ groups)
    keep = cost <= alpha_c
    sets, groups, cost = sets[keep], groups[keep], cost[keep]
    order = np.lexsort((groups, sets, sizes[sets]))
    sets, groups, cost = sets[order], groups[order], cost[order]
    levels = []
    for part in np.split(np.arange(len(sets)), np.flatnonzero(np.diff(sizes[sets])) + 1):
        unique, start = np.unique(sets[part], return_index=True)
        levels.append(_Level(unique, start, groups[part], sets[part] ^ groups[part], cost[part].astype(np.int16)))
    return levels


def _costs(level: _Level, links: IntArray, need: IntArray) -> IntArray:
    """(T, alpha_s + 1) fewest links per transition and number of blinded robots."""
    blinded = np.arange(links.shape[1])[None, :] - need[level.group][:, None]
    reached = links[level.rest[:, None], np.maximum(blinded, 0)]
    return np.where(blinded >= 0, reached + level.cost[:, None], UNREACHABLE)
