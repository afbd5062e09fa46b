"""Globally optimal max-min plans with a bracket at any time."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible
from ratt_opt.coordinates.preparation import prepared, restored
from ratt_opt.errors import InputError, ProofError
from ratt_opt.problem import Attack, Plan, check_problem
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.by_values.solve_by_values import solve_by_values
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.maxmin.coverage import CoverageTrace
from ratt_opt.solvers.maxmin.incumbent import Incumbent
from ratt_opt.solvers.maxmin.monotone_bound import monotone_bound
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.params import or_default
from ratt_opt.solvers.maxmin.plan_stage import LowerEnd, PlanPhase, run_plan_stages
from ratt_opt.solvers.maxmin.stages import schedule
from ratt_opt.solvers.maxmin.stages.first_plans import outlast_first_plans
from ratt_opt.solvers.maxmin.time_slices import TimeSlices
from ratt_opt.solvers.maxmin.upper_bound_portfolio import UpperBoundPortfolio
from ratt_opt.solvers.maxmin.watchers import watched_plan
from ratt_opt.solvers.ratt import alpha_cs_in_share, greedy, myopic, ratt
from ratt_opt.solvers.result import MaxMinResult, NonrobustPlan, posterior_gap

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.bound_stage import BoundStage
    from ratt_opt.solvers.maxmin.params import MaxMinParams
    from ratt_opt.solvers.maxmin.time_slices import Progress

__all__ = [
    "check_limits",
    "nonrobust_optimum",
    "nonrobust_search",
    "solve_in_coordinates",
    "solve_maxmin",
]


@interruptible
@Step("the best plan")
def solve_maxmin(
    problem: Problem,
    *,
    gap: float = 1e-9,
    time_limit: float | None = None,
    max_nodes: int | None = None,
    progress: Progress = None,
    alpha_cs: int | None = None,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    start: ArrayLike | Plan | MaxMinResult | None = None,
    params: MaxMinParams | None = None,
) -> MaxMinResult:
    """Find the plan with the largest worst-case value, and prove how good it is.

    Relies on a non-decreasing objective (not checked). For the information criteria: outer approximation and branch
    and bound, in the coordinates that are measured (:func:`ratt_opt.measured_coordinates`). Every bound is derived from
    the problem's matrices by the leaf formula of :mod:`ratt_opt.solvers.maxmin.proof`; of the linear programs only
    the multipliers are used. Other set functions are enumerated if that is possible, and bracketed if it is not
    (``solvers/by_values``); sums of best elements, such as coverage, as a trace, too (``coverage.py``).

    No plan is worse than RATT's, the greedy and the myopic one, as far as exact attacks on them end: the three, these
    attacks and, of functions known by their values, exchanges from them may overrun the limit by up to
    ``params.first_plans.beyond`` seconds (0.4). Without a limit the search goes on until its bracket closes.

    Parameters
    ----------
    gap : stop when ``upper - lower <= gap * |upper|``
    time_limit : seconds; the bracket is valid whenever the search stops; with 0 first plans are compared, no more
    max_nodes : search nodes; with it (and no time limit) the result is reproducible
    progress : called as ``progress(nodes, lower, upper)``
    alpha_cs : sensing attacks that the link attacks are worth, if RATT was asked before
    max_evaluations : values of an objective that is no information criterion (a few are computed whatever the limit)
    budget : an outer search's budget: its seconds and interrupts count too
    start : a plan (N,), or an earlier result of a similar problem, whose plan is used if the problem still allows it;
        what is enumerated needs none. Changes how long a search takes, not what it claims
    params : numbers of the search; they decide how soon the bracket closes, not whether it holds

    Raises
    ------
    InputError : a limit is negative, ``start`` is a plan but not one element per robot, or the objective is no
        information criterion, and one of its values that the search computed falls.

    Source: outer approximation (Duran and Grossmann 1986) of the concave relaxation of eqn:resi_target_prob.
    """
    check_limits(gap, time_limit, max_nodes)
    check_problem(problem, knows_at_most=True)
    budget, params = Budget.inside(budget, time_limit, max_nodes, max_evaluations), or_default(params)
    if not isinstance(problem.objective, InformationObjective):
        return solve_by_values(
            problem, budget, gap, alpha_cs, lambda: _solve_as_trace(problem, budget, gap, params), params
        )
    searched = prepared(problem)
    told = progress and (lambda nodes, lower, upper: progress(nodes, *searched.widen_by_rounding(lower, upper)))
    found = solve_in_coordinates(searched, budget, gap, told, alpha_cs, start, params=params)
    found = found.widen_by_rounding(searched)
    return replace(restored(searched, found), posterior_gap=posterior_gap(problem, found.lower, found.upper))


def _solve_as_trace(problem: Problem, budget: Budget, gap: float, all_params: MaxMinParams) -> MaxMinResult | None:
    """Bracket the optimum of a sum of best elements by that of a trace; ``None`` if there is none or values count."""
    params = all_params.coverage
    trace = CoverageTrace.of(problem, params) if np.isinf(budget.evaluations_left) else None
    if trace is None:
        return None
    most = None if np.isfinite(budget.seconds_left) else params.nodes
    if budget.max_nodes is not None:
        most = max(int(params.share * budget.nodes_left(budget.max_nodes)), 1)
    part = budget.part(params.share)
    found = solve_maxmin(trace.problem, gap=trace.gap(gap), max_nodes=most, budget=part, params=all_params)
    budget.nodes += found.nodes
    return trace.carried_over(found)


def solve_in_coordinates(  # noqa: PLR0917  (as solve_maxmin has them)
    problem: Problem,
    budget: Budget,
    gap: float = 1e-9,
    progress: Progress = None,
    alpha_cs: int | None = None,
    start: ArrayLike | Plan | MaxMinResult | None = None,
    *,
    stages: Sequence[BoundStage] | None = None,
    by_rows: bool = True,
    params: MaxMinParams | None = None,
) -> MaxMinResult:
    """Solve in the given coordinates, for an information criterion.

    ``stages`` : of the upper end; those of the schedule if ``None``
    ``by_rows`` : whether its cuts may have inequalities of single targets in the place of tangents
    """
    earlier, params = _plan_of(problem, start), or_default(params)
    alpha_cs = alpha_cs_in_share(problem, budget) if alpha_cs is None else alpha_cs
    longer = budget.beyond(params.first_plans.beyond)
    first = ratt(problem, alpha_cs=alpha_cs, budget=longer).elements
    pool = OutcomePool(problem)
    incumbent = Incumbent(problem, pool, first, budget, params)
    search: UpperBoundPortfolio | None = None
    state: LowerEnd | None = None
    try:
        pool.list_all(params.outcomes)
        plans = _first_plans(problem, first, earlier, longer)
        watched = watched_plan(problem, budget, params.watchers)
        plans += [] if watched is None else [watched]
        state = LowerEnd(incumbent=incumbent, plans=plans, gap=gap, by_rows=by_rows)
        run_plan_stages(schedule.PLAN_STAGES, state, PlanPhase.BEFORE)
        search = UpperBoundPortfolio(state.known, stages)
        stop = _search_and_prove(search, state, progress)
        run_plan_stages(schedule.PLAN_STAGES, state, PlanPhase.AFTER)
    except OutOfBudget as out:
        stop = out.stop
    except KeyboardInterrupt:
        stop = budget.interrupt()
    if state is not None and budget.stop() is Stop.TIME:
        with suppress(OutOfBudget):
            outlast_first_plans(state, longer)
    return _result(problem, incumbent, search, stop, gap)


def _plan_of(problem: Problem, start: ArrayLike | Plan | MaxMinResult | None) -> IntArray | None:
    """(N,) the plan to start from; ``None`` if there is none, or that of an earlier result is not one any more.

    Raises ``InputError`` : a plan is not one element per robot.
    """
    if start is None:
        return None
    if not isinstance(start, MaxMinResult):
        return problem.check_plan(start.elements if isinstance(start, Plan) else start)
    try:
        return problem.check_plan(start.elements)
    except InputError:
        return None


def _first_plans(problem: Problem, first: IntArray, earlier: IntArray | None, budget: Budget) -> list[IntArray]:
    """RATT's plan, and one that was best a step before; the plans of other planners if there is none."""
    if earlier is not None:
        return [first, earlier]
    return [first, *(planner(problem, budget=budget).elements for planner in (greedy, myopic))]


