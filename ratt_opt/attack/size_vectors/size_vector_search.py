"""The exact attacker of large teams on a complete graph: its stages, and what they share.

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
from ratt_opt.attack.staging import Share, Stage, run_stages
from ratt_opt.attack.team import Links
from ratt_opt.attack.thresholds.dual_prices import ThresholdDecision
from ratt_opt.attack.thresholds.pricing import PricingProblem
from ratt_opt.attack.thresholds.threshold_search import Threshold, ThresholdSearch
from ratt_opt.budget import Stop
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

    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.size_vectors.weak_families import GroupExchanges
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.team import Team
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["SIZE_STAGES", "SizeVectorSearch", "search_size_vectors"]


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
        self._is_about_families = False
        sizes = team.params.size_vectors
        self._plan = plan = PricingProblem(team, Links.of(self.threat), self.threat)
        self.decision = SizeDecision(team, self.threat, self.vectors)
        self.thresholds = ThresholdSearch(
            task, plan, self.decision, (sizes.effort, sizes.last_effort), anneals=vectors is None
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

    @cached_property
    def prices(self) -> ThresholdSearch:
        """Search by dual prices, made on first use: half a second for a thousand robots."""
        return ThresholdSearch(self.task, self._plan, ThresholdDecision(self._plan))

    def anneal(self) -> None:
        """Annealed attacks, which change sizes and robots together."""
        self.thresholds.task = self.task
        self.thresholds.anneal(self.team.params.size_vectors.starts)

    def compare(self, families: list[GroupExchanges]) -> None:
        """Note whether an attack leaves groups of about equal value while a limit of time is to be shared."""
        budget = self.task.budget
        if self._given is None and budget.max_nodes is None and np.isfinite(budget.seconds_left):
            second, best = sorted([0.0, *map(self.team.value, weakest_of(families))])[-2:]
            self._is_about_families = second >= self.team.params.size_vectors.alike * best

    def some_vectors(self) -> list[Sizes]:
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

    def accept(self, groups: Iterable[frozenset[int]]) -> None:
        """Offer an attack that leaves these groups of unblinded robots."""
        outcome = tuple(sorted(groups, key=lambda group: min(group, default=0)))
        self.task.offer(Attack(*realise(self.threat, outcome)))


class NobodyLeftStage(Stage[SizeVectorSearch]):
    """Stage for an attacker that may blind all robots."""

    name = "nobody left"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """All robots may be blinded."""
        return attack.vectors == [()]

    def run(self, attack: SizeVectorSearch) -> Stop:
        """Blind every robot: none is left to sense."""
        attack.accept((frozenset(),))
        attack.bracket.lower = attack.bracket.upper
        return Stop.CLOSED


class FamilyExchangesStage(Stage[SizeVectorSearch]):
    """Stage that finds weak families of groups."""

    name = "exchanges of families"

    def run(self, attack: SizeVectorSearch) -> None:
        """The weakest families that exchanges find, of each vector or of some."""
        families = attack.weak.exchanged(attack.vectors if attack.has_all_vectors else attack.some_vectors())
        attack.accept(weakest_of(families))
        attack.compare(families)


class WeakestOfForcedSizeStage(Stage[SizeVectorSearch]):
    """Stage that bounds by the weakest set of the forced size."""

    name = "forced size"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Size vectors too many for a list of all."""
        return not attack.has_all_vectors

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for annealing."""
        return Share(part=params.size_vectors.forced_share)

    def run(self, attack: SizeVectorSearch) -> None:
        """Some group has the forced size at least, so the weakest set of that size is a bound."""
        team, threat, bracket = attack.team, attack.threat, attack.bracket
        size = forced_group_size(team.robots, threat.n_blinded, threat.alpha_c)
        search = LeastSetSearch(team, size, bracket.goal, bracket.lower)
        for bound in search.rising_bounds(attack.task.budget):
            bracket.raise_lower(bound)


class AnnealedOnStage(Stage[SizeVectorSearch]):
    """Stage that anneals until the end."""

    name = "annealed attacks"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Size vectors too many for a list of all."""
        return not attack.has_all_vectors

    def run(self, attack: SizeVectorSearch) -> None:
        """Annealed attacks as long as there is time."""
        attack.anneal()
        while np.isfinite(attack.task.budget.seconds_left):
            attack.anneal()


class AttackInHandStage(Stage[SizeVectorSearch]):
    """Stage that tests the attack in hand before lower thresholds."""

    name = "attack in hand"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """No limit of time."""
        return not np.isfinite(attack.task.budget.seconds_left)

    def run(self, attack: SizeVectorSearch) -> None:
        """Test by size vectors whether any attack leaves less than the one in hand."""
        task, bracket, decision = attack.task, attack.bracket, attack.decision
        while not bracket.is_closed:
            try:
                answer = decision.decide(bracket.goal, task.budget, task.params.size_vectors.first_effort)
            finally:
                bracket.raise_lower(decision.least)
            if answer.verdict is Threshold.REFUTED:
                bracket.raise_lower(bracket.goal)
            elif answer.partition is None or not task.offer(answer.partition.attack(attack.threat)):
                return


class AttackInHandInTimeStage(AttackInHandStage):
    """Stage that tests the attack in hand within a part of the time."""

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Limit of time."""
        return bool(np.isfinite(attack.task.budget.seconds_left))

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for lower thresholds."""
        return Share(part=params.size_vectors.first_share)


class AnnealedAlikeStage(Stage[SizeVectorSearch]):
    """Stage that changes sizes and robots together."""

    name = "annealed attacks"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Several groups about alike, limit of time."""
        return attack.is_about_families

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for thresholds."""
        return Share(part=params.size_vectors.annealed_share)

    def run(self, attack: SizeVectorSearch) -> None:
        """Annealed attacks, which change sizes and robots together."""
        attack.anneal()


class PricesOfSmallGroupsStage(Stage[SizeVectorSearch]):
    """Stage that asks dual prices if all groups may be small."""

    name = "dual prices"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Several groups about alike, none need have more than an eighth of the team, nobody blinded, limit of time."""
        return attack.is_about_families and attack.has_small_groups

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for thresholds."""
        return Share(part=params.size_vectors.prices_share)

    def run(self, attack: SizeVectorSearch) -> None:
        """Dual prices of robots and links, by thresholds."""
        attack.prices.task = attack.task
        attack.prices.run()


class SizeThresholdsStage(Stage[SizeVectorSearch]):
    """Stage that decides thresholds by all vectors."""

    name = "thresholds"

    def run(self, attack: SizeVectorSearch) -> Stop:
        """Thresholds by vectors of sizes, and annealed attacks."""
        attack.thresholds.task = attack.task
        return attack.thresholds.run()


SIZE_STAGES: tuple[Stage[SizeVectorSearch], ...] = (
    NobodyLeftStage(),
    FamilyExchangesStage(),
    WeakestOfForcedSizeStage(),
    AnnealedOnStage(),
    AttackInHandInTimeStage(),
    AttackInHandStage(),
    AnnealedAlikeStage(),
    PricesOfSmallGroupsStage(),
    SizeThresholdsStage(),
)
"""Stages of an attack on a complete graph, by size vectors."""


def search_size_vectors(search: SizeVectorSearch) -> Stop:
    """Search every vector; the bracket is valid whenever this stops."""
    return run_stages(SIZE_STAGES, search) or search.task.budget.stop() or Stop.HEURISTIC
