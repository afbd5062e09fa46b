"""Fewest cuts and smallest largest groups against published optima: processor seconds, and Gurobi's beside them.

Run as ``python -m analysis.benchmarks.fewest_cuts [--data ../shared/data/graph_partition] [--parts rows both public
robots large] [--time-limit 60] [--page docs/researchers/fewest_cuts.md]``. The rows are those of Papazaharias and
Walteros, Mathematical Programming Computation (2022), whose file may not be shipped: ``instances.jsonl`` and
``bus494.dat``. A row with two published values contradicts itself.
"""

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np

from analysis.tables import print_table
from ratt_opt import fewest_cuts, smallest_largest_group

SHARES = (0.05, 0.10, 0.25, 0.50)


def published(data: Path) -> list[dict[str, Any]]:
    """The published rows."""
    return [json.loads(line) for line in (data / "instances.jsonl").read_text(encoding="utf-8").splitlines()]


def network_of(row: dict[str, Any]) -> nx.Graph:
    """The network of a row, with ``weight`` of links and ``size`` of robots if the row has them."""
    graph = nx.empty_graph(row["n"])
    graph.add_edges_from(tuple(link) for link in row["links"])
    if "weights" in row:
        weights = {tuple(e): w for e, w in zip(row["links"], row["weights"], strict=True)}
        nx.set_edge_attributes(graph, weights, "weight")
        nx.set_node_attributes(graph, dict(enumerate(row["sizes"])), "size")
    return graph


def every_row(rows: list[dict[str, Any]], seconds: float) -> list[dict[str, object]]:
    """Our bracket of each row beside the published value and the seconds of the quickest and slowest formulation."""
    found = []
    for row in rows:
        weights, sizes = ("weight", "size") if "weights" in row else (None, None)
        began = time.process_time()
        ours = fewest_cuts(network_of(row), row["size"], weights=weights, sizes=sizes, time_limit=seconds)
        found.append(
            {
                "table": row["table"],
                "graph": row["graph"],
                "size": row["size"],
                "published": " ".join(f"{value:g}" for value in row["published"]),
                "ours": f"[{ours.lower}, {ours.upper}]",
                "is_exact": ours.is_exact,
                "agrees": ours.is_exact and ours.upper in row["published"],
                "s": time.process_time() - began,
                "gurobi_s": f"{min(row['seconds'].values()):.3g} to {max(row['seconds'].values()):.3g}",
            }
        )
    return found


def both_directions(rows: list[dict[str, Any]], seconds: float) -> list[dict[str, object]]:
    """Test whether ``n_max(k*) <= r < n_max(k* - 1)`` for rows without weights, k* the fewest cuts."""
    found = []
    for row in rows:
        if "weights" in row:
            continue
        graph, size = network_of(row), row["size"]
        began = time.process_time()
        fewest = fewest_cuts(graph, size, time_limit=seconds).upper
        enough = smallest_largest_group(graph, int(fewest), time_limit=seconds)
        short = smallest_largest_group(graph, int(fewest) - 1, time_limit=seconds) if fewest else None
        holds = enough.upper <= size and (short is None or size < short.lower)
        s = time.process_time() - began
        found.append({"graph": row["graph"], "size": size, "cuts": fewest, "holds": holds, "s": s})
    return found


def public_networks(rows: list[dict[str, Any]]) -> Iterator[tuple[str, nx.Graph]]:
    """The five networks whose links are cut by shares."""
    yield "karate", nx.karate_club_graph()
    yield "davis", nx.davis_southern_women_graph()
    yield "florentine", nx.florentine_families_graph()
    yield "les miserables", nx.les_miserables_graph()
    yield "dolphins", network_of(next(row for row in rows if row["graph"] == "real-3" and row["n"] == 62))


def disk_network(n_robots: int, degree: float, seed: int = 1) -> nx.Graph:
    """A connected disk graph of about that mean degree: parts are joined by their nearest pairs."""
    position = np.random.default_rng(seed).random((n_robots, 2))
    distance = np.linalg.norm(position[:, None] - position, axis=-1)
    radius = np.sort(distance[np.triu_indices(n_robots, 1)])[int(n_robots * degree / 2) - 1]
    graph = nx.empty_graph(n_robots)
    graph.add_edges_from(np.argwhere(np.triu(distance <= radius, 1)).tolist())
    while not nx.is_connected(graph):
        part = sorted(next(nx.connected_components(graph)))
        rest = sorted(set(graph) - set(part))
        i, j = np.unravel_index(distance[np.ix_(part, rest)].argmin(), (len(part), len(rest)))
        graph.add_edge(part[i], rest[j])
    return graph


def team_networks(n_robots: int) -> Iterator[tuple[str, nx.Graph]]:
    """Disk graphs of mean degree 6 and small worlds of degree 4."""
    yield f"disk {n_robots}", disk_network(n_robots, 6.0)
    yield f"small world {n_robots}", nx.connected_watts_strogatz_graph(n_robots, 4, 0.2, seed=1)


