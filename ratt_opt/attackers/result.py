"""What every attacker returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt.problem import Attack
    from ratt_opt.stopping import Stop

__all__ = ["AttackResult"]


@dataclass(frozen=True, slots=True, kw_only=True)
class AttackResult:
    """Claim: ``lower <= min over attacks of the team value <= upper`` [unit of the objective].

    ``attack`` attains ``upper``. ``lower`` is proved in floating point when ``stop`` is
    ``EXHAUSTED`` or ``CLOSED``; it is 0 (the value of no measurement) for a heuristic.
    Results are equal when all their fields are.
    """

    attack: Attack
    lower: float
    upper: float
    stop: Stop
    evaluations: int
    nodes: int = 0

    def __repr__(self) -> str:
        attack = f"{len(self.attack.sensing)} robots blinded, {len(self.attack.links)} links cut"
        cost = f"{self.evaluations} evaluations, {self.nodes} nodes"
        return f"AttackResult([{self.lower:.6g}, {self.upper:.6g}], {attack}, {self.stop.value}, {cost})"
