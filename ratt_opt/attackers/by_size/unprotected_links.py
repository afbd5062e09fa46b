"""Complete graphs with protected links: what the attacker could do if those could be cut too."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ratt_opt.attackers.bracket import Bracket
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt.attackers.bracket import Budget
    from ratt_opt.attackers.plan_values import PlanValues
    from ratt_opt.attackers.weakest_set.compact import CompactTeam
    from ratt_opt.problem import Problem

__all__ = ["unprotected_bound"]


def unprotected_bound(
    problem: Problem, team: CompactTeam, values: PlanValues, bracket: Bracket, budget: Budget
) -> None:
    """Raise the lower bound to the worst case without protected links, which is no larger; keep its attack if allowed.

    Relies on a non-decreasing objective. What is proved when the budget runs out is kept.
    """
    from ratt_opt.attackers.by_size.large_team import LargeTeamSearch  # compiles

    relaxed = replace(problem, protected_links=frozenset())
    start = Bracket(Attack(), relaxed.team_value(values.plan, Attack()), bracket.lower)
    start.offer(bracket.attack, bracket.upper)
    try:
        LargeTeamSearch(relaxed, team, values, start, budget).run()
    finally:
        bracket.raise_lower(min(start.lower, start.upper))
        if not start.attack.links & problem.protected_links:
            bracket.offer(start.attack, problem.team_value(values.plan, start.attack))
