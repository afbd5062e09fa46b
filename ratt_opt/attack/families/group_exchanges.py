"""Families of groups of given sizes whose best group is weak, by exchanging robots between groups and the rest.

The value of the best group has many local minima; a family that no exchange improves is shaken by a few random ones
and improved again, and the better of the two is kept.
"""

from __future__ import annotations

from ctypes import POINTER, byref, c_double, c_int, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import TeamRecord
from ratt_opt.native.library import address, function

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["GroupExchanges"]

STRENGTH = 3
"""Random exchanges of one shake: one is often undone, many leave nothing of the family."""
SEED = 0
AT_ONCE = 20_000_000
"""Pairs of robots times targets that compiled loops go through between two looks at the clock (a fifth of a second)."""
SHARE = 1e-3
"""Weight of the two groups' sum beside the largest value."""


class GroupExchanges:
    """The weakest family known of one vector of sizes; deterministic.

    Parameters
    ----------
    sizes : of the groups of unblinded robots, largest first
    must : (N,) robots that cannot be blinded
    """

    def __init__(self, team: PackedTeam, sizes: Sizes, must: BoolArray) -> None:
        self._team, self._must, self.sizes = team, must, sizes
        self._rng = np.random.default_rng(SEED)
        self._home: IntArray = np.zeros(len(team.single), dtype=np.int64)
        """(N,) group of each robot, 0 for those that are blinded, 1.. for the sizes in order."""
        self.value = np.inf
        """Of the best group."""

    def weakest(self, budget: Budget) -> None:
        """Start from the individually weakest robots, the weakest in the largest group; as far as time allows."""
        rising = np.argsort(self._team.single, kind="stable")
        # Those that cannot be blinded see in any case.
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
            for one, other in self._rng.integers(0, len(home), (STRENGTH, 2)).tolist():
                if (home[one] and home[other]) or not (self._must[one] or self._must[other]):
                    home[one], home[other] = home[other], home[one]
            self._improve(home, budget)

    def groups(self) -> tuple[frozenset[int], ...]:
        """The best family found."""
        return tuple(frozenset(np.flatnonzero(self._home == g).tolist()) for g in range(1, len(self.sizes) + 1))

    def _improve(self, home: IntArray, budget: Budget) -> None:
        n_robots, n_targets = self._team.information.shape[:2]
        call = function(
            "exchange_groups", c_int, POINTER(TeamRecord), c_int, *[c_void_p] * 2, c_double, c_int64, c_void_p
        )
        native, must = self._team.native(), np.ascontiguousarray(self._must, dtype=np.bool_)
        home, value = np.ascontiguousarray(home, dtype=np.int64), c_double(np.inf)
        steps, finished = max(4 * AT_ONCE // (n_robots**2 * n_targets), 1), 0
        while not finished:
            places = address(home), address(must)
            finished = call(native.reference, len(self.sizes), *places, SHARE, steps, byref(value))
            if finished < 0:
                raise MemoryError
            finished = finished or budget.is_over
        if value.value < self.value:
            self.value, self._home = value.value, home
