"""Families of groups of given sizes whose best group is weak, by exchanging robots between groups and the rest.

The value of the best group has many local minima; a family that no exchange improves is shaken by a few random ones
and improved again, and the better of the two is kept.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import team_criterion

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
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
    sizes : of the groups of seeing robots, largest first
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
        team, (n_robots, n_targets) = self._team, self._team.information.shape[:2]
        criterion = team.code, team.weights, team.baseline, team.prior, team.information
        steps, finished, value = max(4 * AT_ONCE // (n_robots**2 * n_targets), 1), False, np.inf
        while not finished:
            value, finished = _exchange(criterion, home, len(self.sizes), self._must, steps)
            finished = finished or budget.is_over
        if value < self.value:
            self.value, self._home = value, home


@numba.njit(cache=True)
def _exchange(criterion: Any, home: Any, n_groups: int, must: Any, steps: int) -> Any:
    """Exchange a robot of the best group for one elsewhere, the best pair each time, while the best group weakens.

    Returns its value, and whether that was before ``steps`` exchanges.
    """
    code, weights, baseline, prior, information = criterion
    n_robots, n_targets = information.shape[0], information.shape[1]
    sums, values = np.zeros((n_groups + 1, *prior.shape)), np.full(n_groups + 1, -np.inf)
    for g in range(n_groups + 1):
        sums[g] = prior
    for i in range(n_robots):
        sums[home[i]] += information[i]
    for g in range(1, n_groups + 1):
        values[g] = baseline - team_criterion(code, weights, sums[g])
    for _ in range(steps):
        top = int(np.argmax(values))
        leaves, enters = _best_pair(criterion, (home, must), (sums, values), top)
        if leaves < 0:
            return float(values[top]), True
        other = home[enters]
        for j in range(n_targets):
            for t in range(prior.shape[1]):
                change = information[enters, j, t] - information[leaves, j, t]
                sums[top, j, t] += change
                sums[other, j, t] -= change
        home[leaves], home[enters] = other, top
        for g in (top, other):
            if g > 0:
                values[g] = baseline - team_criterion(code, weights, sums[g])
    return float(values.max()), False


@numba.njit(cache=True)
def _best_pair(criterion: Any, robots: Any, groups: Any, top: int) -> Any:
    """The exchange that leaves the least best group, both groups below what the best one was; (-1, -1) if none does.

    Among exchanges that leave another group the best one, the two groups' sum decides.
    """
    (home, must), (sums, values) = robots, groups
    second = -np.inf
    for g in range(1, len(values)):
        if g != top:
            second = max(second, values[g])
    goal = values[top] - 1e-12 * abs(values[top])
    leaves, enters, lowest = -1, -1, np.inf
    for i in range(len(home)):
        if home[i] != top:
            continue
        for e in range(len(home)):
            if home[e] == top or (home[e] == 0 and must[i]):
                continue
            mine = _exchanged_value(criterion, sums[top], i, e)
            if mine >= goal:
                continue
            other = _exchanged_value(criterion, sums[home[e]], e, i) if home[e] > 0 else -np.inf
            if other < goal:
                score = max(mine, other, second) + SHARE * (mine + max(mine, other))
                if score < lowest:
                    leaves, enters, lowest = i, e, score
    return leaves, enters


@numba.njit(cache=True)
def _exchanged_value(criterion: Any, sums: Any, leaves: int, enters: int) -> float:
    """Value of a group once one robot is replaced."""
    code, weights, baseline, _, information = criterion
    one = np.empty_like(sums)
    for j in range(len(sums)):
        for t in range(one.shape[1]):
            one[j, t] = sums[j, t] - information[leaves, j, t] + information[enters, j, t]
    return float(baseline - team_criterion(code, weights, one))
