"""Stages: thresholds over all sets of robots."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.bounds import first_bound
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Stage, go_on
from ratt_opt.attack.thresholds.all_sets import AllSets
from ratt_opt.budget import OutOfBudget

if TYPE_CHECKING:
    from ratt_opt.budget import Stop

__all__ = ["ThresholdsOfFewStage", "ThresholdsStage"]


class ThresholdsStage(Stage[AttackState]):
    """Stage that decides thresholds over all sets of robots."""

    name = "thresholds"

    def applies(self, attack: AttackState) -> bool:
        """Team of at most 20 robots, and values left for all sets; planar targets: at most 24 robots."""
        return attack.has_table

    def run(self, attack: AttackState) -> Stop:
        """All sets of robots, thresholds one after the other."""
        begun = attack.task.memory.search
        return go_on(attack.task, begun if isinstance(begun, AllSets) else AllSets(attack.task))


class ThresholdsOfFewStage(ThresholdsStage):
    """Stage for teams so small that nothing else need be tried."""

    def applies(self, attack: AttackState) -> bool:
        """Team of at most 12 robots."""
        return attack.n_robots <= attack.task.params.criterion.small

    def run(self, attack: AttackState) -> Stop:
        """Values of all sets, thresholds one after the other; without all values, what single robots prove."""
        try:
            return super().run(attack)
        except (OutOfBudget, KeyboardInterrupt):
            task = attack.task
            task.bracket.raise_lower(first_bound(attack.objective, task.values.plan, attack.threat))
            raise
