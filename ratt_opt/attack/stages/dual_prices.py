"""Stages: annealed attacks, and dual prices of robots and links."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Stage, go_on

if TYPE_CHECKING:
    from ratt_opt.budget import Stop

__all__ = ["AnnealedAttacksStage", "DualPricesStage"]


class AnnealedAttacksStage(Stage[AttackState]):
    """Stage that anneals attacks on a compiled criterion."""

    name = "annealed attacks"

    def applies(self, attack: AttackState) -> bool:
        """Criterion compiled, budget left."""
        return attack.has_prices

    def run(self, attack: AttackState) -> None:
        """Annealed attacks, and patience for more."""
        search, params = attack.search_by_prices, attack.task.params.criterion
        assert search is not None
        search.task = attack.task
        starts = int(params.starts * max(attack.n_robots / params.starts_for, 1.0) ** 2)
        search.anneal(params.inner_starts if attack.is_brief else starts)
        attack.is_annealed = True


class DualPricesStage(Stage[AttackState]):
    """Stage that decides thresholds by dual prices and pricing."""

    name = "dual prices"

    def applies(self, attack: AttackState) -> bool:
        """Criterion compiled, budget left."""
        return attack.has_prices

    def run(self, attack: AttackState) -> Stop:
        """Dual prices of robots and links, by thresholds."""
        assert attack.search_by_prices is not None
        return go_on(attack.task, attack.search_by_prices)