def sizes_of(name: str, graph: nx.Graph, cuts: list[int], seconds: float) -> list[dict[str, object]]:
    """The bracket of the smallest largest group for each number of cut links."""
    graph, found = nx.convert_node_labels_to_integers(graph), []
    for k in cuts:
        began = time.process_time()
        ours = smallest_largest_group(graph, k, time_limit=seconds)
        s, bracket = time.process_time() - began, f"[{ours.lower}, {ours.upper}]"
        row = {"network": name, "robots": len(graph), "cuts": k, "n_max": bracket, "is_exact": ours.is_exact, "s": s}
        print(row, flush=True)
        found.append(row | {"stop": ours.stop.value})
    return found


def by_shares(name: str, graph: nx.Graph, seconds: float) -> list[dict[str, object]]:
    """Measure the smallest largest group for the shares of the links in ``SHARES``."""
    return sizes_of(name, graph, [round(share * graph.number_of_edges()) for share in SHARES], seconds)


def large_networks(data: Path, seconds: float) -> list[dict[str, object]]:
    """Few cuts: the 494-bus grid, and disks of mean degree 3."""
    lines = (data / "bus494.dat").read_text(encoding="utf-8").splitlines()
    n_robots, n_links = map(int, lines[0].split()[:2])
    grid = nx.empty_graph(n_robots)
    grid.add_edges_from(tuple(map(int, line.split()[:2])) for line in lines[1 : n_links + 1])
    found = sizes_of("494 bus", grid, [3, 5], seconds)
    for n in (300, 1000):
        found += sizes_of(f"disk {n}, degree 3", disk_network(n, 3.0), [3], seconds)
    return found


PAGE = """# Fewest cuts: published optima beside ours

Instances of Papazaharias and Walteros, *Solving Graph Partitioning on Sparse Graphs*, Mathematical Programming
Computation (2022): the least number, or weight, of links whose removal leaves groups of at most `size`. Their seconds
are Gurobi's, of the quickest and of the slowest of their formulations; ours are of one processor. A row with two
published values contradicts itself; both were printed with a gap of 0. {summary}

`python -m analysis.benchmarks.fewest_cuts --parts rows --page docs/researchers/fewest_cuts.md`

| table | graph | size | published | ours | exact | seconds | Gurobi's seconds |
| --- | --- | --- | --- | --- | --- | --- | --- |
"""


def write_page(path: Path, found: list[dict[str, object]], summary: str) -> None:
    """Write all rows as a page."""
    lines = []
    for row in found:
        cells = [row["table"], row["graph"], row["size"], row["published"], row["ours"]]
        cells += ["yes" if row["is_exact"] else "no", f"{row['s']:.2f}", row["gurobi_s"]]
        lines.append("| " + " | ".join(map(str, cells)) + " |\n")
    path.write_text(PAGE.format(summary=summary) + "".join(lines), encoding="utf-8")


def main() -> None:
    """Print a table for each part."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=Path("../shared/data/graph_partition"))
    parts = ["rows", "both", "public", "robots", "large"]
    parser.add_argument("--parts", nargs="+", choices=parts, default=parts)
    parser.add_argument("--time-limit", type=float, default=60.0)
    parser.add_argument("--page", type=Path, help="Write the table of rows there, as Markdown.")
    options = parser.parse_args()
    rows, seconds = published(options.data), options.time_limit
    if "rows" in options.parts:
        found = every_row(rows, seconds)
        print_table("Fewest cuts of the published rows", found)
        exact, slowest = sum(bool(row["is_exact"]) for row in found), max(float(str(row["s"])) for row in found)
        agree, total = sum(bool(row["agrees"]) for row in found), sum(float(str(row["s"])) for row in found)
        summary = f"Of {len(found)} rows {exact} are exact, {agree} agree; slowest {slowest:.2f} s, all {total:.1f} s."
        print(summary)
        if options.page:
            write_page(options.page, found, summary)
    if "both" in options.parts:
        found = both_directions(rows, seconds)
        print_table("n_max(k*) <= r < n_max(k* - 1)", found)
        print(f"{sum(bool(row['holds']) for row in found)} of {len(found)} hold")
    if "public" in options.parts:
        found = [row for name, graph in public_networks(rows) for row in by_shares(name, graph, seconds)]
        print_table("Smallest largest group of public networks", found)
    if "robots" in options.parts:
        nets = [*team_networks(50), *team_networks(100)]
        print_table("Of teams", [row for name, graph in nets for row in by_shares(name, graph, seconds)])
    if "large" in options.parts:
        print_table("Few cuts of large networks", large_networks(options.data, seconds))


if __name__ == "__main__":
    main()
