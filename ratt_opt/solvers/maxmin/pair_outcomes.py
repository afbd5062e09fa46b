"""Outcomes that leave two robots together and every other one alone, used to narrow nodes of the search.

Such an outcome bounds all plans by the value of one pair where the lone robots are weak whatever they do. There is
one for every pair, and together they decide most such problems without any linear program
(:mod:`ratt_opt.solvers.maxmin.pair_values`); every step enters the search tree as a division closed by tangent cuts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import non_dominated_sizes
from ratt_opt.problem import Attack
from ratt_opt.solvers.maxmin.pair_values import PairValues
from ratt_opt.solvers.maxmin.search_tree import divide, representatives, with_choice

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.search_tree import Classes, TreeNode
    from ratt_opt.solvers.maxmin.winners import Winners

__all__ = ["PairOutcomes"]


class PairOutcomes:
    """The outcomes of one problem and the values of its pairs; :meth:`of` says whether there are any."""

    def __init__(self, problem: Problem, objective: InformationObjective, classes: Classes, alone: int) -> None:
        self.problem, self.classes, self.alone = problem, classes, alone
        self.values = PairValues(objective, representatives(classes))
        single = objective.singletons()
        strongest = [single[choice].max() for choice in problem.choices]
        self._weakest_first = np.argsort(strongest, kind="stable").tolist()

    @classmethod
    def of(cls, problem: Problem, objective: InformationObjective, classes: Classes) -> PairOutcomes | None:
        """``None`` where no attack leaves just one pair, robots differ to the adversary, or pairs are too many."""
        threat = problem.threat
        if not threat.is_symmetric or not PairValues.affordable(objective, representatives(classes)):
            return None
        alone = problem.n_robots - threat.n_blinded - 2
        if alone < 0 or (2, *[1] * alone) not in non_dominated_sizes(
            problem.n_robots, threat.n_blinded, threat.alpha_c
        ):
            return None
        return cls(problem, objective, classes, alone)

    def strongest_plan(self) -> IntArray:
        """(N,) a plan whose weakest pair is as strong as is found."""
        return self.values.strongest_plan()

    def narrow(self, node: TreeNode, level: float, winners: Winners, pool: OutcomePool) -> TreeNode | None:
        """Split off elements that are below ``level`` in some pair; return what remains, ``None`` if nothing does."""
        for step in self.values.eliminations(node.choices, level):
            outcome = pool.add(self._attack(step.robot, step.because))
            choice = node.choices[step.robot]
            left = np.setdiff1d(choice, step.elements)
            if not len(left):
                return None if winners.close_by(node, outcome) else node
            weak = node.child(with_choice(node.choices, step.robot, np.setdiff1d(choice, left)))
            if len(left) < len(choice) and winners.close_by(weak, outcome):
                rest = node.child(with_choice(node.choices, step.robot, left))
                divide(node, step.robot, [weak, rest], self.classes)
                node = rest
        return node

    def _attack(self, robot: int, other: int) -> Attack:
        """The attack that leaves two robots together, and alone those of the others that are weakest at best."""
        pair = frozenset((robot, other))
        alone = [i for i in self._weakest_first if i not in pair][: self.alone]
        outcome = sorted((pair, *(frozenset((i,)) for i in alone)), key=min)
        return Attack(*realise(self.problem.threat, tuple(outcome)))
