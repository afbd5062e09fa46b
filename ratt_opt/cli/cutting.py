"""``ratt-opt cuts``: the worst edge cuts of any network in a file."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ratt_opt.cli.options import TIME_LIMIT, JsonFlag
from ratt_opt.cli.terminal import WorkInterrupted, print_json, print_lines
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    import networkx as nx

    from ratt_opt.attack.edge_cuts.fewest import FewestCuts
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.largest_group.counting import LargestGroup

__all__ = ["cuts"]


def cuts(
    file: Annotated[Path, typer.Argument(help="GraphML, GML, GEXF, node-link JSON, or edges.", show_default=False)],
    largest_group: Annotated[
        float | None, typer.Option("--largest-group", help="Fewest cuts for groups of at most this size.")
    ] = None,
    k: Annotated[int | None, typer.Option("--cuts", help="Smallest largest group after this many cuts.")] = None,
    weights: Annotated[str | None, typer.Option("--weights", help="Edge attribute that a cut costs.")] = None,
    sizes: Annotated[str | None, typer.Option("--sizes", help="Node attribute that a group's size adds up.")] = None,
    certificate: Annotated[
        Path | None, typer.Option("--certificate", help="Write a proof of the lower end, for ratt-opt verify.")
    ] = None,
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds for the search.")] = TIME_LIMIT,
    as_json: JsonFlag = False,
) -> None:
    """Find the fewest links to cut for groups of a size, or the smallest size that a number of cuts leaves.

    Directions are dropped. An interrupt (Ctrl-C) prints the bracket so far and exits with 130.

    A certificate counts links, has prices of robots, lists groups or eliminates robots; the output says which, and what
    it proves. With --cuts it is about groups smaller by one: more links than that must be cut for these.
    """
    from ratt_opt.attack.edge_cuts.fewest import fewest_cuts
    from ratt_opt.attack.edge_cuts.smallest import smallest_largest_group
    from ratt_opt.budget import Stop
    from ratt_opt.graph.any_networkx import communication_graph
    from ratt_opt.scenario.graph_files import read_graph

    if (largest_group is None) == (k is None):
        raise InputError("--largest-group", "or --cuts must be given, one of them", "both" if k is not None else "none")
    if k is not None and (weights, sizes) != (None, None):
        raise InputError("--weights", "and --sizes must come with --largest-group", weights or sizes)
    given = read_graph(file)
    graph = communication_graph(given, parallel="refuse")
    found: FewestCuts | LargestGroup
    costs, loads = None, None
    if k is None:
        assert largest_group is not None
        costs = None if weights is None else _weights(given, graph, weights)
        loads = None if sizes is None else {i: graph.nodes[i].get(sizes) for i in graph}
        found = fewest_cuts(graph, largest_group, weights=costs, sizes=loads, time_limit=time_limit)
    else:
        found = smallest_largest_group(graph, k, time_limit=time_limit)
    document = _document(graph, found)
    if certificate is not None and found.stop is not Stop.INTERRUPTED:
        asked_of = {} if k is not None else {"weights": costs, "sizes": loads}
        document["certificate"] = _certified(graph, found, certificate, time_limit, asked_of)
    if as_json:
        asked = {"largest_group": largest_group} if k is None else {"cuts": k}
        print_json({"format": "ratt-opt cuts", "version": 1, **asked, **document})
    else:
        print_lines(_lines(document, "weight of the cut" if k is None else "smallest largest group"))
    if found.stop is Stop.INTERRUPTED:
        raise WorkInterrupted("interrupted; printed is what was found until then")


def _certified(
    graph: "nx.Graph", found: "FewestCuts | LargestGroup", path: Path, seconds: float, asked: "dict[str, Any]"
) -> dict[str, Any]:
    """Write the certificate, and say what it proves.

    Raises ``ProofError`` : nothing is proved in time, or groups of one robot are as large as any.
    """
    from ratt_opt.certificates.edge_cuts import certify_cuts

    proved = certify_cuts(graph, found, path, time_limit=seconds, **asked)
    least, size = proved.lower / proved.scale, proved.size / proved.size_scale
    return {"file": str(path), "size": size, "least_weight": least, "proof": proved.proof}


def _weights(given: "nx.Graph", graph: "nx.Graph", name: str) -> "dict[Link, Any]":
    """An attribute of the file's edges by link; edges in both directions must agree."""
    number = {attributes["node"]: i for i, attributes in graph.nodes(data=True)}
    found: dict[Link, Any] = {}
    for a, b, weight in given.edges(data=name):
        link = (min(number[a], number[b]), max(number[a], number[b]))
        if a != b and found.setdefault(link, weight) != weight:
            raise InputError("--weights", f"must be the same in both directions between {a} and {b}", weight)
    return found


def _document(graph: "nx.Graph", found: "FewestCuts | LargestGroup") -> dict[str, Any]:
    import networkx as nx

    names = [str(graph.nodes[i]["name"]) for i in range(len(graph))]
    left = nx.Graph(graph)
    left.remove_edges_from(found.cut)
    groups = sorted((sorted(group) for group in nx.connected_components(left)), key=lambda group: (-len(group), group))
    return {
        "robots": len(graph),
        "links": graph.number_of_edges(),
        "lower": found.lower,
        "upper": found.upper,
        "is_exact": found.is_exact,
        "stop": found.stop.value,
        "reason": found.reason,
        "notes": _notes(graph),
        "cut": [[names[i], names[j]] for i, j in sorted(found.cut)],
        "groups": [[names[i] for i in group] for group in groups],
    }


def _notes(graph: "nx.Graph") -> list[str]:
    import networkx as nx

    pieces = nx.number_connected_components(graph)
    return [] if pieces == 1 else [f"the network falls into {pieces} groups before any cut"]


def _lines(document: dict[str, Any], quantity: str, most: int = 30) -> list[str]:
    """Say what was found; more than ``most`` links and groups are counted, not listed: the JSON lists all."""
    lower, upper, cut = document["lower"], document["upper"], document["cut"]
    is_exact = document["is_exact"]
    listed = ", ".join("-".join(link) for link in cut[:most])
    more = f" and {len(cut) - most} more" if len(cut) > most else ""
    sizes = [str(len(group)) for group in document["groups"]]
    rest = " ..." if len(sizes) > most else ""
    return [
        f"{document['robots']} robots, {document['links']} links",
        f"{quantity}: {upper}, exact" if is_exact else f"{quantity}: from {lower} to {upper} ({document['stop']})",
        f"why not less: {document['reason']}",
        f"cut links ({len(cut)}): {listed}{more}" if cut else "no link needs to be cut",
        f"groups left ({len(sizes)}), robots in each: {' '.join(sizes[:most])}{rest}",
        *document["notes"],
        *_proof_lines(document.get("certificate")),
    ]


def _proof_lines(proof: dict[str, Any] | None) -> list[str]:
    if proof is None:
        return []
    what = f"at least {proof['least_weight']:g} must be cut for groups of at most {proof['size']:g}"
    return [f"certificate {proof['file']}: {what}, by {proof['proof']}"]
