"""Resource-aware greedy (RAG): robots that hear their neighbours alone choose in parallel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.planners.greedy_sets import Selection
from ratt_opt.problem import Plan, Problem, check_problem

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["ResourceAwarePlan", "resource_aware_greedy"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ResourceAwarePlan(Plan):
    """A plan made by neighbours' messages; ``rounds`` : how often each undecided robot told its best gain."""

    rounds: int


def resource_aware_greedy(problem: Problem, *, budget: Budget | None = None) -> ResourceAwarePlan:
    """Let each robot choose beside what its neighbours in the communication graph have chosen.

    In a round every undecided robot finds its best marginal gain beside the choices of its decided neighbours. Those
    whose gain is the largest among their undecided neighbours choose (of equals the one of the lowest number). It
    ignores attacks. On a complete graph the choices are greedy's.

    Guarantee, without an attack, for a submodular non-decreasing function f of curvature k:
    ``f(plan) >= (f(best) - k * sum over robots of coin) / (1 + k)``. Coin, the value of centralized information, is
    ``f(a) - f(a | choices of all robots that are no neighbours)`` for the robot's choice a.

    Source: Xu, Garimella, Tzoumas, Communication- and computation-efficient distributed submodular optimization in
    robot mesh networks, arXiv 2407.10382, Algorithm 1 and Theorem 1. Read here: the abstract (decisions by what
    neighbours tell, time linear in N). Taken on trust: the theorem, which tests compare with all plans.
    """
    selection = Selection.of(check_problem(problem), budget)
    picked: dict[int, int] = {}
    undecided, rounds = set(range(problem.n_robots)), 0
    while undecided and not selection.budget.is_over:
        rounds += 1
        try:
            offers = {i: _offer(selection, problem, i, picked) for i in sorted(undecided)}
        except OutOfBudget:  # of the values of the function
            break
        leading = [i for i in offers if _leads(i, offers, _heard(problem, i, offers))]
        picked |= {i: offers[i][0] for i in leading}
        undecided -= set(leading)
    selection.chosen = list(picked.values())
    plan = selection.plan(problem)
    return ResourceAwarePlan(elements=plan.elements, evaluations=plan.evaluations, rounds=rounds)


def _heard(problem: Problem, robot: int, others: Iterable[int]) -> list[int]:
    """Neighbours of the robot among the others."""
    return [j for j in others if j != robot and (problem.graph is None or problem.graph.has_edge(robot, j))]


def _offer(selection: Selection, problem: Problem, robot: int, picked: dict[int, int]) -> tuple[int, float]:
    """The element of a robot with the largest marginal gain beside its neighbours' choices, and that gain."""
    base = [picked[j] for j in _heard(problem, robot, picked)]
    pick, value = selection.best(base, np.asarray(problem.choices[robot]))
    return pick, value - problem.objective(base)


def _leads(robot: int, offers: dict[int, tuple[int, float]], neighbours: Iterable[int]) -> bool:
    own = (offers[robot][1], -robot)
    return all(own > (offers[j][1], -j) for j in neighbours)
