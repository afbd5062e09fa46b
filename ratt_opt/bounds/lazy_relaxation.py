"""The concave relaxation over *all* attacks of a small team: those that matter enter one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.relaxation import relaxation_bound, uniform_selection
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import non_dominated_outcomes, realise
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import FloatArray
    from ratt_opt.bounds.relaxation import RelaxationBound
    from ratt_opt.problem import Problem

__all__ = ["relaxation_bounds"]

MOST_OUTCOMES = 20_000
"""Every outcome is evaluated in every round."""


def relaxation_bounds(problem: Problem, *, tolerance: float = 1e-7) -> Iterator[RelaxationBound]:
    """Yield bounds on the optimum as the attack that hurts the relaxed plan most enters, round by round.

    Ends once no attack leaves the relaxed plan less than the program claims, up to ``tolerance`` relative to
    the claim: the last item then is the bound of the relaxation over all attacks. Every item is a valid bound.

    Raises
    ------
    InputError : the objective is no information criterion, or the team is too large to list its outcomes.
    """
    objective = problem.objective
    if not isinstance(objective, InformationObjective):
        raise InputError("objective", "must be an information criterion for the relaxation", type(objective).__name__)
    outcomes = []
    for outcome in non_dominated_outcomes(problem.threat):
        outcomes.append(outcome)
        if len(outcomes) > MOST_OUTCOMES:
            rule = f"must leave at most {MOST_OUTCOMES} outcomes to go through (use solve_maxmin)"
            raise InputError("problem", rule, f"{problem.n_robots} robots")
    rows = np.array([_mask(group, problem.n_robots) for outcome in outcomes for group in outcome])
    starts = np.cumsum([0, *(len(outcome) for outcome in outcomes[:-1])])
    entered: list[int] = []
    selection, level = uniform_selection(problem), np.inf
    while True:
        left = np.maximum.reduceat(_group_values(problem, objective, rows, selection), starts)
        worst = int(left.argmin())
        if worst in entered or left[worst] >= level - tolerance * abs(level):
            return
        entered.append(worst)
        bound = relaxation_bound(problem, [Attack(*realise(problem.threat, outcomes[k])) for k in entered])
        yield bound
        selection, level = bound.selection, bound.claimed


def _group_values(
    problem: Problem, objective: InformationObjective, rows: FloatArray, selection: FloatArray
) -> FloatArray:
    """(G,) values of the groups, whose robots are the ones in ``rows`` (G, N), under a relaxed selection."""
    of_robot = np.zeros((problem.n_robots, objective.prior.size))
    np.add.at(of_robot, problem.robot, selection[:, None] * objective.information.reshape(objective.n, -1))
    points = (rows @ of_robot).reshape(-1, *objective.prior.shape) + objective.prior_information
    return objective.value(points)


def _mask(group: frozenset[int], n_robots: int) -> FloatArray:
    """(N,) 1 for the robots of a group."""
    mask = np.zeros(n_robots)
    mask[list(group)] = 1.0
    return mask
