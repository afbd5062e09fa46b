"""One instance on several cores: seconds of one search by number of worker processes.

Run as ``python -m analysis.benchmarks.cores [--workers 1 2] [--robots 20] [--steps 4] [--seeds K] [--gap G]``. Teams
that have carried out their best plans for some steps are harder than those just drawn (``warm.py``). Besides wall time,
which only a quiet machine measures, the processor time of the caller and of its workers; and the gap that the verifier
accepts of the certificate, which of several workers is merged from their proofs.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.benchmarks.warm import BUDGETS, TARGETS, moved
from analysis.tables import print_table
from ratt_opt import certify, random_scenario, solve_maxmin, verify_certificate

if TYPE_CHECKING:
    from ratt_opt import MaxMinResult, Problem
    from ratt_opt.certificates.verifier.verified import Verified


def moved_problem(robots: int, steps: int, seed: int, gap: float) -> Problem:
    """A team of the paper that has carried out its best plans for some steps."""
    alpha_s, alpha_c = BUDGETS[robots]
    scenario = random_scenario(robots, TARGETS[robots], alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
    for _ in range(steps):
        scenario = moved(scenario, solve_maxmin(scenario.problem(), gap=gap).elements)
    return scenario.problem()


def measured(problem: Problem, gap: float, seconds: float, workers: int) -> tuple[MaxMinResult, dict[str, float]]:
    """A result, and its seconds of wall time, of the caller's processor and of its workers' processors."""
    children, own, began = workers_seconds(), time.process_time(), time.perf_counter()
    result = solve_maxmin(problem, gap=gap, time_limit=seconds, workers=workers)
    wall = time.perf_counter() - began
    return result, {
        "wall_s": wall,
        "caller_s": time.process_time() - own,
        "workers_s": workers_seconds() - children,
    }


def proved(problem: Problem, result: MaxMinResult) -> Verified:
    """What the verifier accepts of the result's certificate."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "certificate.json")
        certify(problem, result, path)
        return verify_certificate(path)


def workers_seconds() -> float:
    """Processor time of all processes that were started here and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--robots", type=int, default=20, choices=sorted(BUDGETS))
    parser.add_argument("--steps", type=int, default=4)
    parser.add_argument("--seeds", type=int, nargs="+", default=[0])
    parser.add_argument("--gap", type=float, default=1e-6)
    parser.add_argument("--seconds", type=float, default=600.0, help="limit of one search")
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for seed in options.seeds:
        problem = moved_problem(options.robots, options.steps, seed, options.gap)
        alone = None
        for workers in options.workers:
            result, seconds = measured(problem, options.gap, options.seconds, workers)
            alone = alone or seconds["wall_s"]
            row = {"seed": seed, "workers": workers, "nodes": result.nodes, **seconds}
            row |= {"speedup": alone / seconds["wall_s"], "stop": result.stop.name}
            claim = proved(problem, result)
            row |= {"proved_gap": claim.gap, "lower_proved": claim.lower_proved, "leaves": claim.upper_leaves}
            rows.append(row | {"lower": result.lower, "upper": result.upper})
            print(rows[-1], file=sys.stderr, flush=True)
    print_table(f"N = {options.robots}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}", rows)


if __name__ == "__main__":
    main()
