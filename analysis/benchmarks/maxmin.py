"""The max-min search against a mixed-integer conic model and exhaustive search, and by team size.

Run as ``python -m analysis.benchmarks.maxmin [--robots 10 20 30 100] [--seeds K] [--cap S] [--seconds S]``. Times are
processor time, so that they mean the same on a loaded machine. At N = 10 the baselines are SCIP through cvxpy
(extra ``benchmarks``), stopped after ``--cap`` seconds, and exhaustive search, whose time a plan and outcome
is measured at N = 4 and 5.
"""

from __future__ import annotations

import argparse
import sys
import time
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from analysis.benchmarks.conic_model import solve_conic_model
from analysis.tables import print_table
from ratt_opt._rounding import relative_gap
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.maxmin.solve import solve_maxmin

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import TypeVar

    from ratt_opt.problem import Problem

    T = TypeVar("T")

SETTINGS = {
    10: (15, ((3, 11), (5, 15), (6, 22)), (1e-9,)),
    20: (20, ((6, 47), (10, 63), (13, 95)), (1e-6,)),
    30: (25, ((10, 108), (15, 145), (20, 217)), (1e-4, 1e-6)),
    100: (100, ((30, 0), (30, 1000)), (1e-6,)),
}
"""Robots -> targets, budgets (sensing, links) and gaps to reach."""
SMALL = ((4, 1, 3), (4, 2, 4), (5, 1, 4), (5, 2, 6))
"""(N, sensing, links) at which exhaustive search is timed."""


def timed(run: Callable[[], T]) -> tuple[T, float]:
    """The result of one call and its processor time [s]."""
    began = time.process_time()
    result = run()
    return result, time.process_time() - began


def by_team_size(robots: int, objectives: Iterable[str], seeds: int, seconds: float) -> list[dict[str, object]]:
    """Time and gap of the search, median and worst over the seeds."""
    n_targets, budgets, gaps = SETTINGS[robots]
    rows: list[dict[str, object]] = []
    for objective in objectives:
        for alpha_s, alpha_c in budgets:
            for gap in gaps:
                times, left, nodes = [], [], []
                for seed in range(seeds):
                    problem = paper_problem(robots, n_targets, (alpha_s, alpha_c), seed, objective)
                    result, spent = timed(lambda p=problem, g=gap: solve_maxmin(p, gap=g, time_limit=seconds))  # type: ignore[misc]
                    times.append(spent)
                    left.append(relative_gap(result.lower, result.upper))
                    nodes.append(result.nodes)
                rows.append(
                    {
                        "robots": robots,
                        "targets": n_targets,
                        "objective": objective,
                        "alpha_s": alpha_s,
                        "alpha_c": alpha_c,
                        "asked_gap": gap,
                        "seeds": seeds,
                        "median_s": float(np.median(times)),
                        "worst_s": max(times),
                        "worst_gap": max(left),
                        "reached": f"{sum(g <= gap * (1 + 1e-9) for g in left)}/{seeds}",
                        "most_nodes": max(nodes),
                    }
                )
                print(".", end="", file=sys.stderr, flush=True)
    return rows


def against_baselines(cap: float) -> list[dict[str, object]]:
    """N = 10, trace: ours to 1e-9 against the conic model and exhaustive search."""
    rate = exhaustive_rate()
    n_targets, budgets, (gap,) = SETTINGS[10]
    rows: list[dict[str, object]] = []
    for alpha_s, alpha_c in budgets:
        problem = paper_problem(10, n_targets, (alpha_s, alpha_c), 0, "trace")
        solve_maxmin(problem, gap=gap)  # imports
        result, ours = timed(lambda p=problem: solve_maxmin(p, gap=gap))  # type: ignore[misc]
        conic, theirs = timed(lambda p=problem: solve_conic_model(p, cap))  # type: ignore[misc]
        plans = float(np.prod([float(len(choice)) for choice in problem.choices]))
        exhaustive = rate * plans * outcome_count(problem)
        rows.append(
            {
                "alpha_s": alpha_s,
                "alpha_c": alpha_c,
                "ours_s": ours,
                "gap": relative_gap(result.lower, result.upper),
                "lower": result.lower,
                "conic_s": theirs,
                "conic_status": conic.status,
                "conic_lower": conic.lower,
                "conic_upper": conic.upper,
                "conic_over_ours": theirs / ours,
                "exhaustive_s": exhaustive,
                "exhaustive_over_ours": exhaustive / ours,
            }
        )
    return rows


def exhaustive_rate() -> float:
    """Seconds of exhaustive search a plan and outcome: the smallest of those measured at N = 4 and 5."""
    rates = []
    for robots, alpha_s, alpha_c in SMALL:
        problem = paper_problem(robots, 15, (alpha_s, alpha_c), 0, "trace")
        result, spent = timed(lambda p=problem: exhaustive_optimum(p))  # type: ignore[misc]
        rates.append(spent / result.nodes / outcome_count(problem))
        each = f"{spent:.3g} s, {rates[-1]:.3g} s a plan and outcome"
        print(f"exhaustive search, N = {robots} ({alpha_s}, {alpha_c}): {each}")
    return min(rates)


def outcome_count(problem: Problem) -> int:
    """Number of non-dominated outcomes."""
    return sum(1 for _ in islice(non_dominated_outcomes(problem.threat), 10**6))


def paper_problem(robots: int, targets: int, budgets: tuple[int, int], seed: int, objective: str) -> Problem:
    """A random scenario of the paper's Section VI."""
    return random_scenario(robots, targets, alpha_s=budgets[0], alpha_c=budgets[1], seed=seed).problem(objective)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="+", default=[10, 20, 30], choices=sorted(SETTINGS))
    parser.add_argument("--objectives", nargs="+", default=["trace", "logdet", "maxeig"])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--cap", type=float, default=60.0, help="seconds after which SCIP is stopped; 0 leaves it out")
    parser.add_argument("--seconds", type=float, default=60.0, help="wall time limit of one search")
    given = parser.parse_args()
    if given.cap:
        print_table(f"N = 10, M = 15, trace, seed 0; SCIP stopped after {given.cap:g} s", against_baselines(given.cap))
    for robots in given.robots:
        print_table(f"N = {robots}", by_team_size(robots, given.objectives, given.seeds, given.seconds))


if __name__ == "__main__":
    main()
