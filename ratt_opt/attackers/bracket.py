"""The state of an exact attacker: a bracket that is valid whenever the search stops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt.problem import Attack

__all__ = ["AttackBracket"]

CLOSED_WIDTH = 1e-10
"""Relative width that counts as closed: attacks that are worse for the team by less are not looked for.

Values computed in different orders differ by some 1e-13; a narrower width would ask for proofs within rounding.
"""


@dataclass(slots=True)
class AttackBracket:
    """``lower <= worst-case value <= upper`` at any moment; ``attack`` attains ``upper``."""

    attack: Attack
    upper: float
    lower: float
    rounding: float = 0.0
    """Values that differ by no more are equal: a relative width alone never closes on a worst case of 0."""

    @property
    def goal(self) -> float:
        """Only a value below this counts as a worse attack; a lower bound that reaches it closes the bracket."""
        return self.upper - max(CLOSED_WIDTH * abs(self.upper), self.rounding)

    @property
    def is_closed(self) -> bool:
        """Whether the bounds meet but for rounding."""
        return self.lower >= self.goal

    def offer(self, attack: Attack, value: float) -> bool:
        """Keep an attack of strictly smaller value; return whether it is one."""
        if better := value < self.upper:
            self.attack, self.upper = attack, float(value)
        return better

    def raise_lower(self, bound: float) -> None:
        """Keep a larger lower bound."""
        self.lower = max(self.lower, float(bound))
