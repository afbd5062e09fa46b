"""The optimum by evaluating every plan against every outcome: the reference for all other planners."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, readonly
from ratt_opt.attack.exact import worst_case_attack_unrounded
from ratt_opt.attack.task import AttackOptions
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible
from ratt_opt.coordinates.preparation import prepared
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.problem import check_problem
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.metered import Metered
from ratt_opt.solvers.result import MaxMinResult

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.problem import Problem

__all__ = ["exhaustive_optimum"]

LARGEST_SEARCH = 5_000_000
"""Most plans that are enumerated (12**6 is about 3 million)."""


@interruptible
@Step("all plans")
def exhaustive_optimum(
    problem: Problem,
    *,
    time_limit: float | None = None,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
) -> MaxMinResult:
    """Return the best plan by evaluating every plan against every non-dominated outcome.

    Relies on a non-decreasing objective (not checked). Among equal plans the one with the lowest elements, robot by
    robot, is returned. A spent budget or an interrupt returns the bracket that the outcomes evaluated by then prove:
    the best plan under these, and what is known at once of its worst case.

    Parameters
    ----------
    time_limit : seconds; unlimited by default
    max_evaluations : values of an objective that is no information criterion (a few are computed whatever the limit)
    budget : an outer search's budget: its seconds and interrupts count too

    Raises
    ------
    InputError : more than ``LARGEST_SEARCH`` plans; use ``solve_maxmin``.

    Source: the algorithm OPT of ratt.tex, Section VI.
    """
    problem = prepared(check_problem(problem, knows_at_most=True))
    shape = _shape(problem, range(problem.n_robots))
    with np.errstate(over="ignore"):
        n_plans = float(np.prod(np.array(shape, dtype=np.float64)))
    if n_plans > LARGEST_SEARCH:
        rule = f"must have at most {LARGEST_SEARCH:,} plans for an exhaustive search (use solve_maxmin)"
        raise InputError("problem", rule, f"{n_plans:.3g} plans")
    own, stop = Budget.inside(budget, time_limit, max_evaluations=max_evaluations), Stop.EXHAUSTED
    worst = np.full(shape, np.inf)
    group_values: dict[frozenset[int], FloatArray] = {}
    try:
        for outcome in non_dominated_outcomes(problem.threat):
            own.check()
            team = np.full((1,) * len(shape), -np.inf)
            for group in outcome:
                if group not in group_values:
                    own.check()
                    group_values[group] = _plan_values(problem, group, own)
                team = np.maximum(team, group_values[group])
            worst = np.minimum(worst, team)
    except OutOfBudget as out:
        stop = out.stop
    except KeyboardInterrupt:
        stop = own.interrupt()
    if problem.at_most is not None:
        worst[_busy(problem, shape) > problem.at_most] = -np.inf
    best = np.unravel_index(int(worst.argmax()), shape)
    picks = iter(best)
    elements = np.array([choice[next(picks) if len(choice) > 1 else 0] for choice in problem.choices])
    lower = upper = float(worst[best])
    if stop is not Stop.EXHAUSTED:  # what monotonicity and the outcomes so far prove
        upper = min(upper, problem.objective(range(problem.objective.n)))
        known = worst_case_attack_unrounded(problem, elements, AttackOptions(time_limit=0, budget=own))
        lower = min(known.lower, upper)
    count = sum(values.size for values in group_values.values())
    found = MaxMinResult(
        elements=readonly(elements), lower=lower, upper=upper, stop=stop, evaluations=count, nodes=worst.size
    )
    return found.widen_by_rounding(problem)


def _busy(problem: Problem, shape: tuple[int, ...]) -> IntArray:
    """Number of robots of each plan that choose an element which is not idle; a robot without a choice is idle."""
    count: IntArray = np.zeros(shape, dtype=np.int64)
    varied = [(choice, idle) for choice, idle in zip(problem.choices, problem.idle, strict=True) if len(choice) > 1]
    for axis, (choice, idle) in enumerate(varied):
        count += (choice != idle).reshape([-1 if k == axis else 1 for k in range(len(shape))])
    return count


def _plan_values(problem: Problem, group: Iterable[int], budget: Budget) -> FloatArray:
    """Value of one group's robots for each joint choice of theirs.

    The array has one axis per robot of the team that has a choice: its number of elements if the robot
    belongs to ``group``, 1 elsewhere, so that arrays of different groups broadcast.
    """
    members = sorted(group)
    shape = _shape(problem, members)
    varied = [problem.choices[i] for i in members if len(problem.choices[i]) > 1]
    picks: IntArray = np.zeros((int(np.prod(shape)), len(members)), dtype=np.int64)
    places = iter(np.indices([len(choice) for choice in varied]).reshape(len(varied), len(picks)))
    for k, choice in enumerate(problem.choices[i] for i in members):
        picks[:, k] = choice[next(places)] if len(choice) > 1 else choice[0]
    values, f = np.empty(len(picks)), problem.objective
    if not isinstance(f, InformationObjective):
        f = Metered(f, budget)
    for start in range(0, len(picks), 8192):
        budget.check()
        block = picks[start : start + 8192]
        membership = np.zeros((len(block), problem.objective.n), dtype=np.bool_)
        membership[np.arange(len(block))[:, None], block] = True
        values[start : start + 8192] = f.evaluate(membership)
    return values.reshape(shape)


def _shape(problem: Problem, members: Iterable[int]) -> tuple[int, ...]:
    """Axes of the robots with a choice (a team may be larger than arrays have axes)."""
    inside = set(members)
    return tuple(len(c) if i in inside else 1 for i, c in enumerate(problem.choices) if len(c) > 1)
