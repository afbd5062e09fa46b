"""The greedy loop that published planners share, over elements of which each owner may have one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.problem import Plan

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["Selection"]


@dataclass(slots=True)
class Selection:
    """Elements chosen so far, at most one of each owner.

    ``owner`` : (E,) owner of each element; ``open`` : (E,) elements that may be chosen; ``most`` : how many;
    ``chosen`` : in the order of choice; ``evaluations`` : values asked for
    """

    f: SetFunction
    owner: IntArray
    open: BoolArray
    most: int
    budget: Budget = field(default_factory=Budget)
    chosen: list[int] = field(default_factory=list)
    evaluations: int = 0

    @classmethod
    def of(cls, problem: Problem, budget: Budget | None = None) -> Selection:
        """Return an empty selection for the robots of a problem; if only some may choose, idle elements are closed."""
        is_open = np.ones(problem.objective.n, dtype=np.bool_)
        if problem.at_most is not None:
            is_open[problem.idle] = False
        most = problem.n_robots if problem.at_most is None else problem.at_most
        return cls(problem.objective, problem.robot, is_open, most, budget or Budget())

    @property
    def candidates(self) -> IntArray:
        """Elements of owners that have none yet, ascending."""
        return np.flatnonzero(self.open & ~np.isin(self.owner, self.owner[self.chosen]))

    def best(self, base: list[int], candidates: IntArray) -> tuple[int, float]:
        """The candidate whose set with ``base`` is worth most, the lowest among equals, and that value."""
        values = self.f.extensions(np.array(base, dtype=np.int64), candidates)
        self.evaluations += len(candidates)
        pick = int(np.argmax(values))
        return int(candidates[pick]), float(values[pick])

    def grow(self, count: int, base: list[int] | None = None) -> list[int]:
        """Choose ``count`` further elements greedily, no more than ``most`` in all; return these.

        Their values count beside ``base`` and each other.

        It stops sooner if no owner or no budget is left.
        """
        beside, grown = list(base or ()), list[int]()
        while len(grown) < count and len(self.chosen) < self.most and not self.budget.is_over:
            candidates = self.candidates
            if not len(candidates):
                break
            try:
                pick, _ = self.best(beside, candidates)
            except OutOfBudget:  # of the values of the function
                break
            self.chosen.append(pick)
            beside.append(pick)
            grown.append(pick)
        return grown

    def plan(self, problem: Problem, bait: tuple[int, ...] = ()) -> Plan:
        """The plan of what is chosen; a robot without an element is idle, or gets its first one."""
        first = [choice[0] for choice in problem.choices]
        elements = np.array(first) if problem.at_most is None else problem.idle.copy()
        elements[self.owner[self.chosen]] = self.chosen
        return Plan(elements=readonly(elements), evaluations=self.evaluations, bait=tuple(sorted(bait)))
