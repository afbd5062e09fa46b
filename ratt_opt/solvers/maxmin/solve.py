"""Globally optimal max-min plans with a bracket at any time."""

from __future__ import annotations

import math
import time
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import non_dominated_outcomes, realise
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.maxmin.branch_and_bound import BranchAndBound
from ratt_opt.solvers.maxmin.incumbent import PROVED, Incumbent
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.pair_outcomes import PairOutcomes
from ratt_opt.solvers.maxmin.search_tree import equal_elements
from ratt_opt.solvers.result import MaxMinResult
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.problem import Problem

__all__ = ["check_limits", "solve_maxmin"]

LISTED_ROBOTS = 12
LISTED_OUTCOMES = 3000
"""Up to this many robots and outcomes all non-dominated outcomes are listed beforehand."""


def solve_maxmin(
    problem: Problem,
    *,
    gap: float = 1e-9,
    time_limit: float | None = None,
    max_nodes: int | None = None,
    progress: Callable[[int, float, float], None] | None = None,
) -> MaxMinResult:
    """Find the plan with the largest worst-case value, and prove how good it is.

    Relies on a non-decreasing objective (not checked). For the information criteria: outer approximation
    and branch and bound. Every bound is derived from the problem's matrices by the leaf
    formula of :mod:`ratt_opt.solvers.maxmin.proof`; of the linear programs only the multipliers are used. Other set
    functions are enumerated where that is possible.

    Parameters
    ----------
    gap : stop when ``upper - lower <= gap * |upper|``
    time_limit : seconds; the bracket is valid whenever the search stops
    max_nodes : search nodes; with it (and no time limit) the result is reproducible
    progress : called as ``progress(nodes, lower, upper)``

    Raises
    ------
    InputError : a limit is not positive, or the set function is not an information criterion and has too many plans.

    Source: outer approximation (Duran and Grossmann 1986) of the concave relaxation of eqn:resi_target_prob.
    """
    check_limits(gap, time_limit, max_nodes)
    objective = problem.objective
    if not isinstance(objective, InformationObjective):
        return exhaustive_optimum(problem)
    deadline = None if time_limit is None else time.monotonic() + time_limit
    pool = OutcomePool(problem, objective)
    incumbent = Incumbent(problem, pool, deadline)
    search: BranchAndBound | None = None
    try:
        _list_outcomes(problem, pool)
        classes = equal_elements(problem, objective)
        pairs = PairOutcomes.of(problem, objective, classes)
        incumbent.start(*([] if pairs is None else [pairs.strongest_plan()]))
        # Both sides together stay within the gap: what the search leaves, and what counts as a proved plan.
        search = BranchAndBound(pool, incumbent, classes, max(gap - PROVED, 0.0), pairs)
        stop = _search_and_prove(search, incumbent, max_nodes, progress)
    except KeyboardInterrupt:
        stop = Stop.INTERRUPTED
    return _result(problem, incumbent, search, stop, gap)


def _search_and_prove(
    search: BranchAndBound,
    incumbent: Incumbent,
    max_nodes: int | None,
    progress: Callable[[int, float, float], None] | None,
) -> Stop:
    """Search plans, attack the best exactly, and go on with what that taught, until nothing is left or time is out."""
    while True:
        if progress is not None:
            progress(search.nodes, incumbent.lower, search.upper)
        stop = search.run(max_nodes, progress)
        if not incumbent.prove():
            return stop


def _result(
    problem: Problem, incumbent: Incumbent, search: BranchAndBound | None, stop: Stop, gap: float
) -> MaxMinResult:
    # Before any cut bounds all plans, monotonicity does: no plan is worth more than all elements together.
    everything = problem.objective(range(problem.objective.n))
    proved = search is not None and np.isfinite(search.upper)
    lower = incumbent.lower
    upper = max(search.upper if search is not None and proved else everything, lower)
    if upper <= lower * (1 + 1e-9):
        stop = Stop.CLOSED
    elif stop is Stop.GAP and upper - lower > max(gap, 1e-9) * abs(upper) * (1 + 1e-9):
        stop = incumbent.unproved_stop  # no better plan is left, but this one's worst case is not proved
    return MaxMinResult(
        elements=readonly(incumbent.elements),
        lower=lower,
        upper=upper,
        stop=stop,
        evaluations=incumbent.evaluations,
        nodes=0 if search is None else search.nodes,
        posterior_gap=_posterior_gap(problem, lower, upper),
        worst_case=incumbent.worst_case,
        proof=search.proof() if search is not None and proved else None,
    )


def _posterior_gap(problem: Problem, lower: float, upper: float) -> float | None:
    objective = problem.objective
    before = objective.prior_criterion if isinstance(objective, InformationObjective) else None
    return None if before is None or before <= lower else (upper - lower) / (before - lower)


def _list_outcomes(problem: Problem, pool: OutcomePool) -> None:
    """Fill the pool with all non-dominated outcomes where there are few."""
    if problem.n_robots > LISTED_ROBOTS or not problem.threat.is_symmetric:
        return
    outcomes = list(islice(non_dominated_outcomes(problem.threat), LISTED_OUTCOMES + 1))
    if len(outcomes) <= LISTED_OUTCOMES:
        for outcome in outcomes:
            pool.add(Attack(*realise(problem.threat, outcome)))
        pool.complete = True


def check_limits(gap: float, time_limit: float | None, max_nodes: int | None = None) -> None:
    """Check the limits of a search.

    Raises
    ------
    InputError : the gap is negative or not a number, or a limit is not positive.
    """
    if not (math.isfinite(gap) and gap >= 0):
        raise InputError("gap", "must be a number >= 0", gap)
    if time_limit is not None and not time_limit > 0:
        raise InputError("time_limit", "must be positive seconds", time_limit)
    if max_nodes is not None and max_nodes < 1:
        raise InputError("max_nodes", "must be at least 1", max_nodes)
