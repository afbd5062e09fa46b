"""The best plan when nobody attacks."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.problem import Plan
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.maxmin.solve import solve_maxmin

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["nonrobust_optimum", "nonrobust_search"]

FEW_PLANS = 300_000
"""So few plans are evaluated one and all."""


def nonrobust_optimum(problem: Problem) -> Plan:
    """Best plan when nobody attacks, to 1e-9 relative.

    Raises
    ------
    InputError : more than 5 million plans of a set function that is no information criterion.

    Source: the algorithm NR-OPT of ratt.tex, Section VI.
    """
    result = nonrobust_search(problem)
    return Plan(elements=result.elements, evaluations=result.evaluations)


def nonrobust_search(
    problem: Problem, *, time_limit: float | None = None, budget: Budget | None = None
) -> MaxMinResult:
    """Bracket the best value when nobody attacks: :func:`solve_maxmin` with no budgets, or every plan where few.

    Parameters
    ----------
    time_limit : seconds; the plan is proved best where ``stop`` is ``CLOSED``, ``GAP`` or ``EXHAUSTED``
    budget : an outer search's budget: its seconds and interrupts count too

    Raises
    ------
    InputError : more than 5 million plans of a set function that is no information criterion.
    """
    unattacked = replace(problem, alpha_s=0, alpha_c=0)
    few = np.prod([float(len(choice)) for choice in problem.choices]) <= FEW_PLANS
    if few or not isinstance(problem.objective, InformationObjective):
        return exhaustive_optimum(unattacked)
    return solve_maxmin(unattacked, time_limit=time_limit, budget=budget)
