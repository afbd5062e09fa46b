"""Validation of CAA's n_max: against three other ways on complete graphs, and its error elsewhere.

Run as ``python -m analysis.caa_validation --out DIR [--largest N]``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import networkx as nx
import numpy as np

from analysis.tables import print_table, write_csv
from ratt_opt.attack.edge_cuts.smallest import smallest_largest_group
from ratt_opt.graph.survivor_sizes import caa

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


CASES = {12: ((2, 4, 6, 8, 11), (4, 3, 2)), 30: ((4, 6), (8, 5))}
"""Robots -> mean degrees, and shares of the links cut (1 / share)."""


def other_graphs(n_robots: int, n_graphs: int) -> list[dict[str, object]]:
    """Disk graphs: CAA reads the team as complete, the exact size does not."""
    rows: list[dict[str, object]] = []
    for degree in CASES[n_robots][0]:
        for share in CASES[n_robots][1]:
            sizes = [_disk_sizes(seed, degree, share, n_robots) for seed in range(n_graphs)]
            exact, formula = np.array(sizes).T
            rows.append(
                {
                    "n_robots": n_robots,
                    "complete": degree == n_robots - 1,
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


def conclusions(complete: list[dict[str, object]], others: list[dict[str, object]]) -> list[str]:
    """Summarise the tables, a line each."""

    def total(rows: list[dict[str, object]], name: str) -> int:
        return sum(int(str(row[name])) for row in rows)

    lines = [
        f"Complete graphs, N = 2..{LARGEST_PARTITIONED}: CAA differs from the integer partitions in "
        f"{total(complete, 'partitions_differ')} of {total(complete, 'budgets')} (N, alpha_c), from the enumeration of "
        f"set partitions in {total(complete, 'enumeration_differs')} of {total(complete, 'enumerated')}, from the "
        f"integer program in {total(complete, 'milp_differs')} of {total(complete, 'milp')} "
        f"({total(complete, 'milp_closed')} closed)."
    ]
    for n_robots in dict.fromkeys(row["n_robots"] for row in others):
        rows = [row for row in others if row["n_robots"] == n_robots and not row["complete"]]
        graphs, right = total(rows, "graphs"), total(rows, "caa_right")
        excess = np.mean([float(str(row["mean_caa_n_max"])) - float(str(row["mean_exact_n_max"])) for row in rows])
        most = max(total([row], "largest_overestimate") for row in rows)
        lines.append(
            f"Disk graphs of {n_robots} robots that are not complete: CAA is right in {right} of {graphs}; it takes "
            f"the largest group for {excess:.1f} robots too large on average, {most} at most, and so plans for too "
            "few attacks."
        )
    return lines


def _disk_sizes(seed: int, degree: int, share: int, n_robots: int) -> tuple[int, int]:
    """Exact and CAA's n_max of a random disk graph with the given mean degree, a share of its links cut."""
    position = np.random.default_rng(seed).random((n_robots, 2))
    distance = np.linalg.norm(position[:, None] - position, axis=-1)
    pairs = np.argwhere(np.triu(np.ones_like(distance), 1))
    nearest = pairs[np.argsort(distance[pairs[:, 0], pairs[:, 1]])][: n_robots * degree // 2]
    graph = nx.empty_graph(n_robots)
    graph.add_edges_from(nearest.tolist())
    alpha_c = len(nearest) // share
    return smallest_largest_group(graph, alpha_c, method="auto").upper, caa(n_robots, alpha_c).n_max


def main() -> None:
    """Run both studies, print the tables and what they say, and write the CSV files."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out"))
    parser.add_argument("--largest", type=int, default=12, help="largest team enumerated")
    parser.add_argument("--milp-seconds", type=float, default=20.0)
    parser.add_argument("--graphs", type=int, default=20)
    options = parser.parse_args()
    complete = complete_graphs(options.largest, options.milp_seconds)
    print_table("CAA on complete graphs: disagreements with other methods", complete)
    write_csv(options.out / "caa_complete.csv", complete)
    others = [row for n_robots in CASES for row in other_graphs(n_robots, options.graphs)]
    print_table("CAA on disk graphs (it assumes a complete graph)", others)
    write_csv(options.out / "caa_other_graphs.csv", others)
    print("\n" + "\n".join(conclusions(complete, others)))


if __name__ == "__main__":
    main()
