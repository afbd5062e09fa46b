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
    """

    attack: Attack
    lower: float
    upper: float
    stop: Stop
    evaluations: int
    nodes: int = 0
