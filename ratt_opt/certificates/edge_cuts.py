"""Certificates of fewest cuts: the network, prices of robots, and the tree that shows that they hold for all groups."""

from __future__ import annotations

import json
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._files import write_atomically
from ratt_opt.attack.edge_cuts.cut_search import CutSearch
from ratt_opt.attack.edge_cuts.fewest import cut_network, size_in_steps
from ratt_opt.attack.edge_cuts.kept_links import proof_tree
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.verifier.edge_cuts import CUTS_FORMAT, VerifiedCuts, verify_cuts
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    import networkx as nx

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.edge_cuts.fewest import FewestCuts
    from ratt_opt.attack.edge_cuts.network import CutNetwork
    from ratt_opt.graph.communication import CommunicationGraph, Link

__all__ = ["certify_cuts"]

MOST_NUMBERS = 1_800_000
"""Numbers of a tree at most; the verifier refuses longer files."""


def certify_cuts(
    graph: nx.Graph | CommunicationGraph,
    found: FewestCuts,
    path: str | Path,
    *,
    weights: Mapping[Link, float] | str | None = None,
    sizes: Mapping[int, float] | Sequence[float] | str | None = None,
    protected_links: Iterable[Link] = (),
    time_limit: float | None = None,
) -> VerifiedCuts:
    """Write the proof of what :func:`fewest_cuts` found by prices, ``found.by_prices``, once it is verified.

    If it found its answer without prices, these are searched first.

    ``graph``, ``weights``, ``sizes``, ``protected_links`` : as for :func:`fewest_cuts`

    Raises
    ------
    InputError : as :func:`fewest_cuts`.
    ProofError : no prices are proved, or the tree is too long for a file or does not end in time.
    """
    together = list(protected_links)
    network = cut_network(graph, weights, sizes, together)
    room, budget = size_in_steps(network, found.size), Budget(time_limit)
    prices = _prices(network, found, room, budget)
    try:
        tree = proof_tree(network, prices, room, MOST_NUMBERS, budget)
    except OutOfBudget as out:
        raise ProofError(f"the tree that proves the prices does not end in {time_limit} s") from out
    if tree is None:
        raise ProofError(f"the tree that proves the prices has more than {MOST_NUMBERS:,} numbers")
    links = sorted(network.links)
    joined = sorted({(min(link), max(link)) for link in together})
    document: dict[str, Any] = {
        "format": CUTS_FORMAT,
        "version": 1,
        "network": {
            "robots": network.graph.n_robots,
            "links": [list(link) for link in links],
            "weights": [network.links[link] for link in links],
            "sizes": network.sizes,
            "protected": [list(link) for link in joined],
            "scale": network.scale,
            "size_scale": network.size_scale,
        },
        "size": room,
        "claim": max(network.total - int(prices.sum()) // network.unit, 0),
        "unit": network.unit,
        "prices": prices.tolist(),
        "tree": list(_nodes(tree)),
    }
    verified = verify_cuts(document)
    text = json.dumps(document, separators=(",", ":")) + "\n"
    write_atomically(path, lambda file: file.write_text(text, encoding="utf-8"))
    return verified


def _prices(network: CutNetwork, found: FewestCuts, room: int, budget: Budget) -> IntArray:
    """(n,) prices of nodes that were found, or that are now.

    Raises ``ProofError`` : none are proved.
    """
    if found.prices is not None:
        own = [found.prices[robots[0]] * network.unit * network.scale for robots in network.members]
        return np.array([int(price) for price in own], dtype=np.int64)
    if network.total == 0:
        return np.zeros(network.n_nodes, np.int64)
    search = CutSearch(network, room, budget)
    with suppress(OutOfBudget):
        search.raise_prices()
    if search.prices is None:
        raise ProofError("no prices were proved: give more time")
    return search.prices


def _nodes(tree: IntArray) -> Iterator[dict[str, Any]]:
    """The nodes that the search wrote as integers: 1 and the robot of a split, or 2 and a leaf."""
    numbers, at = tree.tolist(), 0
    while at < len(numbers):
        if numbers[at] == 1:
            yield {"split": numbers[at + 1]}
            at += 2
            continue
        multiplier, count = numbers[at + 1 : at + 3]
        yield {"multiplier": multiplier, "parts": numbers[at + 3 : at + 3 + 2 * count]}
        at += 3 + 2 * count
