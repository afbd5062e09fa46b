"""The optimum by evaluating every plan against every outcome: the reference for all other planners."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, readonly
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.solvers.result import MaxMinResult
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.problem import Problem

__all__ = ["exhaustive_optimum"]

LARGEST_SEARCH = 5_000_000
"""Most plans that are enumerated (12**6 is about 3 million)."""


def exhaustive_optimum(problem: Problem, *, budget: Budget | None = None) -> MaxMinResult:
    """Return the best plan by evaluating every plan against every non-dominated outcome.

    Relies on a non-decreasing objective (not checked). Among equal plans the one with the lowest elements, robot by
    robot, is returned. A spent budget or an interrupt returns the bracket that the outcomes evaluated by then prove.

    Parameters
    ----------
    budget : an outer search's budget: its seconds and interrupts count too

    Raises
    ------
    InputError : more than ``LARGEST_SEARCH`` plans; use ``solve_maxmin``.

    Source: the algorithm OPT of ratt.tex, Section VI.
    """
    shape = tuple(len(choice) for choice in problem.choices)
    n_plans = float(np.prod(np.array(shape, dtype=np.float64)))
    if n_plans > LARGEST_SEARCH:
        rule = f"must have at most {LARGEST_SEARCH:,} plans for an exhaustive search (use solve_maxmin)"
        raise InputError("problem", rule, f"{n_plans:.3g} plans")
    own, stop = Budget.inside(budget), Stop.EXHAUSTED
    worst = np.full(shape, np.inf)
    group_values: dict[frozenset[int], FloatArray] = {}
    try:
        for outcome in non_dominated_outcomes(problem.threat):
            own.check()
            team = np.full((1,) * len(shape), -np.inf)
            for group in outcome:
                if group not in group_values:
                    group_values[group] = _plan_values(problem, group, own)
                team = np.maximum(team, group_values[group])
            worst = np.minimum(worst, team)
    except OutOfBudget as out:
        stop = out.stop
    except KeyboardInterrupt:
        stop = own.interrupt()
    best = np.unravel_index(int(worst.argmax()), shape)
    elements = np.array([choice[k] for choice, k in zip(problem.choices, best, strict=True)])
    lower = upper = float(worst[best])
    if stop is not Stop.EXHAUSTED:  # what monotonicity and the outcomes so far prove
        lower, upper = problem.objective([]), min(upper, problem.objective(range(problem.objective.n)))
    count = sum(values.size for values in group_values.values())
    return MaxMinResult(
        elements=readonly(elements), lower=lower, upper=upper, stop=stop, evaluations=count, nodes=worst.size
    )


def _plan_values(problem: Problem, group: Iterable[int], budget: Budget) -> FloatArray:
    """Value of one group's robots for each joint choice of theirs.

    The array has one axis per robot of the team: its number of elements where the robot belongs to ``group``, 1
    elsewhere, so that arrays of different groups broadcast.
    """
    members = sorted(group)
    shape = tuple(len(c) if i in set(members) else 1 for i, c in enumerate(problem.choices))
    grids = np.meshgrid(*(problem.choices[i] for i in members), indexing="ij")
    picks: IntArray = np.stack([g.ravel() for g in grids], axis=1) if members else np.zeros((1, 0), dtype=np.int64)
    values = np.empty(len(picks))
    for start in range(0, len(picks), 8192):
        budget.check()
        block = picks[start : start + 8192]
        membership = np.zeros((len(block), problem.objective.n), dtype=np.bool_)
        membership[np.arange(len(block))[:, None], block] = True
        values[start : start + 8192] = problem.objective.evaluate(membership)
    return values.reshape(shape)
