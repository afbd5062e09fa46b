"""Brackets on complete graphs by what knows no vectors of sizes: the forced size, annealed attacks, dives, prices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.annealed_families import AnnealedFamilies, Cooling, annealed_from
from ratt_opt.attackers.by_size.family_prices.family_dive import FamilyDive
from ratt_opt.attackers.by_size.family_prices.set_finder import SetFinder
from ratt_opt.attackers.by_size.family_prices.threshold_bound import LARGEST, ThresholdBound
from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import forced_group_size
from ratt_opt.problem import Attack
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt.attackers.by_size.group_exchanges import GroupExchanges
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["FamilySearch"]

FORCED_SHARE, ANNEALED_SHARE, ANNEALED_STARTS, PRICED_SHARE, LATER_SHARE = 0.1, 0.15, 3, 0.6, 0.15
"""Of the time left, for the bound of the forced size; then for annealed attacks, and how many before there are dives;
for prices where dives go on after them (else they have all that is left, as a slice that ends within a threshold loses
its search); and for attacks each time before prices go on. At 100 robots, (0, 4066), log-det, annealing leaves 0.3 to
0.4 % less than exchanges in 93 vectors; at 60, (0, 1454), max-eigenvalue, 5.70 where exchanges in all vectors leave
6.15."""
DIVED_SHARE, MOST_VAIN, REACH = 0.2, 4, (0.98, 1.01)
"""Of the time left, for dives before there are prices; how many, or how many turns, in a row may find nothing better;
and thresholds of dives, over the attack in hand."""
POLISHED, POLISHING = (1e-3, 3e-3), 500_000
"""First temperatures and moves of annealing from where a dive ends."""
PRICED_NODES = 300_000
"""Of prices where no time is set: some minutes."""
SEED = 0


class FamilySearch:
    """Narrows the task's bracket; relies on a non-decreasing objective.

    ``families`` : weak ones, whose groups the prices know at first
    ``vectors`` : of sizes, outside of which no attack is worse than that in hand; by default they are too many to list
    """

    def __init__(
        self,
        task: AttackTask,
        team: PackedTeam,
        families: list[GroupExchanges],
        vectors: Sequence[Sizes] | None = None,
    ) -> None:
        self._vectors = vectors
        self._task, self._team, self._threat = task, team, task.problem.threat
        self._known = [group for family in families for group in family.groups()]
        self._prices: ThresholdBound | None = None
        self._rng = np.random.default_rng(SEED)
        self._finder = SetFinder(team, len(team.single) - self._threat.n_blinded)
        self._dives = FamilyDive(team, self._threat, self._finder)
        self._annealed = AnnealedFamilies(team, self._threat)

    def run(self) -> Stop:
        """All of them, the attacks as long as there is time."""
        with self._task.budget.stage(FORCED_SHARE) as part:
            self._weakest_of_forced_size(part)
        if np.isfinite(self._task.budget.seconds_left):
            self.narrow(is_last=True)
        else:
            self.price(1.0)
        return Stop.CLOSED if self._task.bracket.is_closed else self._task.budget.stop() or Stop.HEURISTIC

    def narrow(self, *, is_last: bool = False) -> None:
        """Attacks and prices in turn within a limit of time, until it is up or the bracket closed.

        ``is_last`` : nothing else is there for the time left; else this ends where prices prove nothing at first and
        leave a threshold open, or neither end moves in a few turns
        """
        bracket = self._task.bracket
        self.anneal(ANNEALED_SHARE, ANNEALED_STARTS)
        self.dive(DIVED_SHARE)
        proved, vain = bracket.lower, 0
        self.price(PRICED_SHARE if self._finder.is_quick else 1.0)
        may_prove = bracket.lower > proved or (self._prices is not None and not self._prices.has_left_open)
        while not bracket.is_closed and (is_last or (may_prove and vain < MOST_VAIN)):
            before = bracket.lower, bracket.upper
            if not self.dive(LATER_SHARE):
                self.anneal(LATER_SHARE, 1)
            self.price(1.0)
            vain = vain + 1 if (bracket.lower, bracket.upper) == before else 0

    def anneal(self, share: float, starts: int) -> None:
        """A few annealed attacks, each longer than those before, in a share of the time left; the prices know them."""
        bracket, part = self._task.bracket, self._task.budget.part(share)
        if bracket.is_closed:
            return
        for _ in range(starts):
            if groups := self._annealed.start(part):
                self._offer(groups)
                self._learn(groups)
        self._task.budget.check()

    def dive(self, share: float) -> bool:
        """Attacks from prices, in a share of the time left, where sets are found quickly; whether any was better.

        With log-det dives found no better attacks than annealing from random families, and took time from the bound.
        """
        if self._finder.is_quick and not self._is_out_of_reach():
            before = self._task.bracket.upper
            with self._task.budget.stage(share) as part:
                self._dive(part)
            return self._task.bracket.upper < before
        return False

    def _dive(self, budget: Budget) -> None:
        bracket = self._task.bracket
        vain = 0
        while not (bracket.is_closed or budget.is_over or vain >= MOST_VAIN):
            vain, before = vain + 1, bracket.upper
            threshold = max(float(self._rng.uniform(*REACH)) * bracket.upper, bracket.lower)
            if groups := self._dives.family(threshold, budget):
                for hot in POLISHED:
                    cooling = Cooling(hot, POLISHING)
                    self._offer(annealed_from(groups, self._team, self._threat, cooling, self._rng, budget))
            if bracket.upper < before:
                vain = 0

    def _learn(self, groups: Iterable[frozenset[int]]) -> None:
        """Groups for the prices to know."""
        if self._prices is None:
            self._known.extend(groups)
        else:
            self._prices.learn(groups)

    def _is_out_of_reach(self) -> bool:
        """Whether nothing is left for prices, which are of the plane, or they would take too long."""
        bracket, team = self._task.bracket, self._team
        return bracket.is_closed or not team.is_planar or len(team.single) > LARGEST or not bracket.upper > 0

    def price(self, share: float) -> None:
        """Raise the lower end by prices, as far as they reach in a share of the time left."""
        budget, bracket = self._task.budget, self._task.bracket
        if self._is_out_of_reach():
            return
        if self._prices is None:
            self._prices = ThresholdBound(self._team, self._threat, self._vectors, [*self._known, *self._dives.sets()])
        prices = self._prices
        most = None if np.isfinite(budget.seconds_left) else PRICED_NODES
        with budget.stage(share, max_nodes=most) as part:
            prices.run(bracket, part)

    def _offer(self, groups: Iterable[frozenset[int]]) -> bool:
        outcome = tuple(sorted(groups, key=lambda group: min(group, default=0)))
        return self._task.offer(Attack(*realise(self._threat, outcome)))

    def _weakest_of_forced_size(self, budget: Budget) -> None:
        """Some group has the forced size at least, so the weakest set of that size is a bound."""
        bracket = self._task.bracket
        size = forced_group_size(len(self._team.single), self._threat.n_blinded, self._threat.alpha_c)
        search = WeakestSetSearch(self._team, size, bracket.goal, bracket.lower)
        for found in search.run(budget):
            if found is not None:
                search.threshold = min(search.threshold, self._team.value(found))
            bracket.raise_lower(min(search.lower, search.threshold))
        bracket.raise_lower(search.threshold)
