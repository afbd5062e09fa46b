"""Values that a team can have, if every target is worth nearly the same as soon as it is seen: coverage.

If no robot left sees a target, it is worth nothing. Otherwise it is worth at least what its weakest element alone is,
``least`` over all targets, and at most what all its elements are, ``most``. If ``k`` targets are seen, the sum is in
``[k least, k most]``; so is the best of groups, and the least over attacks. If these intervals are apart, an upper end
between two of them falls to the end of the lower one.

Source: rounding of bounds of integer programs (Gomory 1958), for values that are nearly whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.elements import Task

__all__ = ["ValueSpacing"]

MARGIN = 1e-12
"""Relative error of a quotient and a product here; interval ends are moved outward by it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueSpacing:
    """Claim: every value of a plan is in ``[k least, k most]`` for some count ``k`` of targets, 0 < least <= most."""

    least: float
    most: float

    @classmethod
    def of(cls, task: Task, value_errors: int) -> ValueSpacing | None:
        """The spacing of a sum over targets; ``None`` if intervals of all targets meet, or all values are 0.

        ``value_errors`` : evaluation errors by which the value of a target may be off
        """
        objective, error = task.objective, value_errors * task.problem.evaluation_error
        sees = objective.information.any(axis=(-2, -1))
        seen = sees.any(axis=0)
        if not seen.any() or not np.isfinite(error):
            return None
        alone = objective.target_values(objective.prior_information + objective.information)
        everything = objective.target_values(objective.posterior_mixture(np.ones(objective.n)))
        least, most = float(alone[sees].min()) - error, float(everything[seen].max()) + error
        apart = least > 0 and (seen.sum() - 1) * most < seen.sum() * least
        return cls(least=least * (1 - MARGIN), most=most * (1 + MARGIN)) if apart else None

    def below(self, upper: float) -> float:
        """The largest value of a plan that is at most ``upper``, or somewhat more; ``upper`` itself if not finite."""
        if not 0 <= upper < np.inf:
            return upper
        return min(upper, self.count(upper) * self.most * (1 + MARGIN))

    def next_above(self, upper: float) -> float:
        """No value of a plan lies between ``below(upper)`` and this."""
        return (self.count(max(upper, 0.0)) + 1) * self.least * (1 - MARGIN)

    def count(self, upper: float) -> int:
        """No plan of value ``upper`` or less sees more targets (or somewhat more)."""
        return int(np.floor(upper / self.least * (1 + MARGIN)))
