"""The planners RATT is compared with."""

from __future__ import annotations

import numpy as np

from ratt_opt._validation import check_integer, readonly
from ratt_opt.problem import Plan, Problem
from ratt_opt.solvers.ratt import bait_and_greedy

__all__ = ["greedy", "myopic", "random_plan"]


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
