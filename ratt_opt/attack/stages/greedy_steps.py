"""Stage: greedy steps, if nothing compiled finds attacks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.heuristics import greedy_attack
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.attack.team import has_native_kernel

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams

__all__ = ["GreedyStepsStage"]


class GreedyStepsStage(Stage[AttackState]):
    """Stage that lowers the upper end by greedy steps."""

    name = "greedy steps"

    def applies(self, attack: AttackState) -> bool:
        """Function or criterion of one's own; more than 20 robots, or a limit."""
        is_compiled = has_native_kernel(attack.task.problem.objective)
        return not is_compiled and (attack.n_robots > attack.task.params.all_sets.valued or attack.is_limited)

    def share(self, params: AttackParams) -> Share:
        """Return a small part."""
        return Share(part=params.stages.greedy)

    def run(self, attack: AttackState) -> None:
        """Greedy steps."""
        task = attack.task
        task.offer(greedy_attack(task.problem, task.values.plan, budget=task.budget).attack)
