"""The planners RATT is compared with."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer, readonly
from ratt_opt.problem import Plan, Problem
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.ratt import bait_and_greedy

if TYPE_CHECKING:
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["greedy", "myopic", "nonrobust_optimum", "nonrobust_search", "random_plan"]

FEW_PLANS = 300_000
"""So few plans are evaluated one and all."""


def greedy(problem: Problem) -> Plan:
    """Standard greedy plan that ignores attacks: RATT with ``alpha = 0``.

    Source: Fisher, Nemhauser, Wolsey 1978; the algorithm Greedy of ratt.tex, Section VI.
    """
    return bait_and_greedy(problem, 0)


def myopic(problem: Problem) -> Plan:
    """Individually best element of every robot: RATT with ``alpha = N``. Source: ratt.tex, Remark 1."""
    return bait_and_greedy(problem, problem.n_robots)


def random_plan(problem: Problem, *, seed: int) -> Plan:
    """Uniformly random element of every robot. Source: the algorithm Random of ratt.tex, Section VI."""
    rng = np.random.default_rng(check_integer("seed", seed, low=0))
    elements = np.array([choice[rng.integers(len(choice))] for choice in problem.choices])
    return Plan(elements=readonly(elements), evaluations=0)


def nonrobust_optimum(problem: Problem) -> Plan:
    """Best plan when nobody attacks, to 1e-9 relative.

    Raises
    ------
    InputError : more than 5 million plans of a set function that is no information criterion.

    Source: the algorithm NR-OPT of ratt.tex, Section VI.
    """
    result = nonrobust_search(problem)
    return Plan(elements=result.elements, evaluations=result.evaluations)


def nonrobust_search(problem: Problem, *, time_limit: float | None = None) -> MaxMinResult:
    """Bracket the best value when nobody attacks: :func:`solve_maxmin` with no budgets, or every plan where few.

    Parameters
    ----------
    time_limit : seconds; the plan is proved best where ``stop`` is ``CLOSED``, ``GAP`` or ``EXHAUSTED``

    Raises
    ------
    InputError : more than 5 million plans of a set function that is no information criterion.
    """
    unattacked = replace(problem, alpha_s=0, alpha_c=0)
    few = np.prod([float(len(choice)) for choice in problem.choices]) <= FEW_PLANS
    if few or not isinstance(problem.objective, InformationObjective):
        return exhaustive_optimum(unattacked)
    from ratt_opt.solvers.maxmin.solve import solve_maxmin  # which starts from the planners above

    return solve_maxmin(unattacked, time_limit=time_limit)
