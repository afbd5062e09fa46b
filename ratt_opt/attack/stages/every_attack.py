"""Stages: every attack, if these are few."""

from __future__ import annotations

from math import comb
from typing import TYPE_CHECKING

from ratt_opt.attack.enumeration import enumerate_by_values
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.graph.few_cuts import MOST_ATTACKS, attacks_are_few

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.budget import Stop

__all__ = ["EveryAttackStage", "EveryValuedAttackStage"]


class EveryAttackStage(Stage[AttackState]):
    """Stage that tries every attack on a criterion: sparse networks and few cuts close by it with no gap at all."""

    name = "every attack"

    def applies(self, attack: AttackState) -> bool:
        """Links not all alike; at most 20,000 attacks, or more than 24 robots and as many as soon are tried."""
        if attack.threat.links_alike or attacks_are_few(attack.threat):
            return not attack.threat.links_alike
        return not (attack.has_table or attack.is_brief) and attack.enumeration.is_soon(attack.task.budget)

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for other stages."""
        return Share(part=params.stages.every_attack)

    def run(self, attack: AttackState) -> Stop:
        """Every attack, valued in batches."""
        return attack.enumeration.run(attack.task.budget)


class EveryValuedAttackStage(Stage[AttackState]):
    """Stage that tries every attack on any set function."""

    name = "every attack"

    def applies(self, attack: AttackState) -> bool:
        """More than 20 robots, at most 20,000 attacks; or no link attacks, fewer blinded sets than half a table."""
        n_robots, threat = attack.n_robots, attack.threat
        if threat.n_cut == 0:
            free = n_robots - len(threat.protected_robots)
            blinded = sum(comb(free, k) for k in range(threat.n_blinded + 1))
            return bool(blinded <= min(MOST_ATTACKS, 2 ** (n_robots - 1)))
        return n_robots > attack.task.params.all_sets.valued and not threat.links_alike and attacks_are_few(threat)

    def run(self, attack: AttackState) -> Stop:
        """Every attack, valued one by one."""
        return enumerate_by_values(attack.task)
