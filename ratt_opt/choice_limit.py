"""Limit on how many robots choose an element that is not their idle one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["ChoiceLimit"]


@dataclass(frozen=True, slots=True, eq=False)
class ChoiceLimit:
    """Limit ``most`` on busy robots: those that choose another element than their idle one. ``idle`` : (N,)."""

    most: int
    idle: IntArray

    def busy(self, plan: IntArray) -> BoolArray:
        """(..., N) the busy robots of plans (..., N)."""
        return np.asarray(plan != self.idle)

    def allows(self, plan: IntArray) -> bool:
        """Tell whether a plan (N,) keeps the limit."""
        return int(self.busy(plan).sum()) <= self.most

    def rest(self, plan: IntArray, worth: FloatArray) -> IntArray:
        """(N,) the plan with the busy robots of least ``worth`` (N,) idle until it keeps the limit."""
        busy = np.flatnonzero(self.busy(plan))
        resting = busy[np.argsort(-worth[busy], kind="stable")][self.most :]
        kept = plan.copy()
        kept[resting] = self.idle[resting]
        return kept

    def has_plan(self, choices: Sequence[IntArray]) -> bool:
        """Tell whether some plan within ``choices`` keeps the limit: few robots have to be busy."""
        return sum(int(idle not in choice) for idle, choice in zip(self.idle, choices, strict=True)) <= self.most

    def best_plan(self, amounts: FloatArray, choices: Sequence[IntArray]) -> IntArray | None:
        """(N,) the elements of the largest sum of ``amounts`` (E,) within ``choices``; ``None`` if no plan is there.

        The robots that gain most by being busy are, beside those that have to be.
        """
        best, gain = self.idle.copy(), np.zeros(len(self.idle))
        for i, (idle, choice) in enumerate(zip(self.idle.tolist(), choices, strict=True)):
            others = choice[choice != idle]
            if len(others):
                best[i] = others[amounts[others].argmax()]
                gain[i] = amounts[best[i]] - amounts[idle] if len(others) < len(choice) else np.inf
        order = np.argsort(-gain, kind="stable")
        chosen = order[: self.most][gain[order[: self.most]] > 0]
        if np.isinf(gain).sum() > self.most:
            return None
        plan = self.idle.copy()
        plan[chosen] = best[chosen]
        return plan
