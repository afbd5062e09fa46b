"""Theorem 2 in the ledger: the bound on evaluations for every order of picks, and the growth measured."""

from __future__ import annotations

from functools import partial
from itertools import combinations_with_replacement, permutations
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Counted, EntryKind, EnumeratedEntry
from ratt_opt.audit.engine.decide import Verdict
from ratt_opt.audit.enumeration.evaluation_counts import evaluation_bound, evaluation_count, fit_growth
from ratt_opt.scenario.generator import random_scenario

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["count_orders", "measured_growth", "running_time_entries"]

LARGEST = 5
MOST_CONTROLS = 4
MEASURED_TEAMS = (4, 6, 9, 13, 19)
MEASURED_SEEDS = (0, 1)
N_TARGETS = 6


def running_time_entries() -> Iterator[EnumeratedEntry]:
    """Yield Theorem 2 as a bound on the number of evaluations, and its measured growth."""
    yield EnumeratedEntry(
        label="thm:ratt_run_time",
        kind=EntryKind.THEOREM,
        chain="theorems",
        statement="RATT evaluates f at most |U|^2 times, |U| the number of all controls",
        hypotheses="first greedy round reuses the single values; every order in which greedy robots may be picked",
        enumerate_cases=partial(count_orders, LARGEST),
    )
    yield EnumeratedEntry(
        label="thm:ratt_run_time",
        kind=EntryKind.MEASUREMENT,
        chain="theorems",
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
