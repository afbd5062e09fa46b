"""Resilient selection over a matroid: the best single elements as bait, then greedy without them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.planners.greedy_sets import Selection
from ratt_opt.problem import Plan, Problem, check_problem

if TYPE_CHECKING:
    from ratt_opt.budget import Budget

__all__ = ["resilient_selection"]


def resilient_selection(problem: Problem, *, budget: Budget | None = None) -> Plan:
    """Plan against ``alpha_s`` lost robots by resilient selection over the matroid of one element per robot.

    Go through the elements from the largest individual value down, and take each whose robot has none yet until
    ``alpha_s`` are taken (``bait``). Choose the others greedily, as if the bait were not there. Links are ignored.

    Guarantee, for ``alpha_c = 0``, a non-decreasing function with f(empty) = 0, N robots and alpha = ``alpha_s`` < N:
    the worst case is at least ``max(1 - k, 1/(1 + alpha), 1/(N - alpha)) / (1 + k)`` of the optimum for a submodular
    function of curvature k, and ``(1 - c)^3`` of it for total curvature c.

    Source: Tzoumas, Jadbabaie, Pappas, Resilient non-submodular maximization over matroid constraints,
    arXiv 1804.01013 (2018), Algorithm 1 and Theorem 1. Read here: the abstract (any number of losses, curvature). Taken
    on trust: the lines of the algorithm and the shares; tests compare the first share with all plans.
    """
    selection = Selection.of(check_problem(problem, knows_at_most=True), budget)
    single = problem.objective.singletons()
    selection.evaluations += len(single)
    for element in np.lexsort((problem.robot, -single)):  # of equals the lowest robot, then the lowest element
        if len(selection.chosen) >= min(problem.alpha_s, selection.most):
            break
        if selection.open[element] and problem.robot[element] not in problem.robot[selection.chosen]:
            selection.chosen.append(int(element))
    bait = tuple(int(i) for i in problem.robot[selection.chosen])
    selection.grow(selection.most)
    return selection.plan(problem, bait)
