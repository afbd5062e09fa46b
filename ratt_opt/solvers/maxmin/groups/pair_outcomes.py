"""Outcomes that leave two robots together and every other one alone, used to narrow nodes of the search.

Such an outcome bounds all plans by the value of one pair where the lone robots are weak whatever they do. There is
one for every pair, and together they decide most such problems without any linear program
(``pair_values.py``); every step enters the search tree as a division closed by tangent cuts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import non_dominated_sizes
from ratt_opt.problem import Attack
from ratt_opt.solvers.maxmin.groups.pair_values import PairValues
from ratt_opt.solvers.maxmin.task import with_choice

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.solvers.maxmin.groups.winner_division import WinnerDivision
    from ratt_opt.solvers.maxmin.task import Task
    from ratt_opt.solvers.maxmin.tree import TreeNode

__all__ = ["PairOutcomes"]


class PairOutcomes:
    """The outcomes of one problem and the values of its pairs; :meth:`of` says whether there are any."""

    def __init__(self, task: Task, alone: int) -> None:
        self.task, self.alone = task, alone
        self.values = PairValues(task.objective, task.choices)
        strongest = [task.singles[choice].max() for choice in task.problem.choices]
        self._weakest_first = np.argsort(strongest, kind="stable").tolist()

    @classmethod
    def of(cls, task: Task) -> PairOutcomes | None:
        """``None`` where no attack leaves just one pair, robots differ to the adversary, or pairs are too many."""
        threat, n_robots = task.problem.threat, task.problem.n_robots
        if not threat.is_symmetric or not PairValues.affordable(task.objective, task.choices):
            return None
        alone = n_robots - threat.n_blinded - 2
        if alone < 0 or (2, *[1] * alone) not in non_dominated_sizes(n_robots, threat.n_blinded, threat.alpha_c):
            return None
        return cls(task, alone)

    def strongest_plan(self) -> IntArray:
        """(N,) a plan whose weakest pair is as strong as is found."""
        return self.values.strongest_plan()

    def narrow(self, node: TreeNode, level: float, division: WinnerDivision) -> TreeNode | None:
        """Split off elements that are below ``level`` in some pair; return what remains, ``None`` if nothing does."""
        for step in self.values.eliminations(node.choices, level):
            outcome = division.pool.add(self._attack(step.robot, step.because))
            choice = node.choices[step.robot]
            left = np.setdiff1d(choice, step.elements)
            if not len(left):
                return None if division.close(node, outcome) else node
            weak = node.child(with_choice(node.choices, step.robot, np.setdiff1d(choice, left)))
            if len(left) < len(choice) and division.close(weak, outcome):
                rest = node.child(with_choice(node.choices, step.robot, left))
                node.divide(step.robot, [weak, rest], self.task)
                node = rest
        return node

    def _attack(self, robot: int, other: int) -> Attack:
        """The attack that leaves two robots together, and alone those of the others that are weakest at best."""
        pair = frozenset((robot, other))
        alone = [i for i in self._weakest_first if i not in pair][: self.alone]
        outcome = sorted((pair, *(frozenset((i,)) for i in alone)), key=min)
        return Attack(*realise(self.task.problem.threat, tuple(outcome)))
