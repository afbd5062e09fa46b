"""Refined plans of robots that must choose what to look at: how near to the best plan known, after how long.

Run as ``python -m analysis.benchmarks.refined [--robots 6 10 20] [--networks complete disk] [--objectives trace logdet]
[--seeds 10] [--limits 0.1 1 2] [--search 20]``. Each plan is attacked exactly afterwards; its worst case stands as a
share of the best known one, which ``solve_maxmin`` and the refined plans found. Seconds are of the clock.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

from analysis.benchmarks.limited_view import team
from analysis.tables import print_table
from ratt_opt import Problem, ratt, refined, solve_maxmin, worst_case_attack

TARGETS = {6: 8, 10: 10, 20: 20, 50: 50}
ATTACK_SECONDS = 20.0


def shares(problem: Problem, limits: list[float], search: float) -> list[float]:
    """Worst cases of RATT's plan and of refined plans as shares of the best known one."""
    refined(problem, time_limit=0.05)  # loads
    plans = [ratt(problem).elements, *(refined(problem, time_limit=limit).elements for limit in limits)]
    worst = [worst_case_attack(problem, plan, time_limit=ATTACK_SECONDS).lower for plan in plans]
    best = max(*worst, solve_maxmin(problem, gap=1e-4, time_limit=search).lower)
    return [value / best for value in worst]


def main() -> None:
    """Measure and print the smallest and the median share of each size, network and criterion."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, nargs="+", default=[6, 10, 20])
    parser.add_argument("--networks", nargs="+", choices=["complete", "disk"], default=["complete", "disk"])
    parser.add_argument("--objectives", nargs="+", choices=["trace", "logdet"], default=["trace", "logdet"])
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--limits", type=float, nargs="+", default=[0.1, 1.0, 2.0])
    parser.add_argument("--search", type=float, default=20.0, help="seconds of solve_maxmin")
    args = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for robots in args.robots:
        for network in args.networks:
            for name in args.objectives:
                drawn = (team(robots, TARGETS[robots], network, seed) for seed in range(args.seeds))
                found = np.array([shares(scenario.problem(name), args.limits, args.search) for scenario in drawn])
                row: dict[str, Any] = {"robots": robots, "network": network, "objective": name}
                for k, label in enumerate(["ratt", *(f"{limit:g}_s" for limit in args.limits)]):
                    row |= {
                        f"{label}_least": float(found[:, k].min()),
                        f"{label}_median": float(np.median(found[:, k])),
                    }
                rows.append(row)
                print(row, flush=True)
    print_table(f"Worst case as a share of the best known, {args.seeds} seeds a row", rows)


if __name__ == "__main__":
    main()
