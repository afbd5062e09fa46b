"""The exact attacker against plainer ones, on RATT's plan for the paper's scenarios.

Run as ``python -m analysis.benchmarks.attack [--robots 10 20 30] [--objectives trace] [--budgets 0]
[--seeds K] [--sparse-seeds K] [--first-seed S] [--seconds S] [--log FILE] [--attacks-only]``: any part of the table.
Times are processor time; "plain" is the named slower way to the same answer, in the same run.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from itertools import combinations
from math import comb
from pathlib import Path
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from analysis.tables import append_csv, print_table
from ratt_opt._rounding import relative_gap
from ratt_opt.attack.bounds import forced_group_bound
from ratt_opt.attack.edge_cuts.smallest import smallest_largest_group
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.attack.heuristics import greedy_attack
from ratt_opt.attack.task import AttackBracket, AttackTask, PlanValues
from ratt_opt.attack.team import Team
from ratt_opt.budget import Budget
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt import Scenario
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


def range_of(scenario: Scenario, degree: float) -> float:
    """Communication range [m] that gives robots that many links on average."""
    position = np.array([(robot.x, robot.y) for robot in scenario.robots])
    distance = np.linalg.norm(position[:, None] - position, axis=-1)
    pairs = np.sort(distance[np.triu_indices(len(position), 1)])
    return float(pairs[round(len(position) * degree / 2) - 1]) * (1 + 1e-9)


def processor_seconds(run: Callable[[], object]) -> float:
    """Processor time of one call [s]."""
    began = time.process_time()
    run()
    return time.process_time() - began


SPARSE = ((20, 6, 5, 10), (30, 6, 5, 10), (30, 6, 10, 20), (30, 10, 10, 30), (40, 6, 8, 12), (50, 6, 10, 12))
"""Robots, mean number of links a robot, budgets (sensing, links)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cases:
    """Attacks to time: every budget of each team size, each objective and seed."""

    robots: tuple[int, ...]
    objectives: tuple[str, ...]
    seeds: tuple[int, ...]
    budgets: tuple[int, ...]
    """Positions in the list of budgets of a team size."""

    def __iter__(self) -> Iterator[tuple[int, tuple[int, int], str, int]]:
        """Yield (robots, budgets, objective, seed)."""
        for n_robots in self.robots:
            for k, budget in enumerate(SETTINGS[n_robots][1]):
                if k in self.budgets:
                    yield from ((n_robots, budget, name, seed) for name in self.objectives for seed in self.seeds)


