"""The exact attacker against plainer ones, on RATT's plan for the paper's scenarios.

Run as ``python -m analysis.benchmarks.attack [--robots 10 20 30] [--seeds K] [--seconds S]``.
Times are processor time; "plain" is the named slower way to the same answer, in the same run.
"""

from __future__ import annotations

import argparse
import time
from itertools import combinations
from math import comb
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from analysis.tables import print_table
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.graph.largest_group import smallest_largest_group
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.problem import Problem

SETTINGS = {
    10: (15, ((3, 11), (5, 15), (6, 22))),
    20: (20, ((6, 47), (10, 63), (13, 95))),
    30: (25, ((10, 108), (15, 145), (20, 217))),
    40: (30, ((13, 195), (20, 260), (26, 390))),
    60: (40, ((20, 442), (30, 590), (40, 885))),
    100: (100, ((33, 1237), (50, 1650))),
}
"""Robots -> targets and the budgets (sensing, links): a third, a half, two thirds; a quarter, a third, a half."""


def processor_seconds(run: Callable[[], object]) -> float:
    """Processor time of one call [s]."""
    began = time.process_time()
    run()
    return time.process_time() - began


def exact_attacks(robots: list[int], seeds: int, seconds: float) -> list[dict[str, object]]:
    """Time and gap of the exact attacker, worst over the seeds."""
    rows: list[dict[str, object]] = []
    for n_robots in robots:
        n_targets, budgets = SETTINGS[n_robots]
        for alpha_s, alpha_c in budgets:
            for objective in ("trace", "logdet", "maxeig"):
                times, gaps = [], []
                for seed in range(seeds):
                    scenario = random_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
                    problem = scenario.problem(objective)
                    plan = ratt(problem).elements
                    began = time.process_time()
                    result = worst_case_attack(problem, plan, time_limit=seconds)
                    times.append(time.process_time() - began)
                    gaps.append((result.upper - result.lower) / result.upper)
                rows.append(
                    {
                        "robots": n_robots,
                        "alpha_s": alpha_s,
                        "alpha_c": alpha_c,
                        "objective": objective,
                        "seeds": seeds,
                        "median_s": float(np.median(times)),
                        "worst_s": max(times),
                        "worst_gap": max(gaps),
                    }
                )
    return rows


def plain_enumeration(problem: Problem, plan: np.ndarray) -> float:
    """Every non-dominated outcome, one group at a time: the plain way at N = 10."""
    known: dict[frozenset[int], float] = {}
    worst = np.inf
    for outcome in non_dominated_outcomes(problem.threat):
        for group in outcome:
            if group not in known:
                known[group] = problem.objective(plan[sorted(group)])
        worst = min(worst, max(known[group] for group in outcome))
    return float(worst)


def plain_subsets(problem: Problem, plan: np.ndarray, size: int, count: int) -> float:
    """Seconds per set of ``size`` robots by vectorised evaluation, from the first ``count`` sets."""
    membership = np.zeros((count, problem.objective.n), dtype=np.bool_)
    for row, chosen in zip(membership, combinations(plan.tolist(), size), strict=False):
        row[list(chosen)] = True
    return processor_seconds(lambda: problem.objective.evaluate(membership)) / count


def against_plain() -> list[dict[str, object]]:
    """Ratios against the plain ways: outcomes at N = 10, all sets of the forced size (projected) at N = 20 and 30."""
    rows: list[dict[str, object]] = []
    for n_robots, size in ((10, 6), (20, 12), (30, 16)):
        n_targets, budgets = SETTINGS[n_robots]
        alpha_s, alpha_c = budgets[0]
        for objective in ("trace", "logdet"):
            scenario = random_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=0)
            problem = scenario.problem(objective)
            plan = ratt(problem).elements
            exact = processor_seconds(lambda p=problem, e=plan: worst_case_attack(p, e))  # type: ignore[misc]
            if n_robots == 10:
                name = "all non-dominated outcomes"
                plain = processor_seconds(lambda p=problem, e=plan: plain_enumeration(p, e))  # type: ignore[misc]
            else:
                name = f"all sets of {size} robots (projected)"
                plain = plain_subsets(problem, plan, size, 2000) * comb(n_robots, size)
            row: dict[str, object] = {"robots": n_robots, "objective": objective, "plain": name}
            rows.append(row | {"plain_s": plain, "exact_s": exact, "ratio": plain / exact})
    return rows


def evaluations() -> list[dict[str, object]]:
    """Set-function values asked for at N = 6 against one per raw attack."""
    problem = random_scenario(6, 6, alpha_s=2, alpha_c=5, seed=0).problem("trace")
    asked = worst_case_attack(problem, ratt(problem).elements).evaluations
    raw = comb(6, 2) * comb(15, 5)
    return [{"robots": 6, "raw_attacks": raw, "evaluations": asked, "ratio": raw / asked}]


def largest_groups(seconds: float) -> list[dict[str, object]]:
    """``n_max`` of random geometric graphs of 30 robots and mean degree 6 by the integer program."""
    rows: list[dict[str, object]] = []
    for seed in range(3):
        position = np.random.default_rng(seed).random((30, 2))
        distance = np.linalg.norm(position[:, None] - position, axis=-1)
        radius = np.sort(distance[np.triu_indices(30, 1)])[89]
        graph = nx.empty_graph(30)
        graph.add_edges_from(np.argwhere(np.triu(distance <= radius, 1)).tolist())
        for alpha_c in (1, 5, 10, 15, 20):
            began = time.process_time()
            found = smallest_largest_group(graph, alpha_c, method="milp", time_limit=seconds)
            row: dict[str, object] = {
                "seed": seed,
                "alpha_c": alpha_c,
                "checked_lower": found.lower,
                "claimed_lower": found.claimed_lower,
            }
            rows.append(row | {"n_max": found.n_max, "seconds": time.process_time() - began})
    return rows


def main() -> None:
    """Print every table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="*", default=[10, 20, 30], choices=sorted(SETTINGS))
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of one attack")
    options = parser.parse_args()
    small = random_scenario(13, 3, alpha_s=2, alpha_c=12, seed=0).problem("trace")
    compiled = processor_seconds(lambda: worst_case_attack(small, ratt(small).elements))
    print(f"First attack on a large team, with loading or compiling: {compiled:.2f} s")
    print_table("Exact attack on RATT's plan", exact_attacks(options.robots, options.seeds, options.seconds))
    print_table("Against the plain way", against_plain())
    print_table("Evaluations against raw attacks", evaluations())
    print_table("Smallest largest group by the integer program", largest_groups(30.0))


if __name__ == "__main__":
    main()
