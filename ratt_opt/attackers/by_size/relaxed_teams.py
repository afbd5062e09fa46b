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
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.graph.survivor_sizes import Sizes
    from ratt_opt.problem import Problem

__all__ = ["possible_sizes_bound", "unprotected_bound"]

SIZES_SHARE, SIZES_NODES = 0.2, 3_000_000
"""Of the seconds left, and of the nodes, at most so many, for groups of possible sizes. Lists of weak sets take most of
them: at 50 robots of a dense graph, 10 blinded and 128 links cut, 2 million nodes and six seconds."""

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


def possible_sizes_bound(task: AttackTask, team: PackedTeam | None, least: int, *, asked: float = 1.0) -> int:
    """Raise the lower bound to the least that groups of possible sizes leave, whichever robots are in them.

    ``least`` : seeing robots that are known to be left in some group; ``asked`` : share of the seconds left to ask of
    each weak set whether an attack can leave it. Returns how many are left, by sizes too.

    Raises
    ------
    OutOfBudget : the time is up, or no node is left to begin with; the bracket keeps what was proved.
    """
    threat, budget = task.problem.threat, task.budget
    n_seeing = threat.graph.n_robots - threat.n_blinded
    if n_seeing == 0 or threat.graph.n_robots > LARGEST or task.bracket.is_closed:
        return least
    sets = None
    with budget.stage(SIZES_SHARE, max_nodes=SIZES_NODES) as part:
        possible = PossibleSizes(link_scores(threat.graph, threat.alpha_c, part), threat.n_blinded, least)
        least = possible.forced
        vectors = possible.vectors(part, MOST_POSSIBLE)
        if vectors is None:
            return least
        least = vectors[0][0]
        if team is not None:
            within = replace(task, budget=part)
            _sizes_bound(within, team, vectors)
            sets = weak_sets(within, team, possible) if asked else None
    if sets is not None:
        with budget.stage(asked, max_nodes=SIZES_NODES) as rest:
            largest_groups_bound(replace(task, budget=rest), possible, sets)
    return least


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
        SizeVectorSearch(replace(task, problem=relaxed, bracket=start), team, vectors).run()
    finally:
        task.bracket.raise_lower(min(start.lower, start.upper))
