"""Stages: attacks annealed by values alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.attack.value_annealing import annealed_attacks

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams

__all__ = ["AnnealedOwnCriterionStage", "AnnealedValuesStage"]


class AnnealedValuesStage(Stage[AttackState]):
    """Stage that anneals attacks on any set function."""

    name = "annealed values"

    def applies(self, attack: AttackState) -> bool:
        """A limit, too many sets for a table, no other search asks."""
        return attack.is_limited and not (attack.has_table or attack.is_inner)

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for branch and bound."""
        return Share(part=params.stages.annealed_values)

    def run(self, attack: AttackState) -> None:
        """Attacks annealed by values alone."""
        annealed_attacks(attack.task)


class AnnealedOwnCriterionStage(AnnealedValuesStage):
    """Stage that anneals attacks on a criterion without compiled code."""

    def applies(self, attack: AttackState) -> bool:
        """Criterion of one's own, limit of time."""
        return not attack.has_prices and attack.has_time_limit
