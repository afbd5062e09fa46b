"""Brackets on complete graphs by what knows no vectors of sizes: the forced size, annealed attacks, dives, prices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.annealed_families import AnnealedFamilies, Cooling, annealed_from
from ratt_opt.attackers.by_size.family_prices.family_dive import FamilyDive
from ratt_opt.attackers.by_size.family_prices.set_finder import SetFinder
from ratt_opt.attackers.by_size.family_prices.threshold_bound import LARGEST, ThresholdBound
from ratt_opt.attackers.staging import Stage, run_stages
from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.budget import Stop
from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import forced_group_size
from ratt_opt.problem import Attack

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
        self.task, self._team, self._threat = task, team, task.problem.threat
        self._known = [group for family in families for group in family.groups()]
        self._prices: ThresholdBound | None = None
        self._rng = np.random.default_rng(SEED)
        self._finder = SetFinder(team, len(team.single) - self._threat.n_blinded)
        self._dives = FamilyDive(team, self._threat, self._finder)
        self._annealed = AnnealedFamilies(team, self._threat)
        self._has_dived_deeper = False

    def run(self) -> Stop:
        """All of them, the attacks as long as there is time."""
        if stop := run_stages(FORCED, self):
            return stop
        self.narrow(is_last=True)
        return Stop.CLOSED if self.task.bracket.is_closed else self.task.budget.stop() or Stop.HEURISTIC

    def narrow(self, *, is_last: bool = False) -> None:
        """Attacks and prices in turn within a limit of time, until it is up or the bracket closed; without one, prices.

        ``is_last`` : nothing else is there for the time left; else this ends where prices prove nothing at first and
        leave a threshold open, or neither end moves in a few turns
        """
        bracket = self.task.bracket
        proved, vain = bracket.lower, 0
        run_stages(FIRST_TURN, self)
        may_prove = bracket.lower > proved or (self._prices is not None and not self._prices.has_left_open)
        goes_on = self.is_limited() and (is_last or may_prove)
        while not bracket.is_closed and goes_on and (is_last or vain < MOST_VAIN):
            self.task.budget.check()
            before = bracket.lower, bracket.upper
            run_stages(LATER_TURNS, self)
            vain = vain + 1 if (bracket.lower, bracket.upper) == before else 0

    # -- what the stages ask -------------------------------------------------------------------------------------

    def is_limited(self) -> bool:
        """Limit of time."""
        return bool(np.isfinite(self.task.budget.seconds_left))

    def may_dive(self) -> bool:
        """Limit of time, planar targets, sets found quickly."""
        return self.is_limited() and self._finder.is_quick and not self._is_out_of_reach()

    def is_priced(self) -> bool:
        """Limit of time, planar targets, sets not found quickly."""
        return self.is_limited() and not self._finder.is_quick and not self._is_out_of_reach()

    def is_priced_later(self) -> bool:
        """Planar targets."""
        return not self._is_out_of_reach()

    def is_priced_without_limit(self) -> bool:
        """No limit of time, planar targets."""
        return not (self.is_limited() or self._is_out_of_reach())

    def has_dived_in_vain(self) -> bool:
        """Dives, if any, found nothing."""
        return not (self._has_dived_deeper and self.may_dive())

    # -- the stages ----------------------------------------------------------------------------------------------

    def anneal_first(self) -> None:
        """A few annealed attacks, each longer than those before; the prices know them."""
        self._anneal(ANNEALED_STARTS)

    def anneal_once(self) -> None:
        """One more annealed attack."""
        self._anneal(1)

    def _anneal(self, starts: int) -> None:
        for _ in range(starts):
            if groups := self._annealed.start(self.task.budget):
                self._offer(groups)
                self._learn(groups)

    def dive(self) -> None:
        """Attacks from prices, if sets are found quickly.

        With log-det dives found no better attacks than annealing from random families, and took time from the bound.
        """
        before = self.task.bracket.upper
        try:
            self._dive(self.task.budget)
        finally:
            self._has_dived_deeper = self.task.bracket.upper < before

    def price(self) -> None:
        """Raise the lower end by prices, as far as they reach."""
        if self._prices is None:
            self._prices = ThresholdBound(self._team, self._threat, self._vectors, [*self._known, *self._dives.sets()])
        self._prices.run(self.task.bracket, self.task.budget)

    def _dive(self, budget: Budget) -> None:
        bracket = self.task.bracket
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
        bracket, team = self.task.bracket, self._team
        return bracket.is_closed or not team.is_planar or len(team.single) > LARGEST or not bracket.upper > 0

    def _offer(self, groups: Iterable[frozenset[int]]) -> bool:
        outcome = tuple(sorted(groups, key=lambda group: min(group, default=0)))
        return self.task.offer(Attack(*realise(self._threat, outcome)))

    def weakest_of_forced_size(self) -> None:
        """Some group has the forced size at least, so the weakest set of that size is a bound."""
        bracket = self.task.bracket
        size = forced_group_size(len(self._team.single), self._threat.n_blinded, self._threat.alpha_c)
        search = WeakestSetSearch(self._team, size, bracket.goal, bracket.lower)
        for found in search.run(self.task.budget):
            if found is not None:
                search.threshold = min(search.threshold, self._team.value(found))
            bracket.raise_lower(min(search.lower, search.threshold))
        bracket.raise_lower(search.threshold)


FORCED: tuple[Stage[FamilySearch], ...] = (
    Stage("forced size", FamilySearch.weakest_of_forced_size, share=FORCED_SHARE),
)
FIRST_TURN: tuple[Stage[FamilySearch], ...] = (
    Stage("annealed families", FamilySearch.anneal_first, FamilySearch.is_limited, ANNEALED_SHARE),
    Stage("dives", FamilySearch.dive, FamilySearch.may_dive, DIVED_SHARE),
    Stage("family prices", FamilySearch.price, FamilySearch.may_dive, PRICED_SHARE),
    Stage("family prices", FamilySearch.price, FamilySearch.is_priced, 1.0),
    Stage("family prices", FamilySearch.price, FamilySearch.is_priced_without_limit, 1.0, PRICED_NODES),
)
LATER_TURNS: tuple[Stage[FamilySearch], ...] = (
    Stage("dives", FamilySearch.dive, FamilySearch.may_dive, LATER_SHARE),
    Stage("annealed families", FamilySearch.anneal_once, FamilySearch.has_dived_in_vain, LATER_SHARE),
    Stage("family prices", FamilySearch.price, FamilySearch.is_priced_later, 1.0),
)
"""Of an attack on a complete graph, without vectors of sizes; the last turn by turn."""
