"""Complete graphs with protected links: what the attacker could do if those could be cut too."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ratt_opt.attackers.bracket import AttackBracket
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam

__all__ = ["unprotected_bound"]


def unprotected_bound(task: AttackTask, team: PlanarTeam) -> None:
    """Raise the lower bound to the worst case without protected links, which is no larger; keep its attack if allowed.

    Relies on a non-decreasing objective. What is proved when the budget runs out is kept.
    """
    from ratt_opt.attackers.by_size.size_vector_search import SizeVectorSearch  # compiles

    problem, bracket = task.problem, task.bracket
    relaxed = replace(problem, protected_links=frozenset())
    start = AttackBracket(Attack(), relaxed.team_value(task.values.plan, Attack()), bracket.lower, bracket.rounding)
    start.offer(bracket.attack, bracket.upper)
    try:
        SizeVectorSearch(replace(task, problem=relaxed, bracket=start), team).run()
    finally:
        bracket.raise_lower(min(start.lower, start.upper))
        if not start.attack.links & problem.protected_links:
            task.offer(start.attack)
