"""Open nodes of a search along the axes of a target (``paying_axes.py``), one at each depth, for compiled loops."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attackers.weakest_set.pair_bound import View

__all__ = ["INSIDE", "OPEN", "OUTSIDE", "SHORTEST", "AxisNodes", "divide_by", "halve_arc", "join"]

OPEN, INSIDE, OUTSIDE = 0, 1, 2
FIRST_ARCS, SHORTEST = 8, 1e-6
"""Arcs at the root, and the half-width below which arcs are not divided."""
VALUE_ROUNDING = 1e-15
"""By how much a value may be off, relative to the criterion before any measurement."""


class AxisNodes(NamedTuple):
    """Open nodes, one at each depth: ``side`` (D, N) of each robot; ``sums`` (D, 3), ``paid`` (D,) of those inside and
    how many are ``left`` (D,) to choose; ``arc`` (D, 2) : middle and half-width; the ``multiplier`` (D,) that closes
    most; ``position`` (2,) : depth, below 0 at the end, and nodes looked at.

    ``linear`` : (N, 3) coefficients of each robot's height in ``u``; ``cap`` : of a weak set's height; ``smallest``
    multiplier above 0
    """

    side: Any
    sums: Any
    paid: Any
    left: Any
    arc: Any
    multiplier: Any
    position: Any
    linear: FloatArray
    cap: float
    smallest: float

    @classmethod
    def of(cls, view: View, size: int, threshold: float) -> AxisNodes:
        """The root of a view of one target: every robot open, arcs around the circle."""
        n_robots = len(view.information)
        depth = FIRST_ARCS + size + int(np.log2(np.pi / SHORTEST)) + 4
        room = view.baseline - threshold - VALUE_ROUNDING * abs(view.baseline)
        linear = _harmonics(view.information[:, 0])
        prior = _harmonics(view.prior[0])
        everything = 2 * float(prior[0] + linear[:, 0].sum())  # no set is as high: every set is weak
        cap = min(float(view.weights[0]) / room, everything) if room > 0 else everything
        nodes = cls(
            side=np.zeros((depth, n_robots), dtype=np.int8),
            sums=np.zeros((depth, 3)),
            paid=np.zeros(depth),
            left=np.full(depth, size, dtype=np.int64),
            arc=np.full((depth, 2), np.pi / FIRST_ARCS),
            multiplier=np.full(depth, cap / size**2),
            position=np.array([FIRST_ARCS - 1, 0], dtype=np.int64),
            linear=linear,
            cap=cap,
            smallest=1e-12 * cap / size**2,
        )
        nodes.sums[:] = prior
        nodes.arc[:FIRST_ARCS, 0] = (2 * np.arange(FIRST_ARCS) + 1) * np.pi / FIRST_ARCS
        return nodes


def _harmonics(matrices: FloatArray) -> FloatArray:
    """``v' [[a, b], [b, c]] v`` at angle t / 2 as coefficients of (1, cos t, sin t): (..., 3) -> (..., 3)."""
    a, b, c = matrices[..., 0], matrices[..., 1], matrices[..., 2]
    return np.stack([(a + c) / 2, (a - c) / 2, b], axis=-1)


@numba.njit(cache=True)
def join(question: Any, nodes: Any, node: int, robot: int) -> None:
    """Put a robot inside the sets of a node."""
    nodes.side[node, robot] = INSIDE
    nodes.sums[node] += nodes.linear[robot]
    nodes.paid[node] += question.prices[robot]
    nodes.left[node] -= 1


@numba.njit(cache=True)
def _copy(nodes: Any, target: int) -> None:
    """Make the node at depth ``target`` like the last one."""
    node = nodes.position[0]
    nodes.side[target], nodes.sums[target], nodes.arc[target] = nodes.side[node], nodes.sums[node], nodes.arc[node]
    nodes.paid[target], nodes.left[target] = nodes.paid[node], nodes.left[node]
    nodes.multiplier[target] = nodes.multiplier[node]


@numba.njit(cache=True)
def halve_arc(nodes: Any) -> None:
    """Two nodes in place of the last one, by the halves of its arc."""
    node = nodes.position[0]
    _copy(nodes, node + 1)
    half = nodes.arc[node, 1] / 2
    nodes.arc[node : node + 2, 1] = half
    nodes.arc[node, 0] -= half
    nodes.arc[node + 1, 0] += half
    nodes.position[0] += 1


@numba.njit(cache=True)
def divide_by(question: Any, nodes: Any, robot: int) -> None:
    """Two nodes in place of the last one, without and with a robot."""
    node = nodes.position[0]
    _copy(nodes, node + 1)
    nodes.side[node, robot] = OUTSIDE
    join(question, nodes, node + 1, robot)
    nodes.position[0] += 1
