"""Theorem 2: evaluations of RATT against ``|U_V|**2`` for every order of picks, and measured against lazy ones."""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from functools import partial
from itertools import combinations_with_replacement, permutations
from typing import TYPE_CHECKING

import numpy as np

from ratt_audit.appendix.entry import Counted, EntryKind, EnumeratedEntry
from ratt_audit.engine.decide import Verdict
from ratt_opt._validation import FloatArray, IntArray, readonly
from ratt_opt.errors import InputError
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt.problem import Problem

__all__ = ["count_orders", "evaluation_bound", "evaluation_count", "fit_growth", "lazy_greedy_picks",
           "measured_growth", "running_time_entries"]  # fmt: skip


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
    most ``n_elements**2`` for any R and any sizes. ``n_elements`` is ``|U_V|``, ``sizes`` the (R,) number of elements
    of each greedy robot.
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
    """Fit a power law to evaluation counts; ``InputError`` for fewer than two sizes or a count that is not positive."""
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


LARGEST = 5
MOST_CONTROLS = 4
MEASURED_TEAMS = (4, 6, 9, 13, 19)
MEASURED_SEEDS = (0, 1)
N_TARGETS = 6


def running_time_entries() -> Iterator[EnumeratedEntry]:
    """Yield Theorem 2 as a bound on the number of evaluations, and its measured growth."""
    theorem2 = partial(EnumeratedEntry, label="thm:ratt_run_time", chain="theorems")
    yield theorem2(
        kind=EntryKind.THEOREM,
        statement="RATT evaluates f at most |U|^2 times, |U| the number of all controls",
        hypotheses="first greedy round reuses the single values; every order in which greedy robots may be picked",
        enumerate_cases=partial(count_orders, LARGEST),
    )
    yield theorem2(
        kind=EntryKind.MEASUREMENT,
        statement="on Section VI scenarios (log-det, 12 controls a robot) the count stays below |U|^2, and lazy "
        "evaluation finds the same plan",
        hypotheses=f"random_scenario(N, {N_TARGETS}, alpha_s=1, alpha_c=0, seed=s), N in {MEASURED_TEAMS}, "
        f"s in {MEASURED_SEEDS}",
        enumerate_cases=measured_growth,
    )


def count_orders(largest: int) -> Counted:
    """Count the evaluations for every team up to ``largest`` robots, number of baits and order of picks.

    The count depends on nothing else: every element once, then in each later round all elements of the robots left.
    """
    bad, count = [], 0
    for n_robots in range(1, largest + 1):
        for sizes in combinations_with_replacement(range(1, MOST_CONTROLS + 1), n_robots):
            total = sum(sizes)
            for n_greedy in range(n_robots + 1):
                for order in set(permutations(sizes, n_greedy)):
                    count += 1
                    evaluations = total + sum(rank * size for rank, size in enumerate(order))
                    if evaluations > min(total**2, evaluation_bound(total, order)):
                        bad.append(f"controls {sizes}, greedy robots picked in the order {order}: {evaluations}")
    verdict = Verdict.REFUTED if bad else Verdict.PROVED
    detail = (
        f"{count} orders counted, {len(bad)} above |U|^2; for any size: each of the R-1 later rounds takes at most |U| "
        "evaluations and R <= |U|"
    )
    sizes_text = f"N <= {largest}, 1 to {MOST_CONTROLS} controls each, any number of baits"
    return Counted(verdict=verdict, sizes=sizes_text, detail=detail, cases=tuple(bad[:3]))


def measured_growth(teams: Sequence[int] = MEASURED_TEAMS, seeds: Sequence[int] = MEASURED_SEEDS) -> Counted:
    """Run RATT on scenarios of growing teams and fit power laws to plain and lazy evaluation counts."""
    bad, counts = [], []
    for n_robots in teams:
        for seed in seeds:
            problem = random_scenario(n_robots, N_TARGETS, alpha_s=1, alpha_c=0, seed=seed).problem("logdet")
            found = evaluation_count(problem)
            counts.append(found)
            if found.measured > min(found.elements**2, found.bound) or not found.same_plan:
                bad.append(f"N = {n_robots}, seed {seed}: {found}")
    elements = [found.elements for found in counts]
    plain = fit_growth(elements, [found.measured for found in counts])
    lazy = fit_growth(elements, [found.lazy for found in counts])
    detail = (
        f"{len(counts)} runs, |U| = {min(elements)} to {max(elements)}; plain greedy {plain.factor:.3g} "
        f"|U|^{plain.exponent:.3f}, at most {plain.largest_share:.3g} |U|^2; lazy {lazy.factor:.3g} "
        f"|U|^{lazy.exponent:.3f}, at most {lazy.largest_share:.3g} |U|^2; {len(bad)} runs break the statement"
    )
    verdict = Verdict.REFUTED if bad else Verdict.NO_VIOLATION
    return Counted(verdict=verdict, sizes=f"N in {tuple(teams)}", detail=detail, cases=tuple(bad[:3]))
