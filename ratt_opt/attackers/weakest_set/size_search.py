"""Branch and bound over the largest group of an outcome on a complete graph.

Every attack leaves a group with at least ``k`` seeing robots (``forced_group_size``), so the smallest
value of any ``k`` robots is a lower bound. Teams of up to some thirty robots are decided by a compiled
depth-first search alone (``compiled.py``). In larger ones nodes fix robots inside or outside that group; an affine
minorant (``minorant.py``) bounds them, fixes more robots by reduced cost, and guides the same
depth-first search that finishes small nodes. Whenever a set below the incumbent is found, the
other groups of the outcome are packed; that makes a new incumbent or proves the set useless.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.compact import MAX_EIGENVALUE
from ratt_opt.attackers.weakest_set.low_sets import AffineBound, LowSets
from ratt_opt.attackers.weakest_set.minorant import Minorant, affine_minorant
from ratt_opt.attackers.weakest_set.outer_points import SetFamily
from ratt_opt.attackers.weakest_set.swap_search import swap_search
from ratt_opt.attackers.weakest_set.weakest_axis import weakest_axis

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.bracket import Budget
    from ratt_opt.attackers.weakest_set.compact import CompactTeam

__all__ = ["SizeNode", "SizeSearch"]

AT_ONCE = 34
"""Teams of so many robots are first enumerated whole, without a minorant."""
WHOLE_ENUMERATION = 4_000_000_000
SHORTEST_ENUMERATION, LONGEST_ENUMERATION = 10_000_000, 40_000_000
"""Criteria of single targets looked at (some nanoseconds each) for the whole team, and for one branch-and-bound node
before it is split: more after successes, fewer after failures."""

UNINTERRUPTED = 100_000_000
"""Criteria of single targets between two looks at the clock and at interrupts (about half a second)."""

HEAVY_ROBOTS = ((50, 4), (10**9, 5))
"""(Undecided robots up to, robots per target whose patterns the minorant enumerates): few nodes are afforded above."""


@dataclass(frozen=True, slots=True, order=True)
class SizeNode:
    """Sets of robots that contain ``inside`` and avoid ``outside``; none is worth less than ``bound``.

    ``parent`` : a minorant over the undecided robots, strongest first
    """

    bound: float
    serial: int
    inside: frozenset[int] = field(compare=False)
    outside: frozenset[int] = field(compare=False)
    parent: Minorant | None = field(compare=False, default=None)


class SizeSearch:
    """Searches the sets of ``size`` robots for one that ``offer`` turns into a better attack.

    Parameters
    ----------
    offer : is given each set below the threshold and returns the new threshold
    floor : no set is worth less
    inside, outside : only sets that contain the first and avoid the second
    """

    def __init__(
        self,
        team: CompactTeam,
        size: int,
        offer: Callable[[frozenset[int]], float],
        floor: float,
        *,
        inside: frozenset[int] = frozenset(),
        outside: frozenset[int] = frozenset(),
    ) -> None:
        self.team, self.size, self.offer = team, size, offer
        self._serial = 0
        self._inside, self._among = inside, frozenset(range(len(team.single))) - outside
        self._work = LONGEST_ENUMERATION
        self.open = [SizeNode(floor, 0, inside, outside)]

    @property
    def lower(self) -> float:
        """No set still undecided is worth less; infinite once all are decided."""
        return self.open[0].bound if self.open else np.inf

    def run(self, threshold: float, budget: Budget, progress: Callable[[float], None]) -> float:
        """Decide every set against the falling threshold; returns the last threshold.

        ``progress`` is told what no undecided set falls below, after every node.
        The open nodes stay valid when the budget runs out or the user interrupts.
        """
        if len(self._among) <= AT_ONCE:
            threshold = self._enumerate_all(threshold, budget)
        while self.open and self.open[0].bound < threshold:
            node = self.open[0]
            children, threshold = self._expand(node, threshold, budget, progress)
            heapq.heappop(self.open)
            for child in children:
                heapq.heappush(self.open, child)
            progress(self.lower)
        self.open.clear()
        return threshold

    def _expand(
        self, node: SizeNode, threshold: float, budget: Budget, progress: Callable[[float], None]
    ) -> tuple[list[SizeNode], float]:
        budget.spend()
        robots = self._free(node)
        size = self.size - len(node.inside)
        if size < 0 or size > len(robots):
            return [], threshold
        minorant, bound = None, node.bound
        if self.team.kind == MAX_EIGENVALUE:
            axis = weakest_axis(self.team, self.team.sums(node.inside), self.team.information[robots], size)
            bound = max(bound, axis.bound)
            threshold = self._try(node, robots[axis.chosen], threshold)
        elif 0 < size < len(robots):
            minorant = affine_minorant(
                self._family(node.inside, robots, size), _heavy_robots(len(robots)), threshold, node.parent
            )
            bound = max(bound, minorant.bound(size))
            order = np.lexsort((minorant.scores, -minorant.fraction))
            threshold = self._try(node, robots[order[:size]], threshold)
        if bound >= threshold:
            return [], threshold
        progress(min([bound, *(other.bound for other in self.open[1:3])]))  # the next lowest are a heap's children
        if minorant is not None:
            node, robots, minorant = self._fix(node, robots, minorant, threshold)
            size = self.size - len(node.inside)
        low = self._enumeration(node, robots, size, minorant)
        threshold = self._enumerate(low, threshold, budget, self._work)
        work = int(self._work * (1.3 if low.finished else 0.8))
        self._work = min(max(work, SHORTEST_ENUMERATION), LONGEST_ENUMERATION)
        children = [] if low.finished else self._split(node, bound, robots, minorant)
        return children, threshold

    def _free(self, node: SizeNode) -> IntArray:
        """Undecided robots, strongest first."""
        order = np.argsort(-self.team.single, kind="stable")
        return np.array([i for i in order.tolist() if i not in node.inside and i not in node.outside], dtype=np.int64)

    def _family(self, inside: frozenset[int], robots: IntArray, size: int) -> SetFamily:
        team = self.team
        return SetFamily(team.kind, team.weights, team.prior, team.sums(inside), team.information[robots], size)

    def _try(self, node: SizeNode, others: IntArray, threshold: float) -> float:
        """Offer the set that the bound suggests, improved by exchanges."""
        candidate = node.inside | frozenset(others.tolist())
        for one in (candidate, swap_search(self.team, candidate, among=self._among, fixed=self._inside)):
            if self.team.value(one) < threshold:
                threshold = self.offer(one)
        return threshold

    def _fix(
        self, node: SizeNode, robots: IntArray, minorant: Minorant, threshold: float
    ) -> tuple[SizeNode, IntArray, Minorant]:
        """Decide robots by reduced cost: on their other side the minorant reaches the threshold."""
        size = self.size - len(node.inside)
        scores = minorant.scores
        chosen = np.zeros(len(scores), dtype=np.bool_)
        chosen[np.argsort(scores, kind="stable")[:size]] = True
        last, first = scores[chosen].max(), scores[~chosen].min()
        room = threshold - minorant.bound(size)
        surely_in = chosen & (first - scores >= room)
        surely_out = ~chosen & (scores - last >= room)
        free = ~(surely_in | surely_out)
        fixed = replace(
            node,
            inside=node.inside | frozenset(robots[surely_in].tolist()),
            outside=node.outside | frozenset(robots[surely_out].tolist()),
        )
        return fixed, robots[free], minorant.restricted(free, surely_in)

    def _enumeration(self, node: SizeNode, robots: IntArray, size: int, minorant: Minorant | None) -> LowSets:
        if minorant is None:
            return LowSets(self.team, robots, node.inside, size)
        affine = AffineBound(minorant.constant, minorant.scores)
        return LowSets.surest_first(self.team, robots, node.inside, size, affine)

    def _enumerate_all(self, threshold: float, budget: Budget) -> float:
        """Decide the root without a minorant, weakest robots first, where that takes no longer than is allowed."""
        root = self.open[0]
        robots, size = self._free(root)[::-1], self.size - len(root.inside)
        if not 0 <= size <= len(robots):
            return threshold
        low = LowSets(self.team, robots, root.inside, size)
        threshold = self._enumerate(low, threshold, budget, WHOLE_ENUMERATION)
        if low.finished:
            self.open.clear()
        return threshold

    def _enumerate(self, low: LowSets, threshold: float, budget: Budget, work: int) -> float:
        """Offer the sets below the threshold, up to a limit of work; returns the new threshold."""
        limit, pause = max(work // low.work_of_node, 1), max(UNINTERRUPTED // low.work_of_node, 1)
        while not low.finished and low.nodes < limit:
            found = low.next_within(threshold, min(limit - low.nodes, pause), budget)
            if found is not None:
                threshold = self.offer(found)
        return threshold

    def _split(self, node: SizeNode, bound: float, robots: IntArray, minorant: Minorant | None) -> list[SizeNode]:
        """Two nodes, by the robot with the most hidden concavity (the strongest where there is no minorant).

        Rather one whose side is clear: its other side is soon closed, and its own hides less. Preferring robots on
        neither side took ten times as long at 60 robots.
        """
        pick, with_it, without = 0, None, None
        if minorant is not None:
            x = minorant.fraction
            pick = int(np.argmax(minorant.tension * (1 - 3 * x * (1 - x))))
            it = np.arange(len(robots)) == pick
            with_it, without = minorant.restricted(~it, it), minorant.restricted(~it, np.zeros_like(it))
        robot = int(robots[pick])
        self._serial += 2
        return [
            SizeNode(bound, self._serial - 1, node.inside | {robot}, node.outside, with_it),
            SizeNode(bound, self._serial, node.inside, node.outside | {robot}, without),
        ]


def _heavy_robots(n_free: int) -> int:
    return next(heavy for most, heavy in HEAVY_ROBOTS if n_free <= most)
