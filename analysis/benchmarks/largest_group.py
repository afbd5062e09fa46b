"""The smallest largest group on the networks that radio teams have: brackets and processor seconds.

Run as ``python -m analysis.benchmarks.largest_group [--robots 30 50 100 200] [--families disk-6 ...] [--seeds 0]
[--shares 0.15 0.3] [--seconds S]``. Beside each bracket the one of counting links and cheapest cuts alone, all that
the first edition knew of more than sixty robots.
"""

from __future__ import annotations

import argparse
import time

from analysis.tables import print_table
from ratt_opt import network_scenario, smallest_largest_group
from ratt_opt.scenario.networks import NETWORK_FAMILIES


def measured(family: str, robots: int, share: float, seed: int, seconds: float) -> dict[str, object]:
    """One graph and link budget."""
    graph = network_scenario(family, robots, 1, alpha_s=0, alpha_c=0, seed=seed).problem().communication
    alpha_c = int(share * len(graph.links))
    counted = smallest_largest_group(graph, alpha_c, method="counting", time_limit=seconds)
    began = time.process_time()
    found = smallest_largest_group(graph, alpha_c, time_limit=seconds)
    return {
        "family": family,
        "robots": robots,
        "links": len(graph.links),
        "cut": alpha_c,
        "seed": seed,
        "lower": found.lower,
        "upper": found.upper,
        "counted_lower": counted.lower,
        "counted_upper": counted.upper,
        "seconds": time.process_time() - began,
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="+", default=[30, 50, 100, 200])
    parser.add_argument("--families", nargs="+", choices=NETWORK_FAMILIES, default=["disk-6"])
    parser.add_argument("--shares", type=float, nargs="+", default=[0.15, 0.3], help="of the links cut")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    options = parser.parse_args()
    rows = [
        measured(family, robots, share, seed, options.seconds)
        for family in options.families
        for robots in options.robots
        for share in options.shares
        for seed in options.seeds
    ]
    print_table("The smallest largest group", rows)


if __name__ == "__main__":
    main()
