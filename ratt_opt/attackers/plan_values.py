"""The objective as a set function of robots, once a plan is fixed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.base import SetFunction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem

__all__ = ["PlanValues"]

LARGEST_CHUNK = 4096
"""Sets evaluated at once: a table of 2**20 sets as one batch would take gigabytes of matrices."""


class PlanValues(SetFunction):
    """``phi`` of the elements that a set of robots has in one plan; counts what it was asked.

    ``problem`` : N robots, E elements; ``elements`` : (N,) element chosen for each robot

    Raises ``InputError`` : an element is not its robot's, or ``elements`` has the wrong shape.
    """

    __slots__ = ("evaluations", "objective", "plan")

    def __init__(self, problem: Problem, elements: ArrayLike) -> None:
        self.plan: IntArray = problem.check_plan(elements)
        self.objective: SetFunction = problem.objective
        self.evaluations = 0

    @property
    def n(self) -> int:
        """Number of robots N."""
        return len(self.plan)

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the sets of robots in the rows of ``membership`` (K, N)."""
        self.evaluations += len(membership)
        values = np.empty(len(membership))
        for start in range(0, len(membership), LARGEST_CHUNK):
            rows = membership[start : start + LARGEST_CHUNK]
            selected = np.zeros((len(rows), self.objective.n), dtype=np.bool_)
            selected[:, self.plan] = rows
            values[start : start + len(rows)] = self.objective.evaluate(selected)
        return values
