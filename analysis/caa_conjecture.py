"""Test of CAA's conjecture that minimising the largest group is the worst attack, and quality of simple attackers.

CAA conjectures that it is. This study compares the exact worst case of RATT's plan with the best attack among those
that leave no group larger than ``n_max`` (up to ten robots), and with the bounded-rational, greedy and random
attackers. It does so for the paper's scenarios, for a grid of budgets at ten robots, and on graphs of limited
communication range. Values are shares of the exact one: 1 is as bad for the team.

Run as ``python -m analysis.caa_conjecture --out DIR [--seeds K] [--grid-seeds K] [--large-seeds K]``.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analysis.tables import print_table, write_csv
from ratt_opt._rounding import up
from ratt_opt.attack.edge_cuts.smallest import smallest_largest_group
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.attack.heuristics import bounded_rational_attack, greedy_attack, random_attack
from ratt_opt.attack.task import PlanValues
from ratt_opt.graph.threshold import ThresholdTest
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.setfunctions.criteria.registry import CRITERIA
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from ratt_opt.problem import Problem
    from ratt_opt.scenario.model import Scenario

SETTINGS = ((4, 4, 1, 3), (4, 4, 2, 4), (10, 15, 3, 11), (10, 15, 5, 15), (10, 15, 6, 22))
"""(robots, targets, sensing attacks, link attacks) of the paper's Section VI."""

GRID = tuple((10, 15, alpha_s, alpha_c) for alpha_c in (9, 12, 16, 20, 24, 28, 33, 38) for alpha_s in (0, 2, 4, 6))
"""Budgets at ten robots: up to six blinded, and from one robot's links to nearly all 45."""

LARGE = ((20, 20, 6, 47), (20, 20, 10, 63), (30, 25, 10, 108), (30, 25, 15, 145))
SPARSE = ((10, 15, 2, 5, 4.0), (10, 15, 3, 8, 4.0), (30, 25, 5, 10, 6.0), (30, 25, 10, 20, 6.0))
"""Cases of sparse graphs, and the mean number of links of a robot: robots within a range are linked."""

LARGEST_SPLIT = 12
"""Most robots for which the attacks that minimise the largest group are searched."""

CLOSE = 1e-9


def evenly_split_value(problem: Problem, plan: np.ndarray) -> float:
    """Worst team value among the attacks whose groups have at most ``n_max`` robots (exact)."""
    table = PlanValues(problem, plan).table()
    n_max = smallest_largest_group(problem.communication, problem.alpha_c).n_max
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


def one_run(
    setting: tuple[int, int, int, int], objective: str, seed: int, degree: float | None = None
) -> dict[str, object]:
    """All attackers on RATT's plan for one scenario; on a graph of this mean degree if one is given."""
    n_robots, n_targets, alpha_s, alpha_c = setting
    scenario = random_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=0, seed=seed)
    if degree is not None:
        scenario = scenario.replace(communication_range=range_of(scenario, degree))
    problem = scenario.replace(alpha_c=alpha_c).problem(objective)
    plan = ratt(problem).elements
    exact = worst_case_attack(problem, plan)
    return {
        "n_robots": n_robots,
        "links": len(problem.communication.links),
        "alpha_s": alpha_s,
        "alpha_c": alpha_c,
        "objective": objective,
        "seed": seed,
        "worst": exact.lower,  # within 1e-9 of the upper end
        "even_split": evenly_split_value(problem, plan) if n_robots <= LARGEST_SPLIT else np.nan,
        "bounded_rational": bounded_rational_attack(problem, plan).upper,
        "greedy": greedy_attack(problem, plan).upper,
        "random": random_attack(problem, plan, seed=seed).upper,
    }


def range_of(scenario: Scenario, degree: float) -> float:
    """Communication range [m] that gives robots that many links on average."""
    position = np.array([(robot.x, robot.y) for robot in scenario.robots])
    distance = np.linalg.norm(position[:, None] - position, axis=-1)
    pairs = np.sort(distance[np.triu_indices(len(position), 1)])
    return float(pairs[round(len(position) * degree / 2) - 1]) * (1 + 1e-9)


SHARES = ("even_split", "bounded_rational", "greedy", "random")


def share(runs: list[dict[str, object]], name: str) -> np.ndarray:
    """(R,) value that one attacker leaves, over the exact worst case."""
    return np.array([float(str(run[name])) / float(str(run["worst"])) for run in runs])


