"""Stage: the smallest largest group, if all robots are alike."""

from __future__ import annotations

import numpy as np

from ratt_opt.attack.edge_cuts.smallest import largest_group_of
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Stage
from ratt_opt.problem import Attack

__all__ = ["CountedRobotsStage"]


class CountedRobotsStage(Stage[AttackState]):
    """Stage for robots that are all alike."""

    name = "smallest largest group"

    def applies(self, attack: AttackState) -> bool:
        """No robot to blind, all robots alike: a group is worth what their number says."""
        return attack.threat.n_blinded == 0 and attack.task.problem.objective.are_alike(attack.task.values.plan)

    def run(self, attack: AttackState) -> None:
        """The smallest largest group, by prices of fewest cuts."""
        task = attack.task
        most = task.params.criterion.inner_nodes if attack.is_brief else None
        with task.budget.stage(max_nodes=most) as part:
            found = largest_group_of(attack.threat, part)
            task.offer(Attack(links=found.cut))
            fewest = np.arange(task.values.n) < found.lower
            task.bracket.raise_lower(float(task.values.evaluate(fewest[None])[0]))
