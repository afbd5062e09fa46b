"""The exact attacker of large teams on a complete graph.

Outcomes are told apart by their group sizes (``graph/survivor_sizes.py``). Exchanges find weak families of groups of
the vectors of sizes. Then thresholds are decided by all vectors (``decision.py``): first whether any attack leaves
less than the one in hand, then lower ones. If there are too many vectors, the weakest set of the forced size is a
bound, and attacks are annealed.
"""

from __future__ import annotations

from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.least_set_search import LeastSetSearch
from ratt_opt.attack.size_vectors.decision import SizeDecision
from ratt_opt.attack.size_vectors.weak_families import WeakFamilies, weakest_of
from ratt_opt.attack.team import Links
from ratt_opt.attack.thresholds.dual_prices import ThresholdDecision
from ratt_opt.attack.thresholds.pricing import PricingProblem
from ratt_opt.attack.thresholds.threshold_search import Threshold, ThresholdSearch
from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import (
    FIRST,
    first_non_dominated_sizes,
    forced_group_size,
    sizes_of_largest,
)
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.attack.size_vectors.weak_families import GroupExchanges
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Stop
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["SizeVectorSearch"]


class SizeVectorSearch:
    """Search by size vectors that closes the task's bracket; relies on a non-decreasing objective.

    ``vectors`` : size vectors to search; those that the budgets allow by default
    """

    def __init__(self, task: AttackTask, team: Team, vectors: list[Sizes] | None = None) -> None:
        self.task, self.team, self.bracket = task, team, task.bracket
        self.threat = task.problem.threat
        n_robots, n_blinded, alpha_c = team.robots, self.threat.n_blinded, self.threat.alpha_c
        self._given = vectors
        allowed = first_non_dominated_sizes(n_robots, n_blinded, alpha_c) if vectors is None else vectors
        most = min(team.params.size_vectors.most_vectors, FIRST - 1)
        self.vectors = list(allowed[: most + 1])
        self.has_all_vectors = len(self.vectors) <= most
        self.weak = WeakFamilies(task, team)
        self.families: list[GroupExchanges] = []
        self._is_about_families = False
        sizes = team.params.size_vectors
        self._plan = plan = PricingProblem(team, Links.of(self.threat), self.threat)
        self._decision = SizeDecision(team, self.threat, self.vectors)
        self._sizes = ThresholdSearch(
            task, plan, self._decision, (sizes.effort, sizes.last_effort), anneals=vectors is None
        )

    @property
    def is_about_families(self) -> bool:
        """Several groups are about alike, and there is a limit of time."""
        return self._is_about_families and self.has_all_vectors

    @property
    def has_small_groups(self) -> bool:
        """No group need have more than an eighth of the team, and nobody is blinded."""
        smallest = min(sizes[0] for sizes in self.vectors)
        return self.team.params.size_vectors.small * smallest <= self.team.robots and not self.threat.n_blinded

    def blind_everyone(self) -> None:
        """Blind every robot: none is left to sense."""
        self._accept((frozenset(),))
        self.bracket.lower = self.bracket.upper

    def exchange(self) -> None:
        """The weakest families that exchanges find, of each vector or of some."""
        self.families = self.weak.exchanged(self.vectors if self.has_all_vectors else self._some_vectors())
        self._accept(weakest_of(self.families))
        self._is_about_families = self._are_alike(self.families)

    def weakest_of_forced_size(self) -> None:
        """Some group has the forced size at least, so the weakest set of that size is a bound."""
        size = forced_group_size(self.team.robots, self.threat.n_blinded, self.threat.alpha_c)
        search = LeastSetSearch(self.team, size, self.bracket.goal, self.bracket.lower)
        for found in search.run(self.task.budget):
            if found is not None:
                search.threshold = min(search.threshold, self.team.value(found))
            self.bracket.raise_lower(min(search.lower, search.threshold))
        self.bracket.raise_lower(search.threshold)

    def test_attack(self) -> None:
        """Test by size vectors whether any attack leaves less than the one in hand."""
        while not self.bracket.is_closed:
            try:
                answer = self._decision.decide(
                    self.bracket.goal, self.task.budget, self.team.params.size_vectors.first_effort
                )
            finally:
                self.bracket.raise_lower(self._decision.least)
            if answer.verdict is Threshold.REFUTED:
                self.bracket.raise_lower(self.bracket.goal)
            elif answer.partition is None or not self.task.offer(answer.partition.attack(self.threat)):
                return

    def thresholds(self) -> Stop:
        """Thresholds by vectors of sizes, and annealed attacks."""
        self._sizes.task = self.task
        return self._sizes.run()

    @cached_property
    def _prices(self) -> ThresholdSearch:
        """Search by dual prices, made on first use: half a second for a thousand robots."""
        return ThresholdSearch(self.task, self._plan, ThresholdDecision(self._plan))

    def dual_prices(self) -> None:
        """Dual prices of robots and links, by thresholds."""
        self._prices.task = self.task
        self._prices.run()

    def anneal(self) -> None:
        """Annealed attacks, which change sizes and robots together."""
        self._sizes.task = self.task
        self._sizes.anneal(self.team.params.size_vectors.starts)

    def _are_alike(self, families: list[GroupExchanges]) -> bool:
        """Test whether an attack leaves groups of about equal value while a limit of time is to be shared."""
        budget = self.task.budget
        if self._given is not None or budget.max_nodes is not None or not np.isfinite(budget.seconds_left):
            return False
        second, best = sorted([0.0, *map(self.team.value, weakest_of(families))])[-2:]
        return second >= self.team.params.size_vectors.alike * best

    def _some_vectors(self) -> list[Sizes]:
        """A few vectors of each size of the largest group, the smallest sizes first."""
        n_robots, budgets = self.team.robots, (self.threat.n_blinded, self.threat.alpha_c)
        vectors: list[Sizes] = []
        for first in range(forced_group_size(n_robots, *budgets), n_robots - budgets[0] + 1):
            vectors.extend(
                islice(sizes_of_largest(n_robots, *budgets, first), self.team.params.size_vectors.of_each_size)
            )
            if len(vectors) >= self.team.params.size_vectors.some_vectors:
                break
        return vectors

    def _accept(self, groups: Iterable[frozenset[int]]) -> bool:
        outcome = tuple(sorted(groups, key=lambda group: min(group, default=0)))
        return self.task.offer(Attack(*realise(self.threat, outcome)))
