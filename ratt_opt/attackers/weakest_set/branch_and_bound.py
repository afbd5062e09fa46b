"""Branch and bound over the sets of one size for those worth less than a threshold.

Teams of up to some thirty robots are decided by a compiled depth-first search alone (``enumeration.py``). In larger
ones nodes fix robots inside or outside the set; an affine minorant (``minorant.py``) bounds them, fixes more robots by
reduced cost, and guides the same depth-first search that finishes small nodes.
"""

from __future__ import annotations

import heapq
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.enumeration import Enumeration
from ratt_opt.attackers.weakest_set.exchanges import exchanged
from ratt_opt.attackers.weakest_set.node_bounds import bound_family
from ratt_opt.attackers.weakest_set.set_node import SetNode

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
    from ratt_opt.budget import Budget

    Found = Generator[frozenset[int] | None, None, None]

__all__ = ["WeakestSetSearch"]

AT_ONCE = 34
"""Teams of so many robots are first enumerated whole, without a minorant."""
WHOLE_ENUMERATION = 4_000_000_000
SHORTEST_ENUMERATION, LONGEST_ENUMERATION = 10_000_000, 40_000_000
"""Criteria of single targets looked at (some nanoseconds each) for the whole team, and for one branch-and-bound node
before it is split: more after successes, fewer after failures."""

BETWEEN_LOOKS = 100_000_000
"""Criteria of single targets between two looks at the clock and at interrupts (about half a second)."""


class WeakestSetSearch:
    """Decides for every set of ``size`` robots whether it is worth less than ``threshold``.

    The caller may lower ``threshold`` at every step of :meth:`run`; sets between are then passed over.

    Parameters
    ----------
    floor : no set is worth less
    inside, outside : only sets that contain the first and avoid the second
    """

    def __init__(
        self,
        team: PlanarTeam,
        size: int,
        threshold: float,
        floor: float = -np.inf,
        *,
        inside: frozenset[int] = frozenset(),
        outside: frozenset[int] = frozenset(),
    ) -> None:
        self.team, self.size, self.threshold = team, size, threshold
        self._inside, self._among = inside, frozenset(range(len(team.single))) - outside
        self._work = LONGEST_ENUMERATION
        self._open = [SetNode(floor, 0, inside, outside)]
        self._serial = 1
        self._in_hand = np.inf
        """No set of the node that is being looked at is worth less."""

    @property
    def lower(self) -> float:
        """No set still undecided is worth less; infinite once all are decided."""
        return min([self._in_hand, *(node.bound for node in self._open[:1])])

    def run(self, budget: Budget) -> Iterator[frozenset[int] | None]:
        """Yield sets worth less than the threshold as they are found, and ``None`` where :attr:`lower` may have risen.

        :attr:`lower` stays valid when the budget runs out or the user interrupts.
        """
        if len(self._among) <= AT_ONCE:
            yield from self._enumerate_all(budget)
        while self._open and self._open[0].bound < self.threshold:
            node = heapq.heappop(self._open)
            self._in_hand = node.bound
            yield from self._explore(node, budget)
            self._in_hand = np.inf
            yield None
        self._open.clear()

    def _explore(self, node: SetNode, budget: Budget) -> Found:
        """Bound a node, then decide it by enumeration or split it."""
        budget.spend()
        robots, size = node.undecided(self.team), self.size - len(node.inside)
        if not 0 <= size <= len(robots):
            return
        found = bound_family(self.team.family(robots, size, node.inside), self.threshold, node.minorant)
        bound = self._in_hand = max(node.bound, found.bound)
        if found.suggested is not None:
            yield from self._try(node, robots[found.suggested])
        if bound >= self.threshold:
            return
        yield None
        node, robots = replace(node, minorant=found.minorant).fixed(robots, size, self.threshold)
        sets = node.enumeration(self.team, robots, self.size - len(node.inside))
        yield from self._enumerate(sets, budget, self._work)
        work = int(self._work * (1.3 if sets.finished else 0.8))
        self._work = min(max(work, SHORTEST_ENUMERATION), LONGEST_ENUMERATION)
        if not sets.finished:
            for child in node.split(robots, bound, self._serial):
                heapq.heappush(self._open, child)
            self._serial += 2

    def _try(self, node: SetNode, others: IntArray) -> Found:
        """The set that the bound suggests, and as improved by exchanges."""
        candidate = node.inside | frozenset(others.tolist())
        for one in (candidate, exchanged(self.team, candidate, among=self._among, fixed=self._inside)):
            if self.team.value(one) < self.threshold:
                yield one

    def _enumerate_all(self, budget: Budget) -> Found:
        """Decide the root without a minorant, weakest robots first, where that takes no longer than is allowed."""
        root = self._open[0]
        robots, size = root.undecided(self.team)[::-1], self.size - len(root.inside)
        if 0 <= size <= len(robots):
            sets = Enumeration(self.team, robots, root.inside, size)
            yield from self._enumerate(sets, budget, WHOLE_ENUMERATION)
            if sets.finished:
                self._open.clear()

    def _enumerate(self, sets: Enumeration, budget: Budget, work: int) -> Found:
        """The sets below the threshold, up to a limit of work."""
        limit, pause = max(work // sets.work_of_node, 1), max(BETWEEN_LOOKS // sets.work_of_node, 1)
        while not sets.finished and sets.nodes < limit:
            found = sets.next_within(self.threshold, min(limit - sets.nodes, pause), budget)
            if found is not None:
                yield found
