"""Random scenarios on a given communication graph, robots where the graph says that its nodes are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import networkx as nx
import numpy as np

from ratt_opt.graph.any_networkx import communication_graph
from ratt_opt.scenario.generator import random_scenario

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray
    from ratt_opt.scenario.model import Scenario

__all__ = ["graph_scenario"]

PLACES = (("longitude", "latitude"), ("lon", "lat"), ("x", "y"))
"""Attributes that say where a node is, in small letters; the first pair that any node has is taken."""
EARTH = ("longitude", "lon")


def graph_scenario(
    graph: nx.Graph, n_targets: int, *, alpha_s: int, alpha_c: int, seed: int, side: float = 100.0, **options: Any
) -> Scenario:
    """Draw a scenario whose robots and links are the nodes and edges of any networkx graph.

    :func:`communication_graph` says how the graph is read; robots have its names. If nodes have ``Longitude`` and
    ``Latitude`` (or ``lon`` and ``lat``, or ``x`` and ``y``; small or capital letters), robots are placed there, scaled
    so that the longer side of the network is ``side``. A node without is placed at the mean of its placed neighbours.
    If no node has such attributes, or all are at one place, robots are placed at random, as targets always are. The
    scenario's ``notes`` say what was done.

    Parameters
    ----------
    graph : directed or not, with parallel edges or not, nodes of any kind
    n_targets : M >= 1
    alpha_s, alpha_c : robots that may be blinded, links that may be cut
    seed : integer >= 0, of the targets, and of robots without a place
    side : side of the square [m]
    options : further ones of :func:`random_scenario`

    Raises
    ------
    InputError : not a networkx graph, without nodes, or a number is out of range.
    """
    team = communication_graph(graph)
    drawn = random_scenario(len(team), n_targets, alpha_s=0, alpha_c=0, seed=seed, side=side, **options)
    placed = _places(team, side)
    places = drawn.poses[:, :2] if placed is None else placed[0]
    robots = [
        robot.replace(x=float(x), y=float(y), name=team.nodes[i]["name"])
        for i, (robot, (x, y)) in enumerate(zip(drawn.robots, places, strict=True))
    ]
    where = "placed at random" if placed is None else placed[1]
    notes = (*drawn.notes, *_read_as(graph, team), f"robots {where}")
    links = tuple(team.edges)
    return drawn.replace(
        robots=robots, links=links, communication_range=None, alpha_s=alpha_s, alpha_c=alpha_c, notes=notes
    )


def _read_as(graph: nx.Graph, team: nx.Graph) -> Iterable[str]:
    """Yield remarks on a graph that is not simple."""
    loops = nx.number_of_selfloops(graph)
    if loops:
        yield f"self-loops left out: {loops}"
    several = [count for *_, count in team.edges(data="count") if count > 1]
    if several:
        yield f"links that stand for several parallel edges: {len(several)}"


def _places(team: nx.Graph, side: float) -> tuple[FloatArray, str] | None:
    """(N, 2) places by the nodes' attributes in a square, and by which; ``None`` if they say nothing."""
    attributes = [{str(key).lower(): value for key, value in team.nodes[i].items()} for i in team]
    for keys in PLACES:
        known = {i: place for i, given in enumerate(attributes) if (place := _place(given, keys)) is not None}
        if known:
            places = _between(team, known)
            if keys[0] in EARTH:  # degrees of longitude are shorter away from the equator
                places[:, 0] *= math.cos(math.radians(places[:, 1].mean()))
            places -= places.min(axis=0)
            extent = float(places.max())
            by = f"placed by {keys[0]} and {keys[1]}, scaled to {side:g} m"
            missing = len(team) - len(known)
            by += f"; {missing} without, placed between their neighbours" if missing else ""
            return None if extent == 0 else (places * (side / extent), by)
    return None


def _place(attributes: dict[str, object], keys: tuple[str, str]) -> tuple[float, float] | None:
    try:
        x, y = (float(_number(attributes.get(key))) for key in keys)
    except (TypeError, ValueError):
        return None
    return (x, y) if max(abs(x), abs(y)) < 1e9 else None  # a number beyond it is no place


def _number(value: object) -> float | str:
    """A number, or text that may hold one, as yEd's files have it.

    TypeError : neither.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise TypeError
    return value


def _between(team: nx.Graph, known: dict[int, tuple[float, float]]) -> FloatArray:
    """(N, 2) places: known, else the mean of the neighbours placed so far, else the mean of all."""
    places, new = dict(known), set(known)
    while new:
        around = sorted({j for i in new for j in team[i]} - places.keys())
        found = {i: np.mean([places[j] for j in team[i] if j in places], axis=0) for i in around}
        new = set(found)
        places |= {i: (float(x), float(y)) for i, (x, y) in found.items()}
    middle = np.mean(list(known.values()), axis=0)
    return np.array([places.get(i, middle) for i in team], dtype=np.float64)
