"""The factors of the paper's bounds, as fractions of polynomials in one minus the curvature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.polynomial import ONE, Polynomial, T, constant

if TYPE_CHECKING:
    from ratt_opt.audit.engine.claim import Linear

__all__ = ["CUBED", "KEPT", "KEPT_OVER_ONE_PLUS_K", "ONE_PLUS_K", "SQUARED", "T2", "T3", "Factor"]

T2, T3 = T**2, T**3
ONE_PLUS_K = constant(2) - T
"""``1 + k`` with ``t = 1 - k``."""


@dataclass(frozen=True, slots=True)
class Factor:
    """``above / below``, with ``below`` positive for every curvature in [0, 1]."""

    above: Polynomial
    below: Polynomial = ONE

    def gap(self, left: Linear, right: Linear) -> Linear:
        """An expression that is at least zero exactly when ``left >= above/below * right``."""
        return left * self.below - right * self.above


KEPT, SQUARED, CUBED = Factor(T), Factor(T2), Factor(T3)
"""One minus the curvature, its square and its cube."""
KEPT_OVER_ONE_PLUS_K = Factor(T, ONE_PLUS_K)