def exact_attack(
    n_robots: int, budget: tuple[int, int], objective: str, seed: int, seconds: float
) -> dict[str, object]:
    """Processor time and bracket of one exact attack on RATT's plan."""
    alpha_s, alpha_c = budget
    scenario = random_scenario(n_robots, SETTINGS[n_robots][0], alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
    problem = scenario.problem(objective)
    plan = ratt(problem).elements
    began = time.process_time()
    result = worst_case_attack(problem, plan, time_limit=seconds)
    spent = time.process_time() - began
    case = {"robots": n_robots, "alpha_s": alpha_s, "alpha_c": alpha_c, "objective": objective, "seed": seed}
    gap = relative_gap(result.lower, result.upper)
    answer = {"lower": result.lower, "upper": result.upper, "gap": gap, "stop": result.stop.value}
    return case | answer | {"nodes": result.nodes, "seconds": spent}


def exact_attacks(cases: Cases, seconds: float, log: Path | None = None) -> list[dict[str, object]]:
    """Time and gap of the exact attacker, worst over the seeds; every attack is appended to ``log`` as it ends."""
    runs = []
    for case in cases:
        runs.append(exact_attack(*case, seconds))
        if log is not None:
            append_csv(log, runs[-1])
    rows: list[dict[str, object]] = []
    keys = ("robots", "alpha_s", "alpha_c", "objective")
    for key in dict.fromkeys(tuple(run[k] for k in keys) for run in runs):
        chosen = [run for run in runs if tuple(run[k] for k in keys) == key]
        times, gaps = (np.array([float(str(run[name])) for run in chosen]) for name in ("seconds", "gap"))
        row: dict[str, object] = dict(zip(keys, key, strict=True))
        row |= {"seeds": len(chosen), "median_s": float(np.median(times)), "worst_s": float(times.max())}
        rows.append(row | {"median_gap": float(np.median(gaps)), "worst_gap": float(gaps.max())})
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


def sparse_attacks(seeds: int, seconds: float) -> list[dict[str, object]]:
    """Teams that hear each other within a range: the exact attacker against the bound by sizes alone and greedy."""
    rows: list[dict[str, object]] = []
    for n_robots, degree, alpha_s, alpha_c in SPARSE:
        for objective in ("trace", "logdet", "maxeig"):
            times, gaps, plain_gaps, greedy = [], [], [], []
            for seed in range(seeds):
                scenario = random_scenario(n_robots, 25, alpha_s=alpha_s, alpha_c=0, seed=seed)
                scenario = scenario.replace(communication_range=range_of(scenario, degree))
                problem = scenario.replace(alpha_c=alpha_c).problem(objective)
                plan = ratt(problem).elements
                began = time.process_time()
                exact = worst_case_attack(problem, plan, time_limit=seconds)
                times.append(time.process_time() - began)
                gaps.append(relative_gap(exact.lower, exact.upper))
                plain_gaps.append(_gap_by_sizes(problem, plan))
                greedy.append(greedy_attack(problem, plan).upper / exact.upper)
            row: dict[str, object] = {"robots": n_robots, "degree": degree, "alpha_s": alpha_s, "alpha_c": alpha_c}
            row |= {"objective": objective, "seeds": seeds, "median_s": float(np.median(times)), "worst_s": max(times)}
            row |= {"worst_gap": max(gaps), "plain_gap": float(np.median(plain_gaps))}
            rows.append(row | {"greedy_over_exact": float(np.mean(greedy))})
    return rows


def _gap_by_sizes(problem: Problem, plan: np.ndarray) -> float:
    """Relative width of the bracket that the forced group size and simple heuristics give."""
    first = greedy_attack(problem, plan)
    bracket = AttackBracket(first.attack, first.upper, 0.0)
    task = AttackTask(problem, PlanValues(problem, plan), bracket, Budget())
    forced_group_bound(task, Team.of(problem.objective, plan))
    return relative_gap(bracket.lower, bracket.upper)


def largest_groups(seconds: float) -> list[dict[str, object]]:
    """``n_max`` of random geometric graphs of 30 robots and mean degree 6: prices against the integer program."""
    rows: list[dict[str, object]] = []
    for seed in range(3):
        position = np.random.default_rng(seed).random((30, 2))
        distance = np.linalg.norm(position[:, None] - position, axis=-1)
        radius = np.sort(distance[np.triu_indices(30, 1)])[89]
        graph = nx.empty_graph(30)
        graph.add_edges_from(np.argwhere(np.triu(distance <= radius, 1)).tolist())
        for alpha_c in (1, 5, 10, 15, 20):
            row: dict[str, object] = {"seed": seed, "alpha_c": alpha_c}
            for method in ("auto", "milp"):
                began = time.process_time()
                found = smallest_largest_group(graph, alpha_c, method=method, time_limit=seconds)
                row |= {method: f"[{found.lower}, {found.upper}]", f"{method}_s": time.process_time() - began}
            rows.append(row | {"milp_claims": found.claimed_lower})
    return rows


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    names = ("trace", "logdet", "maxeig")
    parser.add_argument("--robots", type=int, nargs="*", default=[10, 20, 30], choices=sorted(SETTINGS))
    parser.add_argument("--objectives", nargs="*", default=names, choices=names)
    parser.add_argument("--budgets", type=int, nargs="*", default=[0, 1, 2], help="which budgets of each team size")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--sparse-seeds", type=int, default=3, help="seeds of each sparse graph")
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of one attack")
    parser.add_argument("--log", type=Path, help="CSV file to which every attack is appended as it ends")
    parser.add_argument("--attacks-only", action="store_true", help="leave out the comparisons with plain ways")
    return parser.parse_args()


def main() -> None:
    """Print every table."""
    options = _options()
    small = random_scenario(13, 3, alpha_s=2, alpha_c=12, seed=0).problem("trace")
    first = processor_seconds(lambda: worst_case_attack(small, ratt(small).elements))
    print(f"First attack on a large team, imports included: {first:.2f} s")
    cases = Cases(
        robots=tuple(options.robots),
        objectives=tuple(options.objectives),
        seeds=tuple(range(options.first_seed, options.first_seed + options.seeds)),
        budgets=tuple(options.budgets),
    )
    print_table("Exact attack on RATT's plan", exact_attacks(cases, options.seconds, options.log))
    if options.attacks_only:
        return
    print_table("Against the plain way", against_plain())
    print_table("Evaluations against raw attacks", evaluations())
    print_table("Smallest largest group: what is checked, and what the integer program claims", largest_groups(30.0))
    print_table("Exact attack on sparse graphs", sparse_attacks(options.sparse_seeds, options.seconds))


if __name__ == "__main__":
    main()
