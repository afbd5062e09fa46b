"""A network with weights of links and sizes of robots, in integers; robots that stay together are one node."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import isfinite, lcm
from numbers import Rational, Real
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.graph.communication import Link

__all__ = ["CutNetwork", "exact_integers"]


def exact_integers(argument: str, values: Sequence[object], *, positive: bool = False) -> tuple[list[int], int]:
    """Numbers as integers and what they were multiplied by: 0.1 is a tenth, as it is written.

    Raises ``InputError`` : one is no number, negative (or 0, if they must be ``positive``), NaN or infinite.
    """
    exact = [_exact(value) for value in values]
    for value, number in zip(values, exact, strict=True):
        if number is None or number < 0 or (positive and number == 0):
            raise InputError(argument, f"must be a finite number {'>' if positive else '>='} 0", value)
    known = [number for number in exact if number is not None]
    scale = lcm(*(number.denominator for number in known))
    return [int(number * scale) for number in known], scale


def _exact(value: object) -> Fraction | None:
    """A number as it is written; ``None`` if it is none, NaN or infinite."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, Real) or not isfinite(value):
        return None
    return Fraction(value) if isinstance(value, Rational) else Fraction(repr(float(value)))


@dataclass(frozen=True, eq=False)
class CutNetwork:
    """``sizes`` : of robots; ``members`` : robots of each node

    ``ends`` : (m, 2) nodes of each link; ``weight`` : (m,); ``size`` : (n,) of nodes

    Weights are in steps of ``1 / scale``, sizes in steps of ``1 / size_scale``. Links of weight 0 are left out.
    """

    graph: CommunicationGraph
    links: dict[Link, int]
    sizes: list[int]
    members: tuple[tuple[int, ...], ...]
    ends: IntArray
    weight: IntArray
    size: IntArray
    scale: int = 1
    size_scale: int = 1

    @classmethod
    def of(
        cls,
        graph: CommunicationGraph,
        weights: Mapping[Link, object] | None = None,
        sizes: Sequence[object] | None = None,
        together: Iterable[Link] = (),
    ) -> CutNetwork:
        """Make robots one node that links in ``together`` join; links between two nodes add up.

        Raises ``InputError`` : a weight or a size is no number of its range, or numbers are too many digits apart.
        """
        links = sorted(graph.links)
        given, scale = exact_integers("weights", [1 if weights is None else weights[link] for link in links])
        own, size_scale = exact_integers("sizes", [1] * graph.n_robots if sizes is None else sizes, positive=True)
        members = tuple(tuple(sorted(g)) for g in CommunicationGraph(graph.n_robots, frozenset(together)).groups())
        node = {robot: k for k, group in enumerate(members) for robot in group}
        between: dict[Link, int] = {}
        for (i, j), weight in zip(links, given, strict=True):
            a, b = sorted((node[i], node[j]))
            if a != b and weight:
                between[a, b] = between.get((a, b), 0) + weight
        size = [sum(own[robot] for robot in group) for group in members]
        if (sum(given) * sum(own)).bit_length() > 56:  # the steps of prices take four bits more, at least
            raise InputError("weights", "and sizes must have fewer digits: their sums' product is at most 2^56", "more")
        network = cls(
            graph=graph,
            links=dict(zip(links, given, strict=True)),
            sizes=own,
            members=members,
            ends=np.array(sorted(between), dtype=np.int64).reshape(-1, 2),
            weight=np.array([between[link] for link in sorted(between)], dtype=np.int64),
            size=np.array(size, dtype=np.int64),
            scale=scale,
            size_scale=size_scale,
        )
        for array in (network.ends, network.weight, network.size):
            array.flags.writeable = False
        return network

    @property
    def n_nodes(self) -> int:
        """Nodes."""
        return len(self.size)

    @cached_property
    def total(self) -> int:
        """Weight of all links between nodes."""
        return int(self.weight.sum())

    @cached_property
    def unit(self) -> int:
        """Steps of prices that make one step of a weight: a millionth, or as few as keep pricing within 60 bits."""
        used = (max(self.total, 1) * int(self.size.sum())).bit_length()
        return 1 << min(20, 60 - used)

    @cached_property
    def arcs(self) -> tuple[IntArray, IntArray]:
        """(n + 1,) where each node's links begin in (2 m,) numbers of links."""
        order = np.argsort(self.ends.T.ravel(), kind="stable")
        start = np.searchsorted(self.ends.T.ravel()[order], np.arange(self.n_nodes + 1))
        return start.astype(np.int64), np.tile(np.arange(len(self.ends)), 2)[order]

    def kept(self, groups: BoolArray) -> IntArray:
        """(k,) weight of the links inside each row of ``groups`` (k, n)."""
        return np.asarray((groups[:, self.ends[:, 0]] & groups[:, self.ends[:, 1]]) @ self.weight)

    def cut_of(self, label: IntArray) -> int:
        """Weight of the links between nodes of different labels (n,)."""
        return int(self.weight[label[self.ends[:, 0]] != label[self.ends[:, 1]]].sum())

    def groups_of(self, label: IntArray) -> list[tuple[int, ...]]:
        """Robots of each label."""
        found: dict[int, list[int]] = {}
        for k, one in enumerate(label.tolist()):
            found.setdefault(one, []).extend(self.members[k])
        return [tuple(sorted(group)) for group in found.values()]