def _search_and_prove(search: UpperBoundPortfolio, state: LowerEnd, progress: Progress) -> Stop:
    """Search plans, attack the best exactly, and go on with what that taught, until nothing is left or time is out."""
    budget, incumbent = state.incumbent.budget, state.incumbent
    slices = TimeSlices(budget, incumbent)
    while True:
        if progress is not None:
            progress(budget.nodes, incumbent.proved.lower, search.upper)
        stop = search.run(slices, progress)
        if not run_plan_stages(schedule.PLAN_STAGES, state, PlanPhase.BETWEEN):
            return stop
        slices.begin_turn()


def _result(
    problem: Problem, incumbent: Incumbent, search: UpperBoundPortfolio | None, stop: Stop, gap: float
) -> MaxMinResult:
    proved = incumbent.proved
    lower = proved.lower
    if search is not None and search.upper != np.inf:
        stage, upper, proof = search.lowest, search.upper, search.proof()
    else:  # before any cut bounds all plans, monotonicity does
        known = monotone_bound(problem, Attack() if proved.worst_case is None else proved.worst_case.attack)
        stage, upper, proof = "monotonicity", known.upper, known.proof
    rounding = 16 * problem.objective.rounding  # of values, of tangents, and of the proof of the plan
    closed = 1e-9  # relative width of a bracket that counts as closed
    width = closed * abs(lower) + rounding
    if not upper >= lower - width:
        raise ProofError(f"{stage}: no plan is worth more than {upper:.10g}, but one is worth {lower:.10g} at least")
    upper = max(upper, lower)
    if upper - lower <= width:
        stop = Stop.CLOSED
    elif stop is Stop.GAP and upper - lower > max(gap, closed) * abs(upper) * (1 + closed) + rounding:
        stop = proved.unproved_stop  # no better plan is left, but this one's worst case is not proved
    return MaxMinResult(
        elements=readonly(proved.elements),
        lower=float(lower),
        upper=float(upper),
        stop=stop,
        evaluations=proved.evaluations,
        nodes=incumbent.budget.nodes,
        posterior_gap=posterior_gap(problem, lower, upper),
        worst_case=proved.worst_case,
        proof=proof,
        unattacked=float(problem.team_value(proved.elements, Attack())),
    )


