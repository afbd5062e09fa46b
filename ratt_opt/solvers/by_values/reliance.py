"""Assumptions of searches by values: non-decreasing functions, and submodular ones if they say so.

Small functions are checked. What is relied upon stands in the result. If a search meets sets that break it, an error
shows them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget
from ratt_opt.curvatures.domains import domain_of
from ratt_opt.curvatures.marginals import enumerate_marginals
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.setfunctions.properties import find_submodularity_violation
from ratt_opt.setfunctions.sampling import Violation

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.base import SetFunction
    from ratt_opt.solvers.maxmin.params import ValueCheckParams

__all__ = ["check_small", "refuse_along", "refuse_larger_gains", "relied_on"]


def relied_on(f: SetFunction) -> tuple[str, ...]:
    """The properties that a search takes from the function's own word."""
    return ("non-decreasing", "submodular") if f.is_submodular else ("non-decreasing",)


def check_small(problem: Problem, budget: Budget, params: ValueCheckParams) -> None:
    """Refuse a small function that falls, or that says it is submodular and is not, showing where.

    What cannot be looked at in its share of the budget is relied on.

    Raises
    ------
    InputError : the objective is not non-decreasing over feasible sets, or not submodular.
    """
    _check_submodular(unmetered(problem.objective), budget, params)
    f = unmetered(problem.objective)
    domain = domain_of(f, problem.robot, None)
    if f.is_non_decreasing or domain.count > (params.table if isinstance(f, TableFunction) else params.sets):
        return
    try:
        enumerate_marginals(domain, budget.part(params.share))
    except OutOfBudget:
        return


def _check_submodular(f: SetFunction, budget: Budget, params: ValueCheckParams) -> None:
    is_small = 2**f.n <= min(params.sets, params.share * budget.evaluations_left)
    if not f.is_submodular or not is_small:
        return
    found = find_submodularity_violation(f, budget=budget.part(params.share))
    if isinstance(found, Violation):
        _refuse(found.a, found.b, found.slack)


def refuse_larger_gains(f: SetFunction, base: IntArray, others: IntArray, gains: FloatArray, alone: FloatArray) -> None:
    """Refuse a function that says it is submodular if an element adds more to a set than to nothing.

    ``gains`` : (C,) what each of the elements ``others`` adds to the set ``base``; ``alone`` : (C,) what it adds to
    nothing. Differences within rounding are none.

    Raises
    ------
    InputError : one adds more; the text shows the sets.
    """
    excess = gains - alone
    if len(excess) and excess.max() > f.least_improvement(float(np.abs(gains).max() + np.abs(alone).max()), terms=4):
        k = int(excess.argmax())
        _refuse(tuple(base.tolist()), (int(others[k]),), -float(excess[k]))


def refuse_along(f: SetFunction, plan: IntArray) -> None:
    """Refuse a function that says it is submodular if a plan's element adds more to those before it than to nothing.

    For plans that are worth more than a bound that relies on it. Raises ``InputError``.
    """
    nothing = f(())
    for k in range(1, len(plan)):
        base, last = plan[:k], plan[k : k + 1]
        refuse_larger_gains(
            f, base, last, f.extensions(base, last) - f(base.tolist()), f.extensions(base[:0], last) - nothing
        )


def _refuse(a: tuple[int, ...], b: tuple[int, ...], slack: float) -> None:
    shown = f"f(A) + f(B) - f(A | B) - f(A & B) = {slack:.6g} for A = {list(a)}, B = {list(b)}"
    raise InputError("f", "must be submodular, as it says (is_submodular = True)", shown)
