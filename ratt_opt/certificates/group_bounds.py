"""Lower bounds in integers on what the groups of a node pay beyond their prices, by flows on the links.

A flow of at most half a link's worth on every link says what a group pays for the links it cuts: at least what flows
out of its robots. What is left is a sum over robots, each of which is outside, blinded or sees, and of those that see
only so many. A surcharge of blinded robots, paid back as often as some may be blinded, keeps these few.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.links import Links

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.attackers.by_prices.prices import PriceVector
    from ratt_opt.graph.threat import Threat

__all__ = ["BLINDED", "ELSE", "OPEN", "OUTSIDE", "SEEING", "GroupBounds"]

OPEN, SEEING, ELSE, BLINDED, OUTSIDE = range(5)
"""What a robot of a node is; ELSE is blinded or outside the group."""

HALF_LINK = 2**22
"""Units of half a link."""

LOWERED = 1e-5
"""Links by which each robot is cheaper than the search said: more than its tolerance and what rounding takes off; for a
hundred robots no more than the search leaves in hand."""

RECENT = 200
"""Bounds that a node tries, the latest."""

SURCHARGES, SHARES = (0.0, 0.25, 1.0), (1.0, 0.75, 0.5, 0.25, 0.0)
"""Of a blinded robot [links], and of a blinded robot's price that an open one pays, of the flows that a node tries."""

ALWAYS = 1e6
"""A capacity that no price reaches."""


class GroupBounds:
    """The bounds found so far for one threat at integer prices.

    ``robot`` (N,), ``blinded`` : prices; ``used`` : surcharges and flows on the sorted links that have closed a node
    """

    def __init__(self, threat: Threat, prices: PriceVector) -> None:
        self.half_link, unit = HALF_LINK, 2.0 * HALF_LINK
        self.robot = np.floor((prices.robot - LOWERED) * unit).astype(np.int64)
        self.blinded = int(np.ceil(prices.blinded * unit))
        self.most, self.unit = threat.n_blinded, unit
        self.links = Links.of(threat)
        self.ends = np.array(sorted(threat.graph.links), dtype=np.int64).reshape(-1, 2).T
        arcs = {arc: a for a, arc in enumerate(sorted([*threat.graph.links, *((j, i) for i, j in threat.graph.links)]))}
        self.arc = np.array([arcs[link] for link in sorted(threat.graph.links)], dtype=np.int64)
        self.capacity = np.where(self.links.fixed, ALWAYS, 0.5)
        self.used: list[tuple[int, IntArray]] = []
        self._place: dict[int, int] = {}
        self._flows: list[tuple[int, IntArray]] = []
        self._cost = np.zeros((0, len(self.robot)), dtype=np.int64)
        self._surcharge = np.zeros(0, dtype=np.int64)

    @property
    def length(self) -> int:
        """Integers in the flows used."""
        return len(self.used) * (len(self.arc) + 1)

    def closing(self, part: IntArray, room: int) -> int | None:
        """The number of a bound that shows that no group of the node pays, among the latest; ``None`` without one."""
        first = max(len(self._flows) - RECENT, 0)
        if first == len(self._flows):
            return None
        least = self._least(self._cost[first:], self._surcharge[first:], part, room)
        (shown,) = np.nonzero(least >= 0)
        if not len(shown):
            return None
        known = [k for k in (first + shown).tolist() if k in self._place]
        chosen = known[-1] if known else first + int(shown[-1])
        if chosen not in self._place:
            self._place[chosen] = len(self.used)
            self.used.append(self._flows[chosen])
        return self._place[chosen]

    def _least(self, cost: IntArray, surcharge: IntArray, part: IntArray, room: int) -> IntArray:
        """(K,) what the groups of the node pay at least beyond their prices, by each of K bounds."""
        dear = cost + (self.blinded + surcharge)[:, None]
        closed = np.where(self.links.seeing, 0, np.minimum(dear, 0))
        gain = np.minimum(np.minimum(cost, closed) - closed, 0)[:, part == OPEN]
        if room < gain.shape[1]:
            gain = np.partition(gain, room, axis=1)[:, :room] if room else gain[:, :0]
        total = closed[:, (part == OPEN) | (part == ELSE)].sum(axis=1) + gain.sum(axis=1)
        total += cost[:, part == SEEING].sum(axis=1) + dear[:, part == BLINDED].sum(axis=1)
        return np.asarray(total - surcharge * self.most)

    def cut(self, part: IntArray, room: int) -> list[BoolArray]:
        """Find flows for a node, until one closes it; the robots inside each minimum cut, that of no surcharge last."""
        from ratt_opt.certificates.flow import augment, open_flow  # compiles

        n_robots, sides = len(part), []
        price = self.robot / self.unit
        for surcharge in SURCHARGES[::-1]:
            dear = self.blinded / self.unit + surcharge
            for share in SHARES:
                cost = -price + np.select([part == OPEN, part == SEEING], [share * dear, 0.0], dear)
                flow = (np.empty(n_robots), np.empty(n_robots), np.empty(len(self.capacity)))
                bound = open_flow(self.links, cost, flow)
                flow[0][(part == SEEING) | (part == BLINDED)] += ALWAYS
                flow[1][(part == OUTSIDE) | ((part == ELSE) & self.links.seeing)] += ALWAYS
                work = tuple(np.empty(n_robots, dtype=np.int64) for _ in range(3))
                augment(self.links, flow, bound, np.inf, work)
                sides.append(work[0] >= 0)
                if self._keep(round(surcharge * self.unit), flow[2], part, room):
                    return sides
        return sides

    def _keep(self, surcharge: int, along: object, part: IntArray, room: int) -> bool:
        """Add a flow; whether it closes the node."""
        flow = np.rint((self.capacity - along)[self.arc] * self.unit).astype(np.int64)
        cost = -self.robot
        np.add.at(cost, self.ends[0], flow)
        np.subtract.at(cost, self.ends[1], flow)
        closes = bool(self._least(cost[None], np.array([surcharge]), part, room)[0] >= 0)
        if closes:
            self._flows.append((surcharge, flow))
            self._cost = np.concatenate([self._cost, cost[None]])
            self._surcharge = np.append(self._surcharge, surcharge)
        return closes
