"""Stage: every attack, if these are few."""

from __future__ import annotations

from math import comb
from typing import TYPE_CHECKING

from ratt_opt.attack.enumeration import enumerate_by_values
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams

__all__ = ["EveryAttackStage", "EveryValuedAttackStage"]


class EveryAttackStage(Stage[AttackState]):
    """Stage that tries every attack on a criterion: sparse networks and few cuts close by it with no gap at all."""

    name = "every attack"

    def applies(self, attack: AttackState) -> bool:
        """Links not all alike; at most 20,000 attacks, or 200,000 beyond 24 robots, not brief."""
        few, params = attack.has_table or attack.is_brief, attack.task.params.stages
        most = params.attacks if few else params.attacks_beyond
        return not attack.threat.links_alike and attack.threat.n_attacks <= most

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for other stages."""
        return Share(part=params.stages.every_attack)

    def run(self, attack: AttackState) -> None:
        """Every attack, valued in batches."""
        enumerate_by_values(attack.task)


class EveryValuedAttackStage(EveryAttackStage):
    """Stage that tries every attack on any set function."""

    def applies(self, attack: AttackState) -> bool:
        """More than 20 robots, at most 20,000 attacks; or no link attacks, fewer blinded sets than half a table."""
        n_robots, threat, params = attack.n_robots, attack.threat, attack.task.params
        if threat.n_cut == 0:
            free = n_robots - len(threat.protected_robots)
            blinded = sum(comb(free, k) for k in range(threat.n_blinded + 1))
            return bool(blinded <= min(params.stages.attacks, 2 ** (n_robots - 1)))
        is_large = n_robots > params.all_sets.valued and not threat.links_alike
        return is_large and threat.n_attacks <= params.stages.attacks

    def share(self, params: AttackParams) -> Share:  # noqa: ARG002
        """Return the whole budget."""
        return Share()