def summary(runs: list[dict[str, object]]) -> list[dict[str, object]]:
    """One row per setting and objective: how often the even split is worst, and mean shares of the exact value."""
    rows: list[dict[str, object]] = []
    keys = ("n_robots", "alpha_s", "alpha_c", "objective")
    for key in dict.fromkeys(tuple(run[k] for k in keys) for run in runs):
        chosen = [run for run in runs if tuple(run[k] for k in keys) == key]
        row: dict[str, object] = dict(zip(keys, key, strict=True))
        split = share(chosen, "even_split")
        known = not np.isnan(split).any()
        row |= {"even_split_is_worst": f"{(split <= 1 + CLOSE).sum()}/{len(chosen)}" if known else ""}
        row |= {"largest_even_split": float(split.max()) if known else ""}
        for name in SHARES:
            row[f"mean_{name}"] = float(share(chosen, name).mean()) if known or name != "even_split" else ""
        rows.append(row)
    return rows


def used(runs: list[dict[str, object]]) -> list[str]:
    """Attackers that were run."""
    return [name for name in SHARES if not np.isnan(share(runs, name)).all()]


def grid(runs: list[dict[str, object]]) -> list[dict[str, object]]:
    """One row per link budget, one column per sensing budget: how often the even split is the worst attack."""
    rows: list[dict[str, object]] = []
    for alpha_c in dict.fromkeys(run["alpha_c"] for run in runs):
        row: dict[str, object] = {"alpha_c": alpha_c}
        for alpha_s in dict.fromkeys(run["alpha_s"] for run in runs):
            cell = share([run for run in runs if (run["alpha_s"], run["alpha_c"]) == (alpha_s, alpha_c)], "even_split")
            loss = f", mean {cell.mean():.3f}" if (cell > 1 + CLOSE).any() else ""
            row[f"alpha_s={alpha_s}"] = f"{(cell <= 1 + CLOSE).sum()}/{len(cell)}{loss}"
        rows.append(row)
    return rows


def conclusion(title: str, runs: list[dict[str, object]]) -> str:
    """Summarise the runs in one line."""
    said = []
    for name in used(runs):
        shares = share(runs, name)
        shares = shares[~np.isnan(shares)]
        hits, mean, worst = int((shares <= 1 + CLOSE).sum()), shares.mean(), float(shares.max())
        label = "minimising the largest group" if name == "even_split" else name.replace("_", "-")
        most = up(worst, 4)
        said.append(f"{label} is the worst attack in {hits}/{len(shares)} (leaves {mean:.3f} x, at most {most} x)")
    return f"{title}: " + "; ".join(said)


def main() -> None:
    """Run the study, print the tables and what they say, and write every run to a CSV file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out"))
    parser.add_argument("--seeds", type=int, default=20, help="scenarios per setting of the paper")
    parser.add_argument("--grid-seeds", type=int, default=5, help="scenarios per budget of the grid")
    parser.add_argument(
        "--large-seeds", type=int, default=5, help="scenarios of 20 and 30 robots, and on sparse graphs"
    )
    options = parser.parse_args()
    parts: dict[str, list[tuple[tuple[int, int, int, int], float | None, int]]] = {
        "paper": [(setting, None, options.seeds) for setting in SETTINGS],
        "grid": [(setting, None, options.grid_seeds) for setting in GRID],
        "large": [(setting, None, options.large_seeds) for setting in LARGE],
        "sparse": [(setting[:4], setting[4], options.large_seeds) for setting in SPARSE],
    }
    runs = {
        name: [
            one_run(setting, objective, seed, degree)
            for setting, degree, seeds in cases
            for objective in CRITERIA
            for seed in range(seeds)
        ]
        for name, cases in parts.items()
    }
    titles = {
        "paper": "Complete graphs, the paper's budgets",
        "grid": "Complete graphs of 10 robots, grid of budgets",
        "large": "Complete graphs of 20 and 30 robots",
        "sparse": "Graphs of limited range, 4 to 6 links a robot",
    }
    for name, part in runs.items():
        write_csv(options.out / f"caa_conjecture_{name}.csv", part)
        heading = (
            "attacks that minimise the largest group among the worst" if name == "grid" else "values over the exact"
        )
        print_table(f"{titles[name]}: {heading}", grid(part) if name == "grid" else summary(part))
    print()
    for name, part in runs.items():
        print(conclusion(titles[name], part))


if __name__ == "__main__":
    main()
