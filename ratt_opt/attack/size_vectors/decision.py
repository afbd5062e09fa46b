"""Decision of a threshold for an attack on a complete graph, by vectors of group sizes.

Some group of an attack is the largest. For each size that it may have, smallest first, all sets below the threshold are
found. If there is none, larger groups have none either. If there are few and the other groups are single robots, the
robots that each of them leaves decide. Otherwise a linear program bounds all families of a vector at once
(``family_search.py``).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.annealing import Partition
from ratt_opt.attack.least_sets.least_set_search import LeastSetSearch
from ratt_opt.attack.size_vectors.disjoint_sets import MOST_ROBOTS
from ratt_opt.attack.size_vectors.family_search import FamilySearch, SetLists
from ratt_opt.attack.thresholds.threshold_search import Answer, Decision, Threshold

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes
    from ratt_opt.graph.threat import Threat

__all__ = ["SizeDecision"]


@dataclass(slots=True)
class _Sets:
    """A search of sets, the ``values`` of those that it found, and whether these were too many to go on."""

    search: LeastSetSearch
    values: dict[frozenset[int], float] = field(default_factory=dict)
    are_many: bool = False

    @property
    def least(self) -> float:
        """No set of the size is worth less."""
        return min(self.search.lower, self.search.threshold, *self.values.values())


class SizeDecision(Decision):
    """Decision of thresholds for one plan."""

    def __init__(self, team: Team, threat: Threat, vectors: Sequence[Sizes]) -> None:
        self._team, self._threat, self._vectors = team, threat, vectors
        self._order = np.argsort(-team.single, kind="stable")
        self._smallest = min((vector[0] for vector in vectors if vector), default=0)
        self._sets: dict[int, _Sets] = {}
        """Searches of sets of each size."""

    @property
    def least(self) -> float:
        """No attack leaves less: some group has at least the smallest size that a largest group may have."""
        return self._sets[self._smallest].least if self._smallest in self._sets else -np.inf

    def decide(self, threshold: float, budget: Budget, nodes: int) -> Answer:
        """Decide one threshold; ``OPEN`` after that many nodes.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        with budget.stage(max_nodes=nodes) as part:
            part.spend()
            return self._decide(threshold, part, nodes)
        return Answer(verdict=Threshold.OPEN)

    def _decide(self, threshold: float, budget: Budget, nodes: int) -> Answer:
        params = self._team.params.largest_groups
        lists, is_open, few = SetLists(self._team, self._order), False, params.few
        if len(self._order) > MOST_ROBOTS:
            few = nodes // params.nodes_of_set
        for size in sorted({vector[0] for vector in self._vectors}):
            sets = self._few_sets(size, threshold, budget, few)
            if sets == []:
                break
            for vector in [vector for vector in self._vectors if vector[0] == size]:
                groups, is_decided = self._alone(sets, vector, threshold)
                if not is_decided and groups is None:
                    groups, is_decided = self._searched(lists, vector, threshold, budget)
                if groups is not None:
                    return Answer(verdict=Threshold.REACHED, partition=self._partition(groups, threshold))
                is_open = is_open or not is_decided
        return Answer(verdict=Threshold.OPEN if is_open else Threshold.REFUTED)

    def _few_sets(self, size: int, threshold: float, budget: Budget, most: int) -> list[frozenset[int]] | None:
        """All sets below the threshold, lowest first; ``None`` if there are more than ``most``.

        A search that was begun with a higher threshold goes on, as far as this one needs, unless it found many sets.
        """
        sets = self._sets.get(size)
        if sets is None or sets.search.threshold < threshold or (sets.are_many and sets.search.threshold > threshold):
            floor = -np.inf if sets is None else sets.least
            sets = self._sets[size] = _Sets(LeastSetSearch(self._team, size, threshold, floor))
        below = {one for one, value in sets.values.items() if value < threshold}
        for one in sets.search.run(budget) if sets.search.lower < threshold and len(below) <= most else ():
            if one is not None:
                value = sets.values[one] = self._team.value(one)
                below |= {one} if value < threshold else set()
            if len(below) > most:
                break
            if sets.search.lower >= threshold:
                break
        sets.are_many = len(below) > most
        return None if sets.are_many else sorted(below, key=sets.values.__getitem__)

    def _alone(
        self, sets: list[frozenset[int]] | None, vector: Sizes, threshold: float
    ) -> tuple[tuple[frozenset[int], ...] | None, bool]:
        """A largest group and all others robots alone; whether there is none for sure if there is none."""
        if sets is None or max(vector[1:], default=1) > 1:
            return None, False
        weak = {i for i in range(len(self._order)) if self._team.single[i] < threshold}
        for largest in sets:
            missing, others = self._must - largest, weak - largest
            if missing <= others and len(missing) <= len(vector) - 1 <= len(others):
                spare = sorted(others - missing)[: len(vector) - 1 - len(missing)]
                return (largest, *(frozenset([i]) for i in (*missing, *spare))), True
        return None, True

    def _searched(
        self, lists: SetLists, vector: Sizes, threshold: float, budget: Budget
    ) -> tuple[tuple[frozenset[int], ...] | None, bool]:
        if len(self._order) > MOST_ROBOTS:
            return None, False
        must = sum(1 << k for k, robot in enumerate(self._order.tolist()) if robot in self._must)
        search = FamilySearch(lists, vector, n_blinded=self._threat.n_blinded, must=must, threshold=threshold)
        return search.run(budget)

    @property
    def _must(self) -> frozenset[int]:
        return self._threat.protected_robots

    def _partition(self, groups: Iterable[frozenset[int]], threshold: float) -> Partition:
        """The blinded robots stand in the largest group, which keeps most links."""
        label = np.zeros(len(self._order), dtype=np.int64)
        blind = np.ones(len(label), dtype=np.bool_)
        for g, group in enumerate(sorted(groups, key=len, reverse=True)):
            label[list(group)], blind[list(group)] = g, False
        return Partition(group=label, blind=blind, value=threshold)
