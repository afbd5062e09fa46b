"""Weak families of groups of each vector of sizes, by exchanges from several starts: attacks, no claim."""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.exchanges import descended, exchange_groups, weak_sets_of_size

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["GroupExchanges", "WeakFamilies", "weakest_of"]


class WeakFamilies:
    """Search for families that no exchange makes weaker."""

    def __init__(self, task: AttackTask, team: Team) -> None:
        self._team, self._budget = team, task.budget
        self._must = np.isin(np.arange(team.robots), list(task.problem.threat.protected_robots))
        self._weak: dict[int, list[frozenset[int]]] = {}

    def exchanged(self, vectors: list[Sizes]) -> list[GroupExchanges]:
        """A family of each vector, weakest first, as far as the time goes.

        Raises
        ------
        OutOfBudget : the time is up before the first.
        """
        families: list[GroupExchanges] = []
        params = self._team.params.family_exchanges
        part = self._budget.part(params.share)
        first = part.part(params.settled_share)
        apart = (sizes for start in range(params.stride) for sizes in vectors[start :: params.stride])
        for sizes in apart:  # those far apart first: there may be time for some only
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
        for family in families[: params.shaken]:
            family.shake(params.shakes, part)
        return sorted(families, key=attrgetter("value"))

    def _settled(self, sizes: Sizes, budget: Budget) -> GroupExchanges:
        team = self._team
        family = GroupExchanges(team, sizes, self._must)
        largest, (n_robots, n_targets) = sizes[0], team.information.shape[:2]
        if largest * (n_robots - largest) * n_targets > self._team.params.family_exchanges.large:
            weakest = np.argsort(team.single, kind="stable")[:largest]
            family.around(frozenset(descended(team, weakest).tolist()), budget)
        if not np.isfinite(family.value):
            family.weakest(budget)
        return family

    def _weak_largest(self, sizes: Sizes, budget: Budget) -> list[frozenset[int]]:
        """Weak sets of the size of a largest group that alone decides what a family is worth."""
        params, largest = self._team.params.family_exchanges, sizes[0]
        if max(sizes[1:], default=0) > params.clearly * largest:
            return []
        if largest not in self._weak:
            self._weak[largest] = weak_sets_of_size(self._team, largest, budget)[: params.weak_sets]
        return self._weak[largest]


def weakest_of(families: list[GroupExchanges]) -> tuple[frozenset[int], ...]:
    """The groups of the weakest family."""
    return min(families, key=attrgetter("value")).groups()


class GroupExchanges:
    """The weakest family known of one vector of sizes; deterministic.

    Parameters
    ----------
    sizes : of the groups of unblinded robots, largest first
    must : (N,) robots that cannot be blinded
    """

    def __init__(self, team: Team, sizes: Sizes, must: BoolArray) -> None:
        self._team, self._must, self.sizes = team, must, sizes
        self._rng = np.random.default_rng(team.params.family_exchanges.seed)
        self._home: IntArray = np.zeros(team.robots, dtype=np.int64)
        """(N,) group of each robot, 0 for those that are blinded, 1.. for the sizes in order."""
        self.value = np.inf
        """Value of the best group."""

    def weakest(self, budget: Budget) -> None:
        """Start from the individually weakest robots, the weakest in the largest group; as far as time allows."""
        rising = np.argsort(self._team.single, kind="stable")
        # Robots that cannot be blinded sense in any case.
        seeing = np.concatenate([rising[self._must[rising]], rising[~self._must[rising]]])[: sum(self.sizes)]
        home = np.zeros_like(self._home)
        home[rising[np.isin(rising, seeing)]] = np.repeat(np.arange(1, len(self.sizes) + 1), self.sizes)
        self._improve(home, budget)

    def around(self, largest: frozenset[int], budget: Budget) -> None:
        """Start from a largest group, and the individually weakest others."""
        rising = np.argsort(self._team.single, kind="stable")
        others = rising[~np.isin(rising, list(largest))]
        others = np.concatenate([others[self._must[others]], others[~self._must[others]]])
        home = np.zeros_like(self._home)
        home[list(largest)] = 1
        places = np.repeat(np.arange(2, len(self.sizes) + 1), self.sizes[1:])
        home[others[: len(places)]] = places
        if not (self._must & (home == 0)).any():
            self._improve(home, budget)

    def near(self, groups: Iterable[Collection[int]], budget: Budget) -> None:
        """Start from a family of groups of these sizes."""
        home = np.zeros_like(self._home)
        for g, group in enumerate(sorted(groups, key=len, reverse=True), start=1):
            home[list(group)] = g
        self._improve(home, budget)

    def shake(self, rounds: int, budget: Budget) -> None:
        """Exchange a few random robots of the best family and improve it again, so often; as far as time allows."""
        for _ in range(rounds):
            if budget.is_over:
                return
            home = self._home.copy()
            strength = self._team.params.family_exchanges.strength
            for one, other in self._rng.integers(0, len(home), (strength, 2)).tolist():
                if (home[one] and home[other]) or not (self._must[one] or self._must[other]):
                    home[one], home[other] = home[other], home[one]
            self._improve(home, budget)

    def groups(self) -> tuple[frozenset[int], ...]:
        """The best family found."""
        return tuple(frozenset(np.flatnonzero(self._home == g).tolist()) for g in range(1, len(self.sizes) + 1))

    def _improve(self, home: IntArray, budget: Budget) -> None:
        share = self._team.params.family_exchanges.both
        value = exchange_groups(self._team, len(self.sizes), home, self._must, budget, share)
        if value < self.value:
            self.value, self._home = value, home
