"""Measured coordinates alone: tracks of positions and velocities whose sensors measure positions only.

Run as ``python -m analysis.benchmarks.measured_coordinates [--robots 10 20] [--objectives ...] [--seeds 3]
[--time-limit 10]``. Both columns hold the best plan of the same problem: searched in all four coordinates, and in the
two that are measured, which is what ``solve_maxmin`` does.
"""

from __future__ import annotations

import argparse
from time import process_time
from typing import TYPE_CHECKING

import numpy as np

from analysis.tables import print_table
from ratt_opt import LogDetObjective, Problem, TraceObjective, random_scenario
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.solve import solve_in_coordinates, solve_maxmin

if TYPE_CHECKING:
    from ratt_opt import MaxMinResult

TARGETS = {5: 8, 10: 15, 20: 20}
BUDGETS = {5: (1, 3), 10: (3, 11), 20: (6, 47)}
CRITERIA = {"trace": TraceObjective, "logdet": LogDetObjective}


def tracks(robots: int, name: str, seed: int) -> Problem:
    """A random team whose targets have a velocity too, correlated with the position; sensors tell the position."""
    alpha_s, alpha_c = BUDGETS[robots]
    planar = random_scenario(robots, TARGETS[robots], alpha_s=alpha_s, alpha_c=alpha_c, seed=seed).problem(name)
    positions = planar.information_objective
    rng = np.random.default_rng(seed)
    prior = np.zeros((positions.n_targets, 4, 4))
    prior[:, :2, :2] = positions.prior
    mix = rng.normal(size=(positions.n_targets, 2, 2)) / 2
    prior[:, 2:, :2] = mix @ positions.prior
    prior[:, :2, 2:] = np.swapaxes(prior[:, 2:, :2], -1, -2)
    prior[:, 2:, 2:] = mix @ positions.prior @ np.swapaxes(mix, -1, -2) + np.eye(2)
    information = np.zeros((positions.n, positions.n_targets, 4, 4))
    information[..., :2, :2] = positions.information
    return Problem(CRITERIA[name](prior, information), planar.robot, planar.graph, alpha_s, alpha_c)


def measure(problem: Problem, time_limit: float) -> dict[str, object]:
    """Seconds and relative gaps of both."""
    began = process_time()
    whole = solve_in_coordinates(problem, Budget.inside(None, time_limit))
    between = process_time()
    measured = solve_maxmin(problem, time_limit=time_limit)
    ended = process_time()
    apart = max(0.0, whole.lower - measured.upper, measured.lower - whole.upper)
    return {
        "all_s": between - began,
        "all_gap": _gap(whole),
        "measured_s": ended - between,
        "measured_gap": _gap(measured),
        "brackets_apart": apart,
    }


def _gap(result: MaxMinResult) -> float:
    return (result.upper - result.lower) / result.upper


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="*", default=[10, 20], choices=sorted(BUDGETS))
    parser.add_argument("--objectives", nargs="*", default=list(CRITERIA), choices=list(CRITERIA))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--time-limit", type=float, default=10.0)
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    for robots in options.robots:
        for name in options.objectives:
            for seed in range(options.seeds):
                cell: dict[str, object] = {"robots": robots, "objective": name, "seed": seed}
                rows.append(cell | measure(tracks(robots, name, seed), options.time_limit))
    print_table("The best plan in all four coordinates and in the two that are measured", rows)


if __name__ == "__main__":
    main()