def check_limits(gap: float, time_limit: float | None, max_nodes: int | None = None) -> None:
    """Check the limits of a search.

    Raises ``InputError`` : the gap is negative or not a number, or a limit is not positive.
    """
    if not (_is_number(gap) and math.isfinite(gap) and gap >= 0):
        raise InputError("gap", "must be a number >= 0", gap)
    if time_limit is not None and not (_is_number(time_limit) and time_limit >= 0):
        raise InputError("time_limit", "must be a number of seconds >= 0", time_limit)
    if max_nodes is not None and max_nodes < 1:
        raise InputError("max_nodes", "must be at least 1", max_nodes)


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


@interruptible
def nonrobust_optimum(
    problem: Problem,
    *,
    time_limit: float | None = None,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
) -> NonrobustPlan:
    """Best plan when nobody attacks, to 1e-9 relative; the best found, with its bracket, if a limit ends the search.

    Parameters
    ----------
    time_limit, max_evaluations, budget : as for :func:`solve_maxmin`

    Source: the algorithm NR-OPT of ratt.tex, Section VI.
    """
    own = Budget.inside(budget, time_limit, max_evaluations=max_evaluations)
    result = nonrobust_search(problem, budget=own)
    return NonrobustPlan(
        elements=result.elements,
        evaluations=result.evaluations,
        lower=result.lower,
        upper=result.upper,
        stop=result.stop,
    )


def nonrobust_search(
    problem: Problem,
    *,
    time_limit: float | None = None,
    budget: Budget | None = None,
    params: MaxMinParams | None = None,
) -> MaxMinResult:
    """Bracket the best value when nobody attacks: :func:`solve_maxmin` with no budgets, or every plan if few.

    ``time_limit`` : seconds; the plan is proved best if ``stop`` is ``CLOSED``, ``GAP`` or ``EXHAUSTED``
    ``budget`` : an outer search's budget: its seconds and interrupts count too
    """
    unattacked, params = replace(check_problem(problem, knows_at_most=True), alpha_s=0, alpha_c=0), or_default(params)
    own = Budget.inside(budget, time_limit)
    with np.errstate(over="ignore"):
        few = np.prod([float(len(choice)) for choice in problem.choices]) <= params.few_plans.plans
    if few and isinstance(problem.objective, InformationObjective):
        found = exhaustive_optimum(unattacked, budget=own.part(params.few_plans.share))
        if found.stop is Stop.EXHAUSTED:
            return found
    return solve_maxmin(unattacked, budget=own, params=params)
