"""Weak sets that pay the prices, for whoever asks: annealed ones, and a search that may prove that there is none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.family_prices.annealed_sets import annealed_of_size, annealed_sets
from ratt_opt.attackers.by_size.family_prices.paying_sets import PayingSets, Question, Sets
from ratt_opt.attackers.weakest_set.exchanges import exchanged
from ratt_opt.attackers.weakest_set.linear_descent import descended
from ratt_opt.attackers.weakest_set.pair_bound import views

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray
    from ratt_opt.attackers.by_size.family_prices.family_program import FamilyPrices
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget

__all__ = ["SetFinder"]

OF_SIZE = 3
"""How many times as many moves a set of one size has as one around a robot."""
FIRST_TURN, TURN = 700, 3_000
"""Nodes of a size before that of which least is proved has its turn: pairs and a minorant of all sets, so that
something is proved of every size soon; then pairs of few robots, or fifteen minorants."""
SEED = 0


class SetFinder:
    """Answers for one team; ``n_seeing`` : size of the largest sets asked for.

    ``is_quick`` : whether a search takes hardly longer than annealing, which then is left out
    """

    def __init__(self, team: PackedTeam, n_seeing: int) -> None:
        self._team, self._n_seeing, self._sets = team, n_seeing, PayingSets(team)
        self.is_quick = self._sets.is_by_axis
        self._likely: set[int] = set()
        self.proved = -np.inf
        """No set that pays is worth less, of the last question that was to be decided."""
        self._views, self._rng = views(team), np.random.default_rng(SEED)
        self._weak: dict[int, tuple[BoolArray, float]] = {}

    def annealed(
        self, threshold: float, prices: FamilyPrices, least: float, moves: int, budget: Budget
    ) -> list[BoolArray]:
        """Sets that pay more than ``least``, annealed around each robot and of each size; some may be the same.

        For criteria without axes, where a set is weak if all targets together say so.
        """
        found: list[BoolArray] = []
        has_limit = np.isfinite(prices.limits)
        sizes = np.arange(len(has_limit), dtype=np.float64)
        # Sizes that no group has are between others on the way from one set to the next.
        links = -np.interp(sizes, sizes[has_limit], prices.limits[has_limit])
        (view,) = self._views
        sets = annealed_sets(view, threshold, prices.robots, links, moves, self._rng, budget)
        found.extend(members for members, paid in sets if paid > least and has_limit[members.sum()])
        for size in np.flatnonzero(has_limit[: self._n_seeing + 1]).tolist():
            weak, value = self._weakest(size, budget)
            if value >= threshold or budget.is_over:
                break
            members = annealed_of_size(view, threshold, prices.robots, weak, OF_SIZE * moves, self._rng)
            if float(prices.robots[members].sum()) - prices.limits[size] > least:
                found.append(members)
        return found

    def _weakest(self, size: int, budget: Budget) -> tuple[BoolArray, float]:
        """A weak set (N,) of a size, and its value: where a descent and exchanges end."""
        if size not in self._weak:
            start = descended(self._team, np.argsort(self._team.single, kind="stable")[:size])
            robots = sorted(exchanged(self._team, start.tolist(), budget=budget))
            self._weak[size] = np.isin(np.arange(len(self._team.single)), robots), self._team.value(robots)
        return self._weak[size]

    def searched(self, threshold: float, prices: FamilyPrices, nodes: int, budget: Budget) -> Sets:
        """Sets that pay, or what those are worth at least that may be left; each size has so many nodes.

        The first size left open ends the search.

        Raises
        ------
        OutOfBudget : the time is up, or no node is left.
        """
        found: list[BoolArray] = []
        lower = np.inf
        for size in self._possible(threshold, prices):
            sets = self._sets.of_size(_question(threshold, prices, size), size, budget, nodes)
            found.extend(sets.found)
            lower = min(lower, sets.lower)
            if not (sets.found or sets.is_complete):
                break
        return Sets(found, lower)

    def decided(self, threshold: float, prices: FamilyPrices, nodes: int, budget: Budget) -> Sets:
        """The same where searches take long, the size first, each time, of which least is proved.

        Sizes of which the last search found some come first, and where some are found the others are not searched.
        :attr:`proved` stays valid however this ends.

        Raises
        ------
        OutOfBudget : the time is up, or no node is left.
        """
        self.proved = -np.inf
        found: list[BoolArray] = []
        possible = self._possible(threshold, prices)
        possible.sort(key=lambda size: (size not in self._likely, size))
        likely, self._likely = self._likely, set()
        lower: dict[int, float] = {}
        for size in possible:
            if found and size not in likely:
                return Sets(found, -np.inf)
            sets = self._sets.of_size(_question(threshold, prices, size), size, budget, FIRST_TURN)
            lower[size] = sets.lower
            if sets.found:
                self._likely.add(size)
                found.extend(sets.found)
        spent = dict.fromkeys(lower, FIRST_TURN)
        while lower and not found:
            self.proved = min(lower.values())
            size = min(lower, key=lower.__getitem__)
            if lower[size] == np.inf or spent[size] >= nodes:
                break
            sets = self._sets.of_size(_question(threshold, prices, size), size, budget, TURN, goes_on=True)
            lower[size], spent[size], found = sets.lower, spent[size] + TURN, sets.found
            if found:
                self._likely.add(size)
        return Sets(found, min(lower.values(), default=np.inf))

    def _possible(self, threshold: float, prices: FamilyPrices) -> list[int]:
        """Sizes that a group may have of which sets may be worth less than the threshold."""
        return [size for size in self._sets.sizes(threshold, self._n_seeing) if np.isfinite(prices.limits[size])]


def _question(threshold: float, prices: FamilyPrices, size: int) -> Question:
    return Question(threshold, prices.robots, float(prices.limits[size]))
