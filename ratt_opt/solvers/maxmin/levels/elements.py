"""The elements that plans need, and all that each of them stands for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.solvers.undominated import dominators, undominated

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.undominated import UndominatedProblem

__all__ = ["Elements"]


class Elements:
    """``problem`` : over the undominated elements; ``members`` : the elements of the whole one that each dominates."""

    def __init__(self, whole: Problem) -> None:
        self.whole = whole
        self.problem: UndominatedProblem = undominated(whole)
        owner = dominators(whole, self.problem.kept)
        stands_for: list[list[int]] = [[] for _ in self.problem.kept]
        for e, k in enumerate(owner.tolist()):
            stands_for[k].append(e)
        self.stands_for = tuple(map(tuple, stands_for))

    def members(self, elements: IntArray) -> tuple[int, ...]:
        """All elements of the whole problem that these stand for."""
        return tuple(sorted(e for k in elements.tolist() for e in self.stands_for[k]))
