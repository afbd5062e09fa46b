"""Random scenarios on the networks that radio teams have: five families, reproducible by their seed.

Robots and targets are those of :func:`random_scenario` with the same seed; the family says who hears whom. Budgets
may be shares of the robots and links. Sparse disks can fall apart into several groups, as real teams do.
"""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any

import networkx as nx
import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.scenario.generator import random_scenario

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray
    from ratt_opt.scenario.model import Scenario

__all__ = ["NETWORK_FAMILIES", "NetworkShape", "network_links", "network_scenario"]

Link = tuple[int, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkShape:
    """Numbers of the drawn network families.

    ``density`` : share of all links of the dense random graph: about the share of robots that one hears in a building
    ``neighbours``, ``rewired`` : of the small world: neighbours on a ring, and the share of links that lead elsewhere
    (Watts and Strogatz, Nature 393, 1998)
    ``attached`` : links with which a robot joins the hubs (Barabasi and Albert, Science 286, 1999)
    """

    density: float = 0.7
    neighbours: int = 6
    rewired: float = 0.2
    attached: int = 4

    def __post_init__(self) -> None:
        """Check the numbers. ``InputError`` : a share is not in [0, 1], or a number of links is less than 1."""
        for name in ("density", "rewired"):
            if not 0 <= (share := getattr(self, name)) <= 1:
                raise InputError(f"shape.{name}", "must be in [0, 1]", share)
        for name in ("neighbours", "attached"):
            check_integer(f"shape.{name}", getattr(self, name), low=1)


SHAPE = NetworkShape()


def network_scenario(
    family: str,
    n_robots: int,
    n_targets: int,
    *,
    alpha_s: float,
    alpha_c: float,
    seed: int,
    shape: NetworkShape = SHAPE,
    **options: Any,
) -> Scenario:
    """Draw a scenario whose links are those of a network family.

    Parameters
    ----------
    family : a name of ``NETWORK_FAMILIES``
    n_robots, n_targets : N, M >= 1
    alpha_s, alpha_c : robots that may be blinded, links that may be cut: a number of them (``int``), or a share in
        [0, 1] of the robots and of the links (``float``), rounded to the nearest number
    seed : integer >= 0, of robots, targets and links
    shape : density, neighbours and hubs of the families
    options : further ones of :func:`random_scenario`

    Raises
    ------
    InputError : the family is unknown, or a number is out of range.
    """
    scenario = random_scenario(n_robots, n_targets, alpha_s=0, alpha_c=0, seed=seed, **options)
    links = network_links(family, scenario.poses[:, :2], seed, shape)
    budgets = {"alpha_s": _count("alpha_s", alpha_s, n_robots), "alpha_c": _count("alpha_c", alpha_c, len(links))}
    return scenario.replace(links=links, communication_range=None, **budgets)


def network_links(family: str, positions: FloatArray, seed: int, shape: NetworkShape = SHAPE) -> tuple[Link, ...]:
    """Links ``(i, j)``, ``i < j``, ascending, between robots at ``positions`` (N, 2) [m].

    Raises
    ------
    InputError : the family is unknown, or ``seed`` is not an integer >= 0.
    """
    if family not in NETWORK_FAMILIES:
        rule = f"must be one of {', '.join(NETWORK_FAMILIES)} (or, in ratt-opt new, a graph file)"
        raise InputError("graph", rule, family)
    seed = check_integer("seed", seed, low=0)
    links = NETWORK_FAMILIES[family](positions, seed, shape)
    return tuple(sorted((min(i, j), max(i, j)) for i, j in links))


def _count(name: str, budget: float, most: int) -> int:
    if isinstance(budget, (int, np.integer)):
        return check_integer(name, budget, low=0, high=most)
    if not (isinstance(budget, Real) and 0 <= budget <= 1):
        raise InputError(name, "must be a number of them or a share in [0, 1]", budget)
    return round(budget * most)


def _dense(positions: FloatArray, seed: int, shape: NetworkShape) -> list[Link]:
    return _of(nx.gnp_random_graph(len(positions), shape.density, seed=seed))


def _disk(degree: int) -> Callable[[FloatArray, int, NetworkShape], list[Link]]:
    """Robots within one range of each other; the range that gives this mean number of links."""

    def links(positions: FloatArray, *_: object) -> list[Link]:
        first, second = np.triu_indices(len(positions), 1)
        apart = np.linalg.norm(positions[first] - positions[second], axis=1)
        nearest = np.argsort(apart, kind="stable")[: len(positions) * degree // 2]
        return list(zip(first[nearest].tolist(), second[nearest].tolist(), strict=True))

    return links


def _small_world(positions: FloatArray, seed: int, shape: NetworkShape) -> list[Link]:
    nearest = min(shape.neighbours, len(positions) - 1)
    return _of(nx.watts_strogatz_graph(len(positions), nearest, shape.rewired, seed=seed))


def _hubs(positions: FloatArray, seed: int, shape: NetworkShape) -> list[Link]:
    if len(positions) <= shape.attached:
        return _of(nx.complete_graph(len(positions)))
    return _of(nx.barabasi_albert_graph(len(positions), shape.attached, seed=seed))


def _of(graph: nx.Graph) -> list[Link]:
    return [(int(i), int(j)) for i, j in graph.edges]


NETWORK_FAMILIES: dict[str, Callable[[FloatArray, int, NetworkShape], list[Link]]] = {
    "dense": _dense,
    "disk-12": _disk(12),
    "disk-6": _disk(6),
    "small-world": _small_world,
    "hubs": _hubs,
}
"""Name -> links of robots at given positions: dense random (each pair with 0.7), disks of mean degree 12 and 6, small
world (6 neighbours, a fifth rewired), preferential attachment (4 links a robot)."""
