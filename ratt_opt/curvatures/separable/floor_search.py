"""How small one element's marginal can be where nothing is known but a floor that holds for every context."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.curvatures.separable.best_context import BestContext
    from ratt_opt.setfunctions.minorants import Choices

__all__ = ["FloorSearch"]


class FloorSearch:
    """Claim: ``lower <= smallest marginal of x over contexts <= attained.value``; nothing is left to refine.

    Parameters
    ----------
    single : (n,) values alone; the descent starts from the most valuable element of every other owner
    """

    exhausted = True
    nodes = 1

    def __init__(
        self, attained: BestContext, others: Choices, single: FloatArray, floor: float, budget: Budget
    ) -> None:
        own = np.split(others.elements, others.first[1:])
        best = [int(part[single[part].argmax()]) for part in own if len(part)]
        self.attained = attained
        self.attained.offer(np.array(best, dtype=np.int64))
        self.attained.descend(budget)
        self.lower = min(floor, self.attained.value)

    def refine(self) -> None:
        """Nothing is left to refine."""
