"""The concave relaxation over a set of attacks, as a conic program, and over all attacks, which enter one by one."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from math import isinf
from typing import TYPE_CHECKING, Any
from warnings import catch_warnings, simplefilter

import numpy as np

from ratt_opt._values import ByValue
from ratt_opt.bounds.cuts import GroupCut, combined_bound, mixed_information, tangent_cut, uniform_selection
from ratt_opt.bounds.params import DEFAULT
from ratt_opt.budget import Budget
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import non_dominated_outcomes, realise
from ratt_opt.problem import Attack, check_problem
from ratt_opt.running.interrupts import imported_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt._validation import FloatArray
    from ratt_opt.bounds.params import BoundParams
    from ratt_opt.problem import Problem

__all__ = ["RelaxationBound", "relaxation_bound", "relaxation_bounds"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RelaxationBound(ByValue):
    """Claim: ``Phi* <= upper``, derived from the problem's matrices by tangent cuts at ``selection``.

    ``claimed`` : what the conic solver reports as its optimum, for comparison only.
    ``selection`` : (E,) the relaxed plan it found.
    """

    upper: float
    claimed: float
    selection: FloatArray
    status: str


def relaxation_bound(
    problem: Problem,
    attacks: Sequence[Attack],
    *,
    time_limit: float | None = None,
    budget: Budget | None = None,
    params: BoundParams = DEFAULT,
) -> RelaxationBound:
    """Bound the optimum by letting every robot mix its elements against the given attacks.

    The largest group of each attack enters the program. The other groups have a bound of their own. The result is the
    larger of the two, as the team value is the best group's. Modelled in cvxpy and solved by Clarabel; the bound is
    *not* the solver's objective but the best convex combination of tangent cuts at the point it returns, so a wrong
    answer gives a weak bound, never a false one.

    Parameters
    ----------
    problem : its objective is an information criterion
    attacks : at least one, within the budgets; the worst attacks on good plans give good bounds
    time_limit : seconds for the conic solver; the point it has reached by then gives a bound. Unlimited by default
    budget : an outer search's budget: its seconds count too
    params : accuracy of the conic solver, and tangents

    Raises
    ------
    InputError : no attack, one outside the budgets, another kind of set function, or a criterion without conic form.

    Source: concavity of the three criteria in the posterior information; Boyd and Vandenberghe 2004, Section 7.5.
    """
    objective = check_problem(problem).information_objective
    if not attacks:
        raise InputError("attacks", "must hold at least one attack", "none")
    largest, others = _groups(problem, attacks)
    if () in largest:
        nothing, selection = objective([]), uniform_selection(problem)
        return RelaxationBound(upper=nothing, claimed=nothing, selection=selection, status="an attack leaves nobody")
    claimed, selection, status = _solve(problem, largest, Budget.inside(budget, time_limit), params)
    cuts = [cut for group in largest for cut in _cuts_at(problem, group, selection, params)]
    computed = float(
        max([_best_combination(problem, cuts), *(_group_bound(problem, group, params) for group in others)])
    )
    _, upper = problem.widen_by_rounding(0.0, computed)
    return RelaxationBound(upper=upper, claimed=claimed, selection=selection, status=status)


def _groups(problem: Problem, attacks: Sequence[Attack]) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """The largest group of non-blinded robots of each attack, and all other groups; each once."""
    largest: dict[tuple[int, ...], None] = {}
    others: dict[tuple[int, ...], None] = {}
    for attack in attacks:
        problem.check_attack(attack)
        left = sorted((tuple(sorted(group)) for group in problem.groups_left(attack)), key=lambda g: (-len(g), g))
        largest[left[0]] = None
        others.update(dict.fromkeys(group for group in left[1:] if group))
    return list(largest), list(others)


def _solve(
    problem: Problem, groups: Sequence[tuple[int, ...]], budget: Budget, params: BoundParams
) -> tuple[float, FloatArray, str]:
    if budget.is_over:
        return float("nan"), uniform_selection(problem), "not asked: no time"
    cp = imported_whole("cvxpy")
    objective = problem.information_objective
    z = cp.Variable(objective.n, nonneg=True)
    t = cp.Variable()
    constraints = [cp.sum(z[choice]) == 1 for choice in problem.choices]
    constraints += [t <= objective.conic_value(_posterior(problem, group, z)) for group in groups]
    program = cp.Problem(cp.Maximize(t), constraints)
    selection = uniform_selection(problem)
    fault = _narrowed(program, budget, params)
    if fault is not None:
        return float("nan"), selection, f"solver error: {fault}"
    if z.value is not None:
        selection = np.clip(z.value, 0, None)
        for choice in problem.choices:
            selection[choice] /= selection[choice].sum()
    claimed = float("nan") if program.value is None else float(program.value)
    return claimed, selection, str(program.status)


def _narrowed(program: Any, budget: Budget, params: BoundParams) -> Exception | None:
    """Solve a program as narrowly as the solver can; return its fault if it cannot."""
    cp, fault = imported_whole("cvxpy"), None
    for tolerance in (params.tolerance, params.relaxed):
        if fault is not None and budget.is_over:
            break
        limit = {} if isinf(budget.seconds_left) else {"time_limit": budget.seconds_left}
        limit |= dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), tolerance)
        try:
            with catch_warnings():
                simplefilter("ignore", UserWarning)  # an inaccurate point gives a weak bound, never a false one
                program.solve(solver=cp.CLARABEL, **limit)
        except cp.error.SolverError as error:
            fault = error
        else:
            return None
    return fault


def _posterior(problem: Problem, group: tuple[int, ...], z: Any) -> list[Any]:
    """One affine (d, d) expression per target."""
    objective = problem.information_objective
    inside, shape = np.flatnonzero(np.isin(problem.robot, group)), (objective.dimension, objective.dimension)
    of_target = objective.information[inside].reshape(len(inside), objective.n_targets, -1).transpose(1, 2, 0)
    mixed = [(flat @ z[inside]).reshape(shape, order="C") for flat in of_target]
    return [prior + information for prior, information in zip(objective.prior_information, mixed, strict=True)]


def _cuts_at(problem: Problem, group: tuple[int, ...], selection: FloatArray, params: BoundParams) -> list[GroupCut]:
    objective = problem.information_objective
    inside = np.isin(problem.robot, group)
    point = objective.prior_information + np.einsum("e,ejkl->jkl", selection[inside], objective.information[inside])
    targets = objective.tangent_targets(point, np.inf, max(params.tangent_targets, 1))
    return [tangent_cut(problem, group, point, target) for target in targets]


def _best_combination(problem: Problem, cuts: Sequence[GroupCut]) -> float:
    """The smallest bound that a convex combination of the cuts gives: the multipliers of a linear program."""
    from scipy.optimize import linprog

    n, robots = problem.objective.n, problem.n_robots
    constants = np.array([cut.constant for cut in cuts])
    scores = np.array([cut.scores for cut in cuts])
    owners = np.zeros((robots, n + 1))
    owners[problem.robot, np.arange(n)] = 1.0
    cost = np.append(np.zeros(n), -1.0)
    rows = np.concatenate([-scores, np.ones((len(cuts), 1))], axis=1)
    bounds = [(0.0, None)] * n + [(None, None)]
    solved = linprog(cost, A_ub=rows, b_ub=constants, A_eq=owners, b_eq=np.ones(robots), bounds=bounds)
    candidates = [np.eye(len(cuts))[k] for k in range(len(cuts))]
    if solved.status == 0:
        multipliers = np.clip(-solved.ineqlin.marginals, 0.0, None)
        if multipliers.sum() > 0:
            candidates.append(multipliers)
    return min(combined_bound(constants, scores, weights, problem.choices)[0] for weights in candidates)


def _group_bound(problem: Problem, group: tuple[int, ...], params: BoundParams) -> float:
    """Upper bound on one group's value for every plan: tangents along conditional-gradient averaging steps."""
    single = problem.objective.singletons()
    best = np.array([choice[single[choice].argmax()] for choice in problem.choices])
    selection = np.zeros(problem.objective.n)
    selection[best] = 1.0
    upper = np.inf
    for step in range(max(params.averaging, 1)):
        cut = _cuts_at(problem, group, selection, params)[0]
        bound, combined = combined_bound(np.array([cut.constant]), cut.scores[None], np.ones(1), problem.choices)
        upper = min(upper, bound)
        vertex = np.zeros(problem.objective.n)
        vertex[[choice[combined[choice].argmax()] for choice in problem.choices]] = 1.0
        selection += 2 / (step + 2) * (vertex - selection) if step else 0.5 * (vertex - selection)
    return upper


