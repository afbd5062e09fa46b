"""Certificates of fewest cuts: the network, prices of robots, and the tree that shows that they hold for all groups."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._files import write_atomically
from ratt_opt.attack.edge_cuts.fewest import cut_network, size_in_steps
from ratt_opt.attack.edge_cuts.kept_links import proof_tree
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.verifier.edge_cuts import CUTS_FORMAT, VerifiedCuts, verify_cuts
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    import networkx as nx

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.edge_cuts.fewest import FewestCuts
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
    time_limit: float | None = None,
) -> VerifiedCuts:
    """Write the proof of what :func:`fewest_cuts` found by prices, ``found.by_prices``, once it is verified.

    ``graph``, ``weights``, ``sizes`` : as for :func:`fewest_cuts`, without protected links

    Raises
    ------
    InputError : as :func:`fewest_cuts`.
    ProofError : nothing was found by prices, or the tree is too long for a file or does not end in time.
    """
    network = cut_network(graph, weights, sizes, ())
    if found.prices is None:
        raise ProofError("no prices were proved: give fewest_cuts more time")
    prices = [int(price * network.unit * network.scale) for price in found.prices]
    room = size_in_steps(network, found.size)
    try:
        tree = proof_tree(network, np.array(prices, dtype=np.int64), room, MOST_NUMBERS, Budget(time_limit))
    except OutOfBudget as out:
        raise ProofError(f"the tree that proves the prices does not end in {time_limit} s") from out
    if tree is None:
        raise ProofError(f"the tree that proves the prices has more than {MOST_NUMBERS:,} numbers")
    links = sorted(network.links)
    places = {link: place for place, link in enumerate(links)}
    document: dict[str, Any] = {
        "format": CUTS_FORMAT,
        "version": 1,
        "network": {
            "robots": network.graph.n_robots,
            "links": [list(link) for link in links],
            "weights": [network.links[link] for link in links],
            "sizes": network.size.tolist(),
            "scale": network.scale,
            "size_scale": network.size_scale,
        },
        "size": room,
        "claim": max(sum(network.links.values()) - sum(prices) // network.unit, 0),
        "unit": network.unit,
        "prices": prices,
        "tree": list(_nodes(tree, [places[i, j] for i, j in network.ends.tolist()])),
    }
    verified = verify_cuts(document)
    text = json.dumps(document, separators=(",", ":")) + "\n"
    write_atomically(path, lambda file: file.write_text(text, encoding="utf-8"))
    return verified


def _nodes(tree: IntArray, places: list[int]) -> Iterator[dict[str, Any]]:
    """The nodes that the search wrote as integers: 1 and the robot of a split, or 2 and a leaf."""
    numbers, at = tree.tolist(), 0
    while at < len(numbers):
        if numbers[at] == 1:
            yield {"split": numbers[at + 1]}
            at += 2
            continue
        multiplier, count = numbers[at + 1 : at + 3]
        flat = numbers[at + 3 : at + 3 + 2 * count]
        parts = [one for link, part in zip(flat[::2], flat[1::2], strict=True) for one in (places[link], part)]
        yield {"multiplier": multiplier, "parts": parts}
        at += 3 + 2 * count
