"""Weak families of groups of each vector of sizes, by exchanges from several starts: attacks, no claim."""

from __future__ import annotations

from itertools import islice
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.families.group_exchanges import GroupExchanges
from ratt_opt.attack.least_sets.exchanges import AT_ONCE, weak_sets_of_size
from ratt_opt.attack.least_sets.linear_descent import descended

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["WeakFamilies", "weakest_of"]

EXCHANGES_SHARE, SETTLED_SHARE, STRIDE = 0.2, 0.7, 20
"""Of the time, at most spent on exchanges before the bounds, and of that, on families of all vectors before a few are
shaken: large teams get fewer vectors, the first ones so far apart."""

SHAKEN, SHAKES = 6, 40
"""Vectors whose best family is shaken and exchanged again, and how often: a few milliseconds each at 30 robots."""

WEAK_SETS = 3
"""Weak sets of its size that a largest group is started from where it is clearly the best one."""

LIKELY, CLEARLY = 0.7, 0.5
"""Size of the second group, over the largest, up to which that one is likely, or clearly, the best. Measured at 30
robots: beyond 0.7 a list of the weakest largest groups closes attacks at the paper's budgets but seldom at others,
where it costs more than it saves."""


class WeakFamilies:
    """Finds families that no exchange makes weaker."""

    def __init__(self, task: AttackTask, team: PackedTeam) -> None:
        self._team, self._budget = team, task.budget
        self._must = np.isin(np.arange(len(team.single)), list(task.problem.threat.protected_robots))
        self._weak: dict[int, list[frozenset[int]]] = {}

    def exchanged(self, vectors: list[Sizes]) -> list[GroupExchanges]:
        """A family of each vector, weakest first, as far as the time goes.

        Raises
        ------
        OutOfBudget : the time is up before the first.
        """
        families: list[GroupExchanges] = []
        part = self._budget.part(EXCHANGES_SHARE)
        first = part.part(SETTLED_SHARE)
        for sizes in _spread(vectors):
            if families and first.stop() is not None:
                break
            self._budget.check()
            family = self._settled(sizes, first)
            for largest in () if first.is_over else self._weak_largest(sizes, first):
                if first.is_over:
                    break
                family.around(largest, first)
            families.append(family)
        families.sort(key=attrgetter("value"))
        for family in families[:SHAKEN]:
            family.shake(SHAKES, part)
        return sorted(families, key=attrgetter("value"))

    def deciding(self, vectors: list[Sizes], largest: int) -> list[GroupExchanges]:
        """A family of the first vectors whose largest group has that size and is likely to be the best one."""
        alone = (sizes for sizes in vectors if sizes[0] == largest and _second(sizes) <= LIKELY * largest)
        part = self._budget.part(EXCHANGES_SHARE)
        return [self._settled(sizes, part) for sizes in islice(alone, SHAKEN)]

    def start_from(self, families: list[GroupExchanges], sets: Iterable[frozenset[int]]) -> None:
        """Start the families anew from a few largest groups."""
        part = self._budget.part(EXCHANGES_SHARE)
        for largest, _ in zip(sets, range(WEAK_SETS), strict=False):
            for family in families:
                family.around(largest, part)

    def _settled(self, sizes: Sizes, budget: Budget) -> GroupExchanges:
        team = self._team
        family = GroupExchanges(team, sizes, self._must)
        largest, (n_robots, n_targets) = sizes[0], team.information.shape[:2]
        if largest * (n_robots - largest) * n_targets > AT_ONCE:
            weakest = np.argsort(team.single, kind="stable")[:largest]
            family.around(frozenset(descended(team, weakest).tolist()), budget)
        if not np.isfinite(family.value):
            family.weakest(budget)
        return family

    def _weak_largest(self, sizes: Sizes, budget: Budget) -> list[frozenset[int]]:
        """Weak sets of the size of a largest group that alone decides what a family is worth."""
        if _second(sizes) > CLEARLY * (largest := sizes[0]):
            return []
        if largest not in self._weak:
            self._weak[largest] = weak_sets_of_size(self._team, largest, budget)[:WEAK_SETS]
        return self._weak[largest]


def _spread(vectors: list[Sizes]) -> list[Sizes]:
    """All of them, those that are far apart first: there may be time for some only."""
    return [sizes for first in range(STRIDE) for sizes in vectors[first::STRIDE]]


def weakest_of(families: list[GroupExchanges]) -> tuple[frozenset[int], ...]:
    """The groups of the weakest family."""
    return min(families, key=attrgetter("value")).groups()


def _second(sizes: Sizes) -> int:
    return sizes[1] if len(sizes) > 1 else 0
