"""Exact attacks and best plans on the networks that radio teams have.

Run as ``python -m analysis.benchmarks.networks [attack maxmin] [--robots 24 30 50 100] [--families dense ...]
[--budgets fifth third random] [--seeds K] [--first-seed K] [--seconds S] [--processor] [--objective trace]
[--log FILE]``. Attacked are RATT's plans, under three pairs of budgets: a fifth of the robots and 15 % of the links, a
third and 30 %, and random ones. Limits are wall time, or, with ``--processor``, what a busy machine gave.
"""

from __future__ import annotations

import argparse
import time
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import ratt_opt as ro
from analysis.benchmarks.timing import count_processor_time
from analysis.tables import append_csv, print_table
from ratt_opt._rounding import relative_gap
from ratt_opt.scenario.networks import NETWORK_FAMILIES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt import Problem

TARGETS = {24: 25, 30: 25, 50: 30, 100: 100}
SHARES = {"fifth": (0.2, 0.15), "third": (1 / 3, 0.3), "random": None}
"""Shares of the robots blinded and of the links cut; ``None`` draws both up to twice a third of them."""
GAP = 1e-6
"""Names a max-min search."""
WARM, WARM_LARGE = 24, 64
"""Robots of the first problems of each objective, not counted: modules are loaded then. Large teams are asked
who is inside first (``attack/thresholds/pricing.py``)."""


def instances(
    robots: list[int], families: list[str], seeds: range, objective: str, budgets: Iterable[str] = tuple(SHARES)
) -> Iterator[tuple[Any, ...]]:
    """Yield (robots, family, seed, problem)."""
    for n_robots, family, seed, name in product(robots, families, seeds, budgets):
        yield n_robots, family, seed, network_problem(family, n_robots, name, seed, objective)


def network_problem(family: str, robots: int, budgets: str, seed: int, objective: str) -> Problem:
    """The problem of one row; ``budgets`` : a name of ``SHARES``."""
    shares = SHARES[budgets] or np.random.default_rng([robots, seed]).uniform(0, 2 / 3, 2).tolist()
    options: dict[str, Any] = {"alpha_s": float(shares[0]), "alpha_c": float(shares[1]), "seed": seed}
    return ro.network_scenario(family, robots, TARGETS[robots], **options).problem(objective)


def attacked(problem: Problem, options: argparse.Namespace) -> dict[str, object]:
    """The exact attacker's bracket."""
    plan = ro.ratt(problem).elements
    began, worked = time.perf_counter(), time.process_time()
    exact = ro.worst_case_attack(problem, plan, time_limit=options.seconds)
    spent, worked = time.perf_counter() - began, time.process_time() - worked
    row: dict[str, object] = {"lower": exact.lower, "upper": exact.upper, "gap": relative_gap(exact.lower, exact.upper)}
    return row | {"stop": exact.stop.value, "nodes": exact.nodes, "seconds": spent, "processor_seconds": worked}


def planned(problem: Problem, options: argparse.Namespace) -> dict[str, object]:
    """The bracket of the best plan's worst case, and of the attack on the plan found."""
    began, worked = time.perf_counter(), time.process_time()
    best = ro.solve_maxmin(problem, gap=GAP, time_limit=options.seconds)
    spent, worked = time.perf_counter() - began, time.process_time() - worked
    row: dict[str, object] = {"lower": best.lower, "upper": best.upper, "gap": relative_gap(best.lower, best.upper)}
    known = best.lower if best.worst_case is None else best.worst_case.upper
    row |= {"plan_gap": relative_gap(best.lower, known), "stop": best.stop.value, "nodes": best.nodes}
    return row | {"seconds": spent, "processor_seconds": worked}


def measured(what: str, problem: Problem, options: argparse.Namespace) -> dict[str, object]:
    """One row."""
    row: dict[str, object] = {"alpha_s": problem.alpha_s, "alpha_c": problem.alpha_c}
    return row | (attacked(problem, options) if what == "attack" else planned(problem, options))


def warm_up(objective: str) -> None:
    """Load what searches load when they are first used."""
    for family in ("disk-6", "dense", "hubs"):  # hubs: nothing quicker than prices closes them
        problem = ro.network_scenario(family, WARM, 5, alpha_s=1 / 3, alpha_c=0.3, seed=0).problem(objective)
        ro.worst_case_attack(problem, ro.ratt(problem).elements, time_limit=2)
        ro.solve_maxmin(problem, time_limit=2)
    problem = ro.network_scenario("hubs", WARM_LARGE, 5, alpha_s=1 / 3, alpha_c=0.3, seed=0).problem(objective)
    ro.worst_case_attack(problem, ro.ratt(problem).elements, time_limit=4)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="*", default=["attack"], help="attack, maxmin")
    parser.add_argument("--robots", type=int, nargs="*", default=[24, 30], choices=sorted(TARGETS))
    parser.add_argument("--families", nargs="*", default=list(NETWORK_FAMILIES), choices=list(NETWORK_FAMILIES))
    parser.add_argument("--budgets", nargs="*", default=list(SHARES), choices=list(SHARES))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of one call")
    parser.add_argument("--processor", action="store_true", help="count seconds of the processor, on a busy machine")
    parser.add_argument("--objective", default="trace", choices=("trace", "logdet", "maxeig"))
    parser.add_argument("--log", type=Path, help="CSV file to which every row is appended as it ends")
    return parser.parse_args()


def main() -> None:
    """Print a table for attacks and one for best plans; every row is appended to the log as it ends."""
    options = _options()
    if options.processor:
        count_processor_time()
    warm_up(options.objective)
    rows: dict[str, list[dict[str, object]]] = {what: [] for what in options.what}
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    asked = instances(options.robots, options.families, seeds, options.objective, options.budgets)
    for n_robots, family, seed, problem in asked:
        for what, table in rows.items():
            row = {"robots": n_robots, "family": family, "seed": seed} | measured(what, problem, options)
            table.append(row)
            if options.log is not None:
                append_csv(options.log.with_stem(f"{options.log.stem}_{what}"), row)
    for what, table in rows.items():
        print_table(f"On networks: {what}, limit {options.seconds:g} s", table)


if __name__ == "__main__":
    main()
