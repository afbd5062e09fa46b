"""Costs of planning by messages as powers of the team's size: ``python -m analysis.decentralised.costs --seeds 1``.

Five families of networks; a least-squares line through the logarithms of messages, bytes and decision time, with
its 95 % interval (Student's t).
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np
from scipy.stats import linregress, t

from ratt_opt.decentralised.plan import decentralised_ratt
from ratt_opt.problem import Problem
from ratt_opt.setfunctions.criteria.trace import TraceObjective

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.decentralised.plan import DecentralisedPlan

__all__ = ["FAMILIES", "exponent", "plan_of", "table"]

FAMILIES: dict[str, Callable[[int, int], nx.Graph]] = {
    "path": lambda n, _: nx.path_graph(n),
    "random tree": lambda n, seed: nx.random_labeled_tree(n, seed=seed),
    "ring": lambda n, _: nx.cycle_graph(n),
    "degree 8": lambda n, seed: nx.random_regular_graph(8, n, seed=seed),
    "complete": lambda n, _: nx.complete_graph(n),
}
SIZES = (12, 25, 50, 100)
TARGETS, CONTROLS, BLINDED = 4, 3, 2
COSTS = ("messages", "bytes", "decision_time")


def plan_of(family: str, n: int, seed: int) -> DecentralisedPlan:
    """Plan of one team of random rank-one sensors, two of which may be blinded; no link can be cut."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(n * CONTROLS, TARGETS, 2, 1))
    f = TraceObjective(np.tile(np.eye(2), (TARGETS, 1, 1)), rows @ rows.swapaxes(-1, -2))
    problem = Problem(f, np.repeat(np.arange(n), CONTROLS), FAMILIES[family](n, seed), BLINDED, 0)
    return decentralised_ratt(problem)


def exponent(sizes: list[int], costs: list[float]) -> tuple[float, float]:
    """Power of the size, and half the width of its 95 % interval."""
    fit = linregress(np.log(sizes), np.log(costs))
    return float(fit.slope), float(fit.stderr * t.ppf(0.975, len(sizes) - 2))


def table(seeds: int) -> list[str]:
    """Rows of a Markdown table, a family a row."""
    lines = [
        "| network | messages | bytes | decision time | 100 robots: messages, megabytes, seconds |",
        "| --- | --- | --- | --- | --- |",
    ]
    for family in FAMILIES:
        runs = [(n, plan_of(family, n, seed)) for n in SIZES for seed in range(seeds)]
        sizes = [n for n, _ in runs]
        fits = [exponent(sizes, [float(getattr(plan, cost)) for _, plan in runs]) for cost in COSTS]
        powers = " | ".join(f"{power:.2f} ± {half:.2f}" for power, half in fits)
        last = [np.mean([getattr(plan, cost) for n, plan in runs if n == SIZES[-1]]) for cost in COSTS]
        lines.append(f"| {family} | {powers} | {last[0]:,.0f}, {last[1] / 1e6:.1f}, {last[2]:.1f} |")
    return lines


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Costs of planning by messages")
    parser.add_argument("--seeds", type=int, default=1, help="teams of each size")
    print("\n".join(table(parser.parse_args().seeds)))


if __name__ == "__main__":
    main()
