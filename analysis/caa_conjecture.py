"""Is the attack that minimises the largest group also the worst attack? And how good are simple attackers?

CAA conjectures that it is. On RATT's plan for the paper's scenarios this study compares the exact worst case
with the best attack among those that leave no group larger than ``n_max``, and with the
bounded-rational, greedy and random attackers. Values are shares of the exact one: 1 is as bad for the team.

Run as ``python -m analysis.caa_conjecture --out DIR [--seeds K]``.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analysis.tables import print_table, write_csv
from ratt_opt.attackers.bounded_rational import bounded_rational_attack
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.greedy import greedy_attack
from ratt_opt.attackers.plan_values import PlanValues
from ratt_opt.attackers.random_attack import random_attack
from ratt_opt.graph.caa import caa
from ratt_opt.graph.threshold import ThresholdTest
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

SETTINGS = ((4, 4, 1, 3), (4, 4, 2, 4), (10, 15, 3, 11), (10, 15, 5, 15), (10, 15, 6, 22))
"""(robots, targets, sensing attacks, link attacks) of the paper's Section VI."""

CLOSE = 1e-9


def evenly_split_value(problem: Problem, plan: np.ndarray) -> float:
    """Worst team value among the attacks whose groups have at most ``n_max`` robots (exact)."""
    table = PlanValues(problem, plan).table()
    n_max = caa(problem.n_robots, problem.alpha_c).n_max
    test = ThresholdTest(problem.threat, table, largest_group=n_max)
    levels = np.unique(table)
    low, high = 0, len(levels) - 1
    while low < high:
        middle = (low + high) // 2
        if test.split(float(levels[middle])) is None:
            low = middle + 1
        else:
            high = middle
    return float(levels[low])


def one_run(setting: tuple[int, int, int, int], objective: str, seed: int) -> dict[str, object]:
    """All attackers on RATT's plan for one scenario."""
    n_robots, n_targets, alpha_s, alpha_c = setting
    problem = random_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed).problem(objective)
    plan = ratt(problem).elements
    exact = worst_case_attack(problem, plan).upper
    return {
        "n_robots": n_robots,
        "alpha_s": alpha_s,
        "alpha_c": alpha_c,
        "objective": objective,
        "seed": seed,
        "exact": exact,
        "even_split": evenly_split_value(problem, plan),
        "bounded_rational": bounded_rational_attack(problem, plan).upper,
        "greedy": greedy_attack(problem, plan).upper,
        "random": random_attack(problem, plan, seed=seed).upper,
    }


def summary(runs: list[dict[str, object]]) -> list[dict[str, object]]:
    """One row per setting and objective: how often the even split is worst, and mean shares of the exact value."""
    rows: list[dict[str, object]] = []
    keys = ("n_robots", "alpha_s", "alpha_c", "objective")
    for key in dict.fromkeys(tuple(run[k] for k in keys) for run in runs):
        chosen = [run for run in runs if tuple(run[k] for k in keys) == key]
        share = {
            name: np.array([float(str(run[name])) / float(str(run["exact"])) for run in chosen])
            for name in ("even_split", "bounded_rational", "greedy", "random")
        }
        row: dict[str, object] = dict(zip(keys, key, strict=True))
        row |= {"runs": len(chosen), "even_split_is_worst": int((share["even_split"] <= 1 + CLOSE).sum())}
        row |= {"largest_even_split": float(share["even_split"].max())}
        rows.append(row | {f"mean_{name}": float(values.mean()) for name, values in share.items()})
    return rows


def main() -> None:
    """Run the study, print the summary and write every run to a CSV file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out"))
    parser.add_argument("--seeds", type=int, default=20)
    options = parser.parse_args()
    runs = [
        one_run(setting, objective, seed)
        for setting in SETTINGS
        for objective in ("trace", "logdet", "maxeig")
        for seed in range(options.seeds)
    ]
    write_csv(options.out / "caa_conjecture.csv", runs)
    print_table("Attackers on RATT's plan, team value relative to the exact worst case", summary(runs))


if __name__ == "__main__":
    main()
