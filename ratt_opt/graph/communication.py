"""The communication graph of a team, checked once."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

import networkx as nx
import numpy as np

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray

__all__ = ["CommunicationGraph", "Link", "mask_of", "membership", "neighbour_masks", "robots_of", "sums_of_subsets"]

Number = TypeVar("Number", np.int64, np.float64)

Link = tuple[int, int]
"""``(i, j)`` with ``i < j``."""

RECIPE = " (communication_graph makes one)"
"""Advice in refusals of graphs that :func:`ratt_opt.communication_graph` would make valid."""


def neighbour_masks(n_robots: int, links: Iterable[Link]) -> list[int]:
    """Bit mask of the neighbours of each robot by these links."""
    masks, bit = [0] * n_robots, [1 << i for i in range(n_robots)]
    for i, j in links:
        masks[i] |= bit[j]
        masks[j] |= bit[i]
    return masks


def mask_of(robots: Iterable[int]) -> int:
    """Bit mask of a set of robots."""
    return sum(1 << i for i in robots)


def robots_of(mask: int) -> list[int]:
    """Robots of a set by bit mask, ascending."""
    return [i for i in range(mask.bit_length()) if mask >> i & 1]


def sums_of_subsets(values: NDArray[Number]) -> NDArray[Number]:
    """(2**n,) sum over each subset of n numbers, by bit mask."""
    sums = np.zeros(1 << len(values), values.dtype)
    for i, value in enumerate(values):
        np.add(sums[: 1 << i], value, out=sums[1 << i : 2 << i])
    return sums


def membership(masks: Sequence[int], count: int) -> BoolArray:
    """(K, count) of sets by bit mask, the lowest bit first."""
    width = (count + 7) // 8
    packed = np.frombuffer(b"".join(mask.to_bytes(width, "little") for mask in masks), dtype=np.uint8)
    bits = np.unpackbits(packed.reshape(len(masks), width), axis=1, count=count, bitorder="little")
    return bits.astype(np.bool_)


@dataclass(frozen=True, slots=True)
class CommunicationGraph:
    """Robots ``0..N-1`` and the links between them.

    ``links`` holds ``(i, j)`` with ``i < j``; ``is_complete`` says whether every pair is linked.
    """

    n_robots: int
    links: frozenset[Link]
    is_complete: bool = field(init=False)
    _neighbours: tuple[int, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_neighbours", tuple(neighbour_masks(self.n_robots, self.links)))
        complete = len(self.links) == self.n_robots * (self.n_robots - 1) // 2
        object.__setattr__(self, "is_complete", complete)

    @classmethod
    def complete(cls, n_robots: int) -> CommunicationGraph:
        """Every robot hears every other (the paper's assumption); kept, as problems of a thousand robots ask often."""
        return _complete(n_robots)

    @classmethod
    def from_networkx(cls, graph: object, n_robots: int) -> CommunicationGraph:
        """Check and convert a ``networkx.Graph`` on nodes ``0..N-1``.

        Raises ``InputError`` : not an undirected simple graph, wrong nodes, or a self-loop.
        """
        if not isinstance(graph, nx.Graph) or graph.is_directed() or graph.is_multigraph():
            recipe = RECIPE if isinstance(graph, nx.Graph) else ""
            raise InputError("graph", f"must be an undirected networkx.Graph{recipe}", type(graph).__name__)
        if set(graph.nodes) != set(range(n_robots)) or any(isinstance(i, (bool, np.bool_)) for i in graph.nodes):
            nodes = sorted(map(repr, graph.nodes))
            recipe = RECIPE if len(nodes) == n_robots else ""
            raise InputError("graph", f"must have the nodes 0..{n_robots - 1}{recipe}", f"[{', '.join(nodes)}]")
        loops = list(nx.selfloop_edges(graph))
        if loops:
            raise InputError("graph", f"must have no self-loop{RECIPE}", loops[0])
        # Nodes equal to integers may be of another type, such as NumPy's.
        return cls(n_robots, frozenset((int(min(i, j)), int(max(i, j))) for i, j in graph.edges))

    def groups(self, cut: Iterable[Link] = ()) -> tuple[frozenset[int], ...]:
        """Connected components left when the links of ``cut`` are gone, by lowest robot."""
        lost = neighbour_masks(self.n_robots, cut)
        neighbours = [near & ~gone for near, gone in zip(self._neighbours, lost, strict=True)]
        return _components(neighbours, (1 << self.n_robots) - 1)

    def groups_among(self, robots: frozenset[int]) -> tuple[frozenset[int], ...]:
        """Connected components of ``robots`` once all others are cut off, by lowest robot."""
        if self.is_complete:
            return (robots,) if robots else ()
        return _components(self._neighbours, mask_of(robots))

    def links_between(self, groups: Iterable[Iterable[int]]) -> frozenset[Link]:
        """Links between robots of different groups; every robot is in one group."""
        found: list[Link] = []
        left = (1 << self.n_robots) - 1
        parts = sorted(([int(i) for i in group] for group in groups), key=len)  # NumPy's integers have 64 bits
        for group in parts[:-1]:  # links of the largest one are met from their other end
            left &= ~mask_of(group)
            for i in group:
                found.extend((i, j) if i < j else (j, i) for j in _bits(self._neighbours[i] & left))
        return frozenset(found)

    def bridges(self) -> frozenset[Link]:
        """The links whose cut alone leaves more groups."""
        return frozenset((min(i, j), max(i, j)) for i, j in nx.bridges(nx.Graph(self.links)))

    def links_of(self, robot: int) -> frozenset[Link]:
        """The links of one robot."""
        return frozenset((min(robot, j), max(robot, j)) for j in self.neighbours_of(robot))

    def neighbours_of(self, robot: int) -> tuple[int, ...]:
        """The robots linked to one, ascending."""
        return tuple(_bits(self._neighbours[robot]))


def _components(neighbours: Sequence[int], robots: int) -> tuple[frozenset[int], ...]:
    """Connected components among the robots of a mask, by lowest robot; bit masks are many times as fast as sets."""
    groups = []
    while robots:
        group = new = robots & -robots
        while new:
            reached = 0
            for i in _bits(new):
                reached |= neighbours[i]
            new = reached & robots & ~group
            group |= new
        groups.append(frozenset(_bits(group)))
        robots &= ~group
    return tuple(groups)


def _bits(mask: int) -> list[int]:
    """Positions of the bits that are set, ascending."""
    if 6 * mask.bit_count() < mask.bit_length():  # one by one: 20 bits of 500 then take a seventh of the time
        found = []
        while mask:
            lowest = mask & -mask
            found.append(lowest.bit_length() - 1)
            mask ^= lowest
        return found
    return [i for i, bit in enumerate(reversed(f"{mask:b}")) if bit == "1"]


@lru_cache(maxsize=8)
def _complete(n_robots: int) -> CommunicationGraph:
    return CommunicationGraph(n_robots, frozenset((i, j) for j in range(n_robots) for i in range(j)))
