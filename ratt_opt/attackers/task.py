"""What every exact attacker is given: one plan to attack, what is known of it, and what may be spent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.attackers.bracket import AttackBracket
    from ratt_opt.attackers.plan_values import PlanValues
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem

__all__ = ["AttackTask"]


@dataclass(frozen=True, slots=True)
class AttackTask:
    """Narrow ``bracket`` for the plan of ``values`` within ``budget``; the bracket holds the answer."""

    problem: Problem
    values: PlanValues
    bracket: AttackBracket
    budget: Budget

    def offer(self, attack: Attack) -> bool:
        """Value an attack and keep it if it is the worst so far; return whether it is."""
        return self.bracket.offer(attack, self.problem.team_value(self.values.plan, attack))

    def offer_split(self, groups: Iterable[Iterable[int]], blinded: Iterable[int]) -> bool:
        """Offer the attack that splits the team into these groups, blinded robots included."""
        return self.offer(Attack(frozenset(blinded), self.problem.communication.links_between(groups)))
