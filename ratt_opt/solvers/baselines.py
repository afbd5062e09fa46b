"""The planners RATT is compared with."""

from __future__ import annotations

import numpy as np

from ratt_opt._validation import check_integer, readonly
from ratt_opt.errors import InputError
from ratt_opt.problem import Plan, Problem
from ratt_opt.solvers.exhaustive import LARGEST_SEARCH, plan_values
from ratt_opt.solvers.ratt import bait_and_greedy

__all__ = ["greedy", "myopic", "nonrobust_optimum", "random_plan"]


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
    """Best plan when nobody attacks, by evaluating every plan.

    Raises
    ------
    InputError : more than ``LARGEST_SEARCH`` plans.

    Source: the algorithm NR-OPT of ratt.tex, Section VI.
    """
    count = float(np.prod(np.array([len(choice) for choice in problem.choices], dtype=np.float64)))
    if count > LARGEST_SEARCH:
        rule = f"must have at most {LARGEST_SEARCH:,} plans for the non-robust optimum"
        raise InputError("problem", rule, f"{count:.3g} plans")
    groups = problem.communication.groups()
    values = plan_values(problem, groups[0])
    for group in groups[1:]:
        values = np.maximum(values, plan_values(problem, group))
    shape = tuple(len(choice) for choice in problem.choices)
    best = np.unravel_index(int(np.broadcast_to(values, shape).argmax()), shape)
    elements = np.array([choice[k] for choice, k in zip(problem.choices, best, strict=True)])
    return Plan(elements=readonly(elements), evaluations=values.size)
