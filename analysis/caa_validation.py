"""Is CAA's n_max right? Against three other ways on complete graphs, and how far off it is elsewhere.

Run as ``python -m analysis.caa_validation --out DIR [--largest N]``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import networkx as nx
import numpy as np

from analysis.tables import print_table, write_csv
from ratt_opt.graph.caa import caa
from ratt_opt.graph.largest_group import smallest_largest_group

LARGEST_PARTITIONED = 30


def complete_graphs(largest_enumerated: int, milp_seconds: float) -> list[dict[str, object]]:
    """One row per team size: budgets tried and disagreements with CAA, by method."""
    rows: list[dict[str, object]] = []
    for n_robots in range(2, LARGEST_PARTITIONED + 1):
        graph = nx.complete_graph(n_robots)
        budgets = range(graph.number_of_edges() + 1)
        row: dict[str, object] = {"n_robots": n_robots, "budgets": len(budgets)}
        row["partitions_differ"] = sum(_differs(graph, alpha_c, "partitions") for alpha_c in budgets)
        enumerated = budgets if n_robots <= largest_enumerated else range(0)
        row["enumerated"] = len(enumerated)
        row["enumeration_differs"] = sum(_differs(graph, alpha_c, "enumeration") for alpha_c in enumerated)
        rows.append(row | _milp_sample(graph, milp_seconds))
    return rows


def _differs(graph: nx.Graph, alpha_c: int, method: str) -> bool:
    found = smallest_largest_group(graph, alpha_c, method=method)
    return not (found.is_exact and found.n_max == caa(graph.number_of_nodes(), alpha_c).n_max)


def _milp_sample(graph: nx.Graph, seconds: float) -> dict[str, object]:
    """Three budgets: a quarter, a third and a half of the links; a bracket that misses CAA counts as a difference."""
    n_robots, links = graph.number_of_nodes(), graph.number_of_edges()
    budgets = [links // 4, links // 3, links // 2] if n_robots in {4, 6, 8, 10, 15, 20} else []
    formula = [caa(n_robots, alpha_c).n_max for alpha_c in budgets]
    found = [smallest_largest_group(graph, alpha_c, method="milp", time_limit=seconds) for alpha_c in budgets]
    return {
        "milp": len(found),
        "milp_closed": sum(f.claimed_lower == f.upper for f in found),
        "milp_differs": sum(not f.lower <= n <= f.upper for n, f in zip(formula, found, strict=True)),
    }


def other_graphs(n_graphs: int) -> list[dict[str, object]]:
    """Disk graphs of 12 robots: CAA reads the team as complete, the exact size does not."""
    rows: list[dict[str, object]] = []
    for degree in (2, 4, 6, 8, 11):
        for share in (4, 3, 2):
            sizes = [_disk_sizes(seed, degree, share) for seed in range(n_graphs)]
            exact, formula = np.array(sizes).T
            rows.append(
                {
                    "mean_degree": degree,
                    "links_cut": f"1/{share}",
                    "graphs": n_graphs,
                    "mean_exact_n_max": float(exact.mean()),
                    "mean_caa_n_max": float(formula.mean()),
                    "caa_right": int((exact == formula).sum()),
                    "largest_overestimate": int((formula - exact).max()),
                }
            )
    return rows


def _disk_sizes(seed: int, degree: int, share: int, n_robots: int = 12) -> tuple[int, int]:
    """Exact and CAA's n_max of a random disk graph with the given mean degree, a share of its links cut."""
    position = np.random.default_rng(seed).random((n_robots, 2))
    distance = np.linalg.norm(position[:, None] - position, axis=-1)
    pairs = np.argwhere(np.triu(np.ones_like(distance), 1))
    nearest = pairs[np.argsort(distance[pairs[:, 0], pairs[:, 1]])][: n_robots * degree // 2]
    graph = nx.empty_graph(n_robots)
    graph.add_edges_from(nearest.tolist())
    alpha_c = len(nearest) // share
    return smallest_largest_group(graph, alpha_c, method="enumeration").n_max, caa(n_robots, alpha_c).n_max


def main() -> None:
    """Run both studies, print the tables and write the CSV files."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out"))
    parser.add_argument("--largest", type=int, default=12, help="largest team enumerated")
    parser.add_argument("--milp-seconds", type=float, default=20.0)
    parser.add_argument("--graphs", type=int, default=20)
    options = parser.parse_args()
    complete = complete_graphs(options.largest, options.milp_seconds)
    print_table("CAA on complete graphs: disagreements with other methods", complete)
    write_csv(options.out / "caa_complete.csv", complete)
    others = other_graphs(options.graphs)
    print_table("CAA on disk graphs of 12 robots (it assumes a complete graph)", others)
    write_csv(options.out / "caa_other_graphs.csv", others)


if __name__ == "__main__":
    main()
