"""Any networkx graph as a communication graph, by one stated rule."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from numbers import Real
from typing import TYPE_CHECKING

import networkx as nx

from ratt_opt._validation import check_number
from ratt_opt.errors import InputError, printable

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping

__all__ = ["communication_graph"]

NAMES = ("label", "name")
"""Attributes that name a node, text or a number, first come first; what other attributes hold is no name."""
PARALLEL = ("count", "refuse")


def communication_graph(graph: nx.Graph, *, parallel: str = "count", weight: str | None = None) -> nx.Graph:
    """Return the simple undirected graph on robots ``0..N-1`` that :class:`Problem` takes, from any networkx graph.

    - Directions are dropped: two nodes are linked if an edge leads from one to the other, in either direction.
    - Self-loops are dropped.
    - Parallel edges (in one direction) become one link, which one cut removes; its attribute ``count`` is their number.
    - Nodes are numbered in this order: numbers ascending, then text (the numbers in it compared as numbers: "r2" before
      "r10"), then tuples, entry by entry. Other nodes come last, by the name of their type, in the graph's own order.
    - Each robot keeps the node's attributes, and has ``node`` (what it was) and ``name``: the attribute ``label``, or
      ``name``, if that is text or a number, otherwise the node as text. Escapes stand for unprintable characters.

    The graph handed over is not changed.

    Parameters
    ----------
    graph : directed or not, with parallel edges or not, nodes of any kind
    parallel : ``"count"`` as above, or ``"refuse"``
    weight : attribute of edges that becomes the links' ``weight``; an edge without it weighs 1. Parallel edges add up;
        of two directions the heavier one counts

    Raises
    ------
    InputError : not a networkx graph, without nodes, parallel edges that are to be refused, or a weight is no finite
        number >= 0.
    """
    if not isinstance(graph, nx.Graph):
        raise InputError("graph", "must be a networkx graph", type(graph).__name__)
    if parallel not in PARALLEL:
        raise InputError("parallel", f"must be one of {', '.join(PARALLEL)}", parallel)
    if not len(graph):
        raise InputError("graph", "must have at least one node", "none")
    number = {node: i for i, node in enumerate(sorted(graph, key=_place))}
    simple = nx.Graph()
    for node, i in number.items():
        simple.add_node(i, **{**graph.nodes[node], "node": node, "name": _name(node, graph.nodes[node])})
    for (i, j), count in sorted(_links(graph, number).items()):
        if count > 1 and parallel == "refuse":
            ends = f"{count} between {simple.nodes[i]['name']} and {simple.nodes[j]['name']}"
            raise InputError("graph", 'must have no parallel edges (parallel="count" takes them)', ends)
        simple.add_edge(i, j, count=count)
    if weight is not None:
        nx.set_edge_attributes(simple, _weights(graph, number, weight), "weight")
    return simple


def _links(graph: nx.Graph, number: Mapping[Hashable, int]) -> dict[tuple[int, int], int]:
    """The links by numbers, lower one first, and how many edges in one direction each stands for."""
    pairs = ((number[i], number[j]) for i, j in graph.edges())
    edges = Counter(pair if graph.is_directed() else (min(pair), max(pair)) for pair in pairs)
    return {(min(i, j), max(i, j)): max(edges[i, j], edges[j, i]) for i, j in list(edges) if i != j}


def _weights(graph: nx.Graph, number: Mapping[Hashable, int], key: str) -> dict[tuple[int, int], float]:
    """The weight of each link, lower number first."""
    sums: defaultdict[tuple[int, int], float] = defaultdict(float)
    for first, second, given in graph.edges(data=key, default=1.0):
        between = f"weight of the edge between {first} and {second}"
        i, j = number[first], number[second]
        sums[(i, j) if graph.is_directed() else (min(i, j), max(i, j))] += check_number(between, given, low=0.0)
    return {(min(i, j), max(i, j)): max(sums[i, j], sums[j, i]) for i, j in list(sums) if i != j}


def _name(node: Hashable, attributes: Mapping[str, object]) -> str:
    labels = (attributes.get(key) for key in NAMES)
    given = (printable(str(label)) for label in labels if isinstance(label, (str, Real)))
    return next(filter(None, given), "") or printable(str(node))


def _place(node: Hashable) -> tuple[object, ...]:
    """Return the sort key of a node; keys of one kind compare with each other."""
    if isinstance(node, Real) and node == node:  # noqa: PLR0124  (NaN has no place)
        return (0, node)
    if isinstance(node, str):
        parts = (part.lstrip("0") if k % 2 else part for k, part in enumerate(re.split(r"(\d+)", node)))
        return (1, tuple((len(part), part) if k % 2 else part for k, part in enumerate(parts)), node)
    if isinstance(node, tuple):
        return (2, tuple(map(_place, node)))
    return (3, type(node).__qualname__)
