"""Few cuts on networks that are hardly more than trees: the smallest largest group, and the worst attack with one cut.

Run as ``python -m analysis.benchmarks.few_cuts [--robots 20 127 300 750] [--more 0 3 10] [--cuts 1 2 3 5] [--seeds 3]
[--time-limit 10]``. The graphs are trees of preferential attachment with some links more, as providers' networks are.
Next to the automatic choice stands ``method="spreading"``, which is what larger teams got before there were cuts of
bridges. Seconds are of the processor.
"""

from __future__ import annotations

import argparse
from time import process_time
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from analysis.tables import print_table
from ratt_opt import graph_scenario, ratt, smallest_largest_group, worst_case_attack

if TYPE_CHECKING:
    from collections.abc import Callable

TARGETS = 10


def network(robots: int, more: int, seed: int) -> nx.Graph:
    """A tree, and ``more`` links between robots drawn at random."""
    rng = np.random.default_rng(seed)
    graph = nx.barabasi_albert_graph(robots, 1, seed=seed)
    while graph.number_of_edges() < robots - 1 + more:
        i, j = rng.integers(0, robots, 2).tolist()
        if i != j:
            graph.add_edge(i, j)
    return graph


def _timed(function: Callable[[], tuple[float, float]]) -> tuple[float, float, float]:
    began = process_time()
    lower, upper = function()
    return lower, upper, process_time() - began


def measure(robots: int, more: int, cuts: int, args: argparse.Namespace) -> dict[str, object]:
    """Open brackets and the longest time over some seeds, of both methods."""
    row: dict[str, object] = {"robots": robots, "more_links": more, "cuts": cuts}
    for name, method in (("", "auto"), ("spreading_", "spreading")):
        found = []
        for seed in range(args.seeds):
            graph = network(robots, more, seed)

            def sizes(graph: nx.Graph = graph, method: str = method) -> tuple[float, float]:
                size = smallest_largest_group(graph, cuts, method=method, time_limit=args.time_limit)
                return float(size.lower), float(size.upper)

            found.append(_timed(sizes))
        row |= {
            f"{name}open": sum(lower < upper for lower, upper, _ in found),
            f"{name}widest": int(max(upper - lower for lower, upper, _ in found)),
            f"{name}largest_s": max(seconds for *_, seconds in found),
        }
    return row


def measure_attack(robots: int, more: int, seed: int, time_limit: float) -> dict[str, object]:
    """The worst attack with one cut on RATT's plan, nobody blinded."""
    problem = graph_scenario(network(robots, more, seed), TARGETS, alpha_s=0, alpha_c=1, seed=seed).problem("trace")
    plan = ratt(problem).elements

    def attack() -> tuple[float, float]:
        found = worst_case_attack(problem, plan, time_limit=time_limit)
        return found.lower, found.upper

    lower, upper, seconds = _timed(attack)
    return {"robots": robots, "more_links": more, "seed": seed, "open_%": 100 * (upper - lower) / upper, "s": seconds}


def main() -> None:
    """Measure and print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, nargs="+", default=[20, 127, 300, 750])
    parser.add_argument("--more", type=int, nargs="+", default=[0, 3, 10])
    parser.add_argument("--cuts", type=int, nargs="+", default=[1, 2, 3, 5])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--time-limit", type=float, default=10.0)
    args = parser.parse_args()
    sizes = [measure(n, more, k, args) for n in args.robots for more in args.more for k in args.cuts]
    print_table(f"The smallest largest group, {args.seeds} seeds a row", sizes)
    attacks = [
        measure_attack(n, 3, seed, args.time_limit) for n in args.robots if n <= 300 for seed in range(args.seeds)
    ]
    print_table("The worst attack with one cut", attacks)


if __name__ == "__main__":
    main()
