"""Few links whose cut leaves no group above a size, by simulated annealing over the robots' groups."""

from __future__ import annotations

from ctypes import c_void_p, cast
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.graph.largest_group.counting import largest_left
from ratt_opt.graph.params import CutAnnealingParams
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import CutAnnealRecord, loops

if TYPE_CHECKING:
    from collections.abc import Collection

    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["Cooling", "PricedArcs", "annealed_cut"]


DEFAULT = CutAnnealingParams()
"""Parameters of annealing that is not given any."""


def annealed_cut(
    threat: Threat,
    cut: frozenset[Link],
    lower: int,
    budget: Budget,
    *,
    ignoring: Collection[int] = (),
    params: CutAnnealingParams = DEFAULT,
) -> frozenset[Link]:
    """A cut that leaves a smaller largest group than ``cut`` does, if annealing finds one.

    Sizes are bisected first; as annealing may miss one size and meet a smaller one, the next few are tried after that.

    ``lower`` : no cut leaves a smaller largest group
    ``ignoring`` : robots that do not count for a group's size
    """
    best, low, missed = cut, lower, 0
    size = largest_left(threat.graph, best, ignoring)
    while size > lower and missed < params.misses and budget.stop() is None:
        goal = (low + size) // 2 if low < size else size - 1 - missed
        found = _cut_below(threat, goal, budget, ignoring, params) if goal >= lower else None
        if found is not None:
            best, size, missed = found, largest_left(threat.graph, found, ignoring), 0
        elif low < size:
            low = goal + 1
        else:
            missed += 1
    return best


def _cut_below(
    threat: Threat, size: int, budget: Budget, ignoring: Collection[int], params: CutAnnealingParams
) -> frozenset[Link] | None:
    """A cut within the budget that leaves groups of at most ``size`` robots that count, if a few coolings find one."""
    n_robots = threat.graph.n_robots
    counts = np.array([i not in ignoring for i in range(n_robots)], dtype=np.int64)
    network, rng, fewest = PricedArcs.of(threat), np.random.default_rng(size), -(-int(counts.sum()) // size)
    for count in dict.fromkeys(fewest + round(share * fewest) for share in params.spare_groups):
        cooling = Cooling(network, counts, rng.integers(0, count, n_robots), count, size, rng, params=params)
        within, moves = threat.alpha_c + 1, params.moves * n_robots
        for start in range(0, moves, params.moves_at_once):
            if budget.stop() is not None:
                break
            within = cooling.run(start, min(start + params.moves_at_once, moves), moves, within)
            if within <= threat.alpha_c:
                return frozenset((i, j) for i, j in threat.graph.links if cooling.best[i] != cooling.best[j])
    return None


@dataclass(frozen=True, slots=True, eq=False)
class PricedArcs:
    """``start`` : (N + 1,) of each robot's arcs; ``robot``, ``price`` : (2 E,) an arc's other end, and its cut's."""

    start: IntArray
    robot: IntArray
    price: IntArray

    @classmethod
    def of(cls, threat: Threat) -> PricedArcs:
        """A protected link costs more than all links."""
        links = sorted(threat.graph.links)
        price = [len(links) + 1 if link in threat.protected_links else 1 for link in links]
        ends = np.array(links, dtype=np.int64).reshape(-1, 2)
        return cls.weighted(ends, np.array(price, dtype=np.int64), threat.graph.n_robots)

    @classmethod
    def weighted(cls, ends: IntArray, price: IntArray, n_robots: int) -> PricedArcs:
        """``ends`` : (E, 2); ``price`` : (E,) of cutting each."""
        arcs = np.concatenate([ends, ends[:, ::-1]])
        order = np.lexsort(arcs.T[::-1])
        start = np.searchsorted(arcs[order, 0], np.arange(n_robots + 1))
        return cls(start, arcs[order, 1].copy(), np.tile(price, 2)[order])


class Cooling:
    """One cooling from the labels ``group`` (N,) below ``count``; ``best`` : (N,) those of the fewest links cut.

    ``counts`` : (N,) sizes of robots, 0 for those that do not count for a group's ``size``
    ``unit`` : weight of a typical link; temperatures and the price of a robot too many are in it
    ``fewest`` : weight that ``best`` cuts, once there is one

    Raises ``InputError`` : an array has another type or shape, or a label is none.
    """

    def __init__(  # noqa: PLR0917
        self,
        network: PricedArcs,
        counts: IntArray,
        group: IntArray,
        count: int,
        size: int,
        rng: np.random.Generator,
        *,
        unit: float = 1.0,
        params: CutAnnealingParams = DEFAULT,
    ) -> None:
        n_robots, arcs = len(network.start) - 1, len(network.robot)
        checked("counts", counts, np.int64, (n_robots,))
        checked("group", group, np.int64, (n_robots,), written=True)
        if not ((group >= 0) & (group < count)).all():
            raise InputError("group", f"must be in [0, {count - 1}]", group)
        self.best, sizes = group.copy(), np.bincount(group, counts, minlength=count).astype(np.int64)
        self._arrays = network, counts, group, sizes  # the record has their addresses only
        # The state of NumPy's generator, and the function of its that reads it: `bitgen_t` in its reference.
        self._rng, bits = rng, rng.bit_generator.ctypes
        counted = max(int((counts > 0).sum()), 1) / max(int(counts.sum()), 1)
        oversize = max(params.oversize, 1.5 * arcs / n_robots) * unit * counted
        self._record = CutAnnealRecord(
            robots=n_robots,
            groups=count,
            most=size,
            start=address(checked("start", network.start, np.int64, (n_robots + 1,))),
            robot=address(checked("robot", network.robot, np.int64, (arcs,))),
            price=address(checked("price", network.price, np.int64, (arcs,))),
            counts=address(counts),
            group=address(group),
            best=address(self.best),
            sizes=address(sizes),
            hot=params.hot * unit,
            cold=params.cold * unit,
            oversize=oversize,
            random=bits.state_address,
            uniform=cast(bits.next_double, c_void_p).value,
        )
        self.fewest = np.iinfo(np.int64).max

    def run(self, first: int, last: int, moves: int, fewest: int) -> int:
        """Go through some of the ``moves``; the fewest links cut so far, less than ``fewest``, or that."""
        self.fewest = loops.anneal_cut(self._record, first, last, moves, fewest)
        return self.fewest
