"""Local search: one robot after the other changes its element while that helps against the known outcomes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool

__all__ = ["climb"]


def climb(problem: Problem, pool: OutcomePool, plan: IntArray, budget: Budget) -> IntArray:
    """Pass over the robots, each taking the element of largest value on the known outcomes, until none changes.

    Parameters
    ----------
    plan : (N,) element of each robot to start from; not changed

    Raises
    ------
    OutOfBudget : the time is up.
    """
    objective = pool.objective
    current = plan.copy()
    points = pool.group_points(objective.information[current])
    base = objective.value(points)
    value = float(pool.outcome_values(base).min(initial=np.inf))
    unchanged, i = 0, 0
    while unchanged < problem.n_robots:
        budget.check()
        choice = problem.choices[i]
        rows = np.flatnonzero(pool.membership()[:, i])
        others = choice[choice != current[i]]
        unchanged += 1
        if len(others) and len(rows):
            change = objective.information[others] - objective.information[current[i]]
            values = np.repeat(base[None], len(others), axis=0)
            values[:, rows] = objective.value(points[rows][None] + change[:, None])
            worst = pool.outcome_values(values).min(axis=1)
            k = int(worst.argmax())
            if worst[k] > value + 1e-12 * abs(value) + objective.rounding:  # a tie is no improvement
                current[i], value, base = others[k], float(worst[k]), values[k]
                points[rows] += change[k]
                unchanged = 0
        i = (i + 1) % problem.n_robots
    return current
