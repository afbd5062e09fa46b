"""Lower bounds from attackers that may do more: every worst case is that of some complete graph, or above it.

Relies on a non-decreasing objective. What is proved when the budget runs out is kept.
"""

from __future__ import annotations

from dataclasses import replace
from math import comb
from typing import TYPE_CHECKING

from ratt_opt.attackers.by_size.largest_groups import largest_groups_bound, weak_sets
from ratt_opt.attackers.by_size.size_vector_search import SizeVectorSearch
from ratt_opt.attackers.task import AttackBracket
from ratt_opt.graph.link_scores import link_scores
from ratt_opt.graph.possible_sizes import PossibleSizes
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.attackers.by_size.largest_groups import WeakSets
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.graph.survivor_sizes import Sizes
    from ratt_opt.problem import Problem

__all__ = ["PossibleGroups", "unprotected_bound"]

MOST_POSSIBLE = 1_000
"""Vectors of sizes to search: 10 at dense graphs, hundreds at 50 robots of sparser ones."""

LARGEST = 100
"""Robots of which sizes are looked at: some twenty seconds without a limit."""


def unprotected_bound(task: AttackTask, team: PackedTeam) -> None:
    """Raise the lower bound to the worst case without protected links, no larger; keep its attack if allowed."""
    problem, bracket = task.problem, task.bracket
    relaxed = replace(problem, protected_links=frozenset())
    start = AttackBracket(Attack(), relaxed.team_value(task.values.plan, Attack()), bracket.lower, bracket.rounding)
    start.offer(bracket.attack, bracket.upper)
    try:
        _search(task, team, relaxed, start)
    finally:
        if not start.attack.links & problem.protected_links:
            task.offer(start.attack)


class PossibleGroups:
    """Lower bounds from the sizes that groups of an attack may have, with any robots in them.

    ``least`` : seeing robots that are known to be left in some group, by sizes too
    """

    def __init__(self, team: PackedTeam | None, least: int) -> None:
        self._team, self.least = team, least
        self._possible: PossibleSizes | None = None
        self._sets: WeakSets | None = None

    @staticmethod
    def apply(task: AttackTask) -> bool:
        """Whether sizes are looked at in a team that large."""
        threat = task.problem.threat
        return threat.n_blinded < threat.graph.n_robots <= LARGEST

    @property
    def has_sets(self) -> bool:
        """Whether every weak set of these sizes is listed."""
        return self._sets is not None

    def bound(self, task: AttackTask, *, lists_sets: bool = True) -> None:
        """Raise the lower end to the least that groups of possible sizes leave.

        ``lists_sets`` : also list the weak sets to :meth:`ask` about, if they are few

        Raises
        ------
        OutOfBudget : the time is up, or no node is left to begin with; the bracket keeps what was proved.
        """
        threat, budget = task.problem.threat, task.budget
        possible = PossibleSizes(link_scores(threat.graph, threat.alpha_c, budget), threat.n_blinded, self.least)
        self.least = possible.forced
        vectors = possible.vectors(budget, MOST_POSSIBLE)
        if vectors is None:
            return
        self.least = vectors[0][0]
        if self._team is not None:
            _sizes_bound(task, self._team, vectors)
            if lists_sets:
                self._possible, self._sets = possible, weak_sets(task, self._team, possible)

    def ask(self, task: AttackTask) -> None:
        """Raise the lower end by asking of each weak set whether an attack can leave it."""
        assert self._possible is not None
        assert self._sets is not None
        largest_groups_bound(task, self._possible, self._sets)


def _sizes_bound(task: AttackTask, team: PackedTeam, vectors: list[Sizes]) -> None:
    """The same for these ``vectors``: every attack leaves groups of seeing robots of such sizes, or mergers of them."""
    problem, bracket = task.problem, task.bracket
    every_link = comb(problem.n_robots, 2)
    relaxed = replace(problem, graph=None, alpha_c=every_link, protected_links=frozenset())
    start = AttackBracket(bracket.attack, bracket.upper, bracket.lower, bracket.rounding)
    _search(task, team, relaxed, start, vectors)


def _search(
    task: AttackTask, team: PackedTeam, relaxed: Problem, start: AttackBracket, vectors: list[Sizes] | None = None
) -> None:
    """Attack the relaxed problem from the bracket ``start``; what that proves bounds the task's, however it ends."""
    try:
        SizeVectorSearch(replace(task, problem=relaxed, bracket=start, records=[]), team, vectors).run()
    finally:
        task.bracket.raise_lower(min(start.lower, start.upper))
