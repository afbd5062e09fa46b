"""Stages: greedy steps, and exchanges after them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.exchanges import exchange_attack
from ratt_opt.attack.heuristics import greedy_attack
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams

__all__ = ["ExchangesStage", "GreedyStepsStage"]


class GreedyStepsStage(Stage[AttackState]):
    """Stage that lowers the upper end by greedy steps."""

    name = "greedy steps"

    def share(self, params: AttackParams) -> Share:
        """Return a small part."""
        return Share(part=params.stages.greedy)

    def run(self, attack: AttackState) -> None:
        """Greedy steps."""
        task = attack.task
        task.offer(greedy_attack(task.problem, task.values.plan, budget=task.budget).attack)


class ExchangesStage(Stage[AttackState]):
    """Stage that lowers the upper end of any set function."""

    name = "greedy steps and exchanges"

    def applies(self, attack: AttackState) -> bool:
        """More than 20 robots, or a limit."""
        return attack.n_robots > attack.task.params.all_sets.valued or attack.is_limited

    def run(self, attack: AttackState) -> None:
        """Greedy steps, then exchanges."""
        exchange_attack(attack.task)
