"""Stage: robots blinded, on submodular functions."""

from __future__ import annotations

from math import comb
from typing import TYPE_CHECKING

from ratt_opt.attack.blinding_tree import BlindingTree
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Stage, go_on
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from ratt_opt.budget import Stop

__all__ = ["BlindedRobotsStage"]


class BlindedRobotsStage(Stage[AttackState]):
    """Stage that bounds sets of sensing robots by sums of diminishing gains."""

    name = "blinded robots"

    def applies(self, attack: AttackState) -> bool:
        """Submodular, non-decreasing function, one group, over 20,000 sets; a limit, or no other search asks."""
        return (attack.is_limited or not attack.is_inner) and _is_one_submodular_group(attack)

    def run(self, attack: AttackState) -> Stop:
        """Branch and bound over sets of blinded robots, by modular minorants."""
        attack.task.budget.check()
        return go_on(attack.task, BlindingTree(attack.task))


def _is_one_submodular_group(attack: AttackState) -> bool:
    problem = attack.task.problem
    one_group = problem.threat.n_cut == 0 and len(problem.communication.groups()) == 1
    f = unmetered(problem.objective)
    if not (one_group and f.is_submodular and f.is_non_decreasing):  # otherwise blinding fewer robots may be worse
        return False
    free = problem.n_robots - len(problem.threat.protected_robots)
    return comb(free, problem.threat.n_blinded) > attack.task.params.stages.blinded_sets
