"""Theorem 2 measured: set-function evaluations of RATT against ``|U_V|**2`` and against lazy evaluation."""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, readonly
from ratt_opt.errors import InputError
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.problem import Problem

__all__ = ["EvaluationCount", "GrowthFit", "evaluation_bound", "evaluation_count", "fit_growth", "lazy_greedy_picks"]


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationCount:
    """Evaluations of one run.

    ``elements`` : ``|U_V|``
    ``measured`` : what RATT's plain greedy asked for
    ``lazy`` : what greedy with a priority queue of stale marginals asks for
    ``bound`` : the most it can be, by :func:`evaluation_bound`; attained when all robots have equally many elements
    ``same_plan`` : whether lazy evaluation led to RATT's own choices; sure for submodular objectives only
    """

    elements: int
    measured: int
    lazy: int
    bound: int
    same_plan: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class GrowthFit:
    """``evaluations ~ factor * elements**exponent`` by least squares of logarithms; ``residual`` the largest of those.

    ``largest_share`` is the largest ``evaluations / elements**2`` of the data: the constant that Theorem 2 leaves open.
    """

    factor: float
    exponent: float
    residual: float
    largest_share: float


def evaluation_count(problem: Problem) -> EvaluationCount:
    """Count the evaluations of RATT on one problem, plain and lazy.

    Source: Theorem 2 (ratt.tex, thm:ratt_run_time); M. Minoux, Accelerated greedy algorithms, 1978.
    """
    plan = ratt(problem)
    robots = np.setdiff1d(np.arange(problem.n_robots), np.array(plan.bait, dtype=np.int64))
    picks, lazy = lazy_greedy_picks(problem, robots)
    sizes = [len(problem.choices[i]) for i in robots]
    return EvaluationCount(
        elements=problem.objective.n,
        measured=plan.evaluations,
        lazy=problem.objective.n + lazy,
        bound=evaluation_bound(problem.objective.n, sizes),
        same_plan=bool((plan.elements[robots] == picks[robots]).all()),
    )


def evaluation_bound(n_elements: int, sizes: Sequence[int]) -> int:
    """Most evaluations Algorithm 1 can take: all single elements, then greedy rounds over the robots left.

    The first greedy round reuses the single values. A later round evaluates every element of the robots without a
    choice, so the count is largest when robots with few elements are picked first: the s-th smallest counts ``s - 1``
    times. Each of the ``R - 1`` later rounds takes at most ``n_elements``, and ``R <= n_elements``: so the total is at
    most ``n_elements**2`` for any R and any sizes.

    Parameters
    ----------
    n_elements : ``|U_V|``; sizes : (R,) number of elements of each greedy robot
    """
    return n_elements + sum(rank * size for rank, size in enumerate(sorted(sizes)))


def lazy_greedy_picks(problem: Problem, robots: IntArray) -> tuple[IntArray, int]:
    """Greedy choices of ``robots`` by lazy evaluation, ties to the lowest element.

    Returns the (N,) elements (-1 for robots that are not asked) and the evaluations beyond the single values.
    A stale marginal is an upper bound only for a submodular objective: elsewhere the choices may differ from greedy's.
    """
    single = problem.objective.singletons()
    elements = np.full(problem.n_robots, -1, dtype=np.int64)
    queue = [(-float(single[e]), int(e), 0) for e in np.flatnonzero(np.isin(problem.robot, robots))]
    heapq.heapify(queue)
    chosen = np.array([], dtype=np.int64)
    base, evaluations = 0.0, 0
    while queue:
        bound, element, stamp = heapq.heappop(queue)
        if elements[problem.robot[element]] >= 0:
            continue
        if stamp == len(chosen):
            elements[problem.robot[element]] = element
            chosen = np.append(chosen, element)
            base -= bound
            continue
        value = float(problem.objective.extensions(chosen, np.array([element]))[0])
        evaluations += 1
        heapq.heappush(queue, (base - value, element, len(chosen)))
    return readonly(elements), evaluations


def fit_growth(elements: Sequence[int] | FloatArray, evaluations: Sequence[int] | FloatArray) -> GrowthFit:
    """Fit a power law to evaluation counts.

    Raises
    ------
    InputError : fewer than two different sizes, or a count that is not positive.
    """
    x, y = np.asarray(elements, dtype=np.float64), np.asarray(evaluations, dtype=np.float64)
    if len(np.unique(x)) < 2 or x.shape != y.shape:
        raise InputError("elements", "must hold at least two different sizes, one per count", x.tolist())
    if min(x.min(), y.min()) <= 0:
        raise InputError("evaluations", "must be positive", float(min(x.min(), y.min())))
    exponent, offset = np.polyfit(np.log(x), np.log(y), 1)
    residual = np.abs(np.log(y) - offset - exponent * np.log(x)).max()
    return GrowthFit(
        factor=float(np.exp(offset)),
        exponent=float(exponent),
        residual=float(residual),
        largest_share=float((y / x**2).max()),
    )
