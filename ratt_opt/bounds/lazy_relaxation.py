"""The concave relaxation over *all* attacks of a small team: those that matter enter one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.relaxation import relaxation_bound
from ratt_opt.bounds.relaxed_plans import mixed_information, uniform_selection
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import non_dominated_outcomes, realise
from ratt_opt.problem import Attack

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
    objective = problem.information_objective
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
        sums = rows @ mixed_information(problem, selection).reshape(problem.n_robots, -1)
        points = sums.reshape(-1, *objective.prior.shape) + objective.prior_information
        left = np.maximum.reduceat(objective.value(points), starts)
        worst = int(left.argmin())
        if worst in entered or left[worst] >= level - tolerance * abs(level):
            return
        entered.append(worst)
        bound = relaxation_bound(problem, [Attack(*realise(problem.threat, outcomes[k])) for k in entered])
        yield bound
        selection, level = bound.selection, bound.claimed


def _mask(group: frozenset[int], n_robots: int) -> FloatArray:
    """(N,) 1 for the robots of a group."""
    mask = np.zeros(n_robots)
    mask[list(group)] = 1.0
    return mask