def relaxation_bounds(
    problem: Problem,
    *,
    tolerance: float = 1e-7,
    time_limit: float | None = None,
    budget: Budget | None = None,
    params: BoundParams = DEFAULT,
) -> Iterator[RelaxationBound]:
    """Yield bounds on the optimum as the attack that hurts the relaxed plan most enters, round by round.

    It ends if no attack leaves the relaxed plan less than the program claims, up to ``tolerance`` relative to the
    claim. Then the last item is the bound of the relaxation over all attacks. Every item is a valid bound. A spent
    ``time_limit``, or ``budget`` (an outer search's), ends them early; ``params`` : as for :func:`relaxation_bound`.

    Raises
    ------
    InputError : the objective is no information criterion, or the team is too large to list its outcomes.
    """
    objective = check_problem(problem).information_objective
    whole, outcomes = (
        Budget.inside(budget, time_limit),
        list(islice(non_dominated_outcomes(problem.threat), params.outcomes + 1)),
    )
    if len(outcomes) > params.outcomes:
        rule = f"must leave at most {params.outcomes} outcomes to go through (use solve_maxmin)"
        raise InputError("problem", rule, f"{problem.n_robots} robots")
    robots = np.arange(problem.n_robots)
    rows = np.array([np.isin(robots, list(group)) for outcome in outcomes for group in outcome], dtype=np.float64)
    starts = np.cumsum([0, *(len(outcome) for outcome in outcomes[:-1])])
    entered: list[int] = []
    selection, level = uniform_selection(problem), np.inf
    while True:
        sums = rows @ mixed_information(problem, selection).reshape(problem.n_robots, -1)
        points = sums.reshape(-1, *objective.prior.shape) + objective.prior_information
        left = np.maximum.reduceat(objective.value(points), starts)
        worst = int(left.argmin())
        if whole.stop() is not None or worst in entered or left[worst] >= level - tolerance * abs(level):
            return
        entered.append(worst)
        attacks = [Attack(*realise(problem.threat, outcomes[k])) for k in entered]
        bound = relaxation_bound(problem, attacks, budget=whole, params=params)
        yield bound
        selection, level = bound.selection, bound.claimed
