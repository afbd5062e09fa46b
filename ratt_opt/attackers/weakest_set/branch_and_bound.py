"""Branch and bound over the sets of one size for those worth less than a threshold.

Teams of up to some thirty robots are decided by a compiled depth-first search alone (``enumeration.py``). In larger
ones nodes fix robots inside or outside the set; an affine minorant (``minorant.py``) bounds them, fixes more robots by
reduced cost, and guides the same depth-first search that finishes small nodes.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from ratt_opt.attackers.weakest_set.enumeration import AffineBound, Enumeration
from ratt_opt.attackers.weakest_set.exchanges import exchanged
from ratt_opt.attackers.weakest_set.minorant import Minorant, affine_minorant
from ratt_opt.attackers.weakest_set.pair_bound import pairs_of_family
from ratt_opt.attackers.weakest_set.weakest_axis import weakest_axis

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.weakest_set.by_targets.decomposition import Decomposition
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam, SetFamily
    from ratt_opt.budget import Budget

    Found = Generator[frozenset[int] | None, None, None]

__all__ = ["FamilyBound", "SetNode", "WeakestSetSearch", "bound_family"]


Bound = TypeVar("Bound", "Minorant", "Decomposition")


@dataclass(frozen=True, slots=True, order=True)
class SetNode(Generic[Bound]):
    """Sets of robots that contain ``inside`` and avoid ``outside``; none is worth less than ``bound``.

    ``minorant`` : over the undecided robots, strongest first, of these sets or of more
    """

    bound: float
    serial: int
    inside: frozenset[int] = field(compare=False)
    outside: frozenset[int] = field(compare=False)
    minorant: Bound | None = field(compare=False, default=None)

    def undecided(self, team: PackedTeam) -> IntArray:
        """Robots neither inside nor outside, strongest first."""
        order = np.argsort(-team.single, kind="stable")
        return np.array([i for i in order.tolist() if i not in self.inside and i not in self.outside], dtype=np.int64)

    def fixed(self, robots: IntArray, size: int, threshold: float) -> tuple[SetNode[Bound], IntArray]:
        """Decide robots by reduced cost: on their other side the minorant reaches the threshold.

        ``robots`` : the undecided ones, of which ``size`` are chosen

        Returns the node with those decided, and the robots left.
        """
        if self.minorant is None:
            return self, robots
        scores = self.minorant.scores
        chosen = np.zeros(len(scores), dtype=np.bool_)
        chosen[np.argsort(scores, kind="stable")[:size]] = True
        last, first = scores[chosen].max(), scores[~chosen].min()
        room = threshold - self.minorant.bound(size)
        surely_in = chosen & (first - scores >= room)
        surely_out = ~chosen & (scores - last >= room)
        free = ~(surely_in | surely_out)
        inside = self.inside | frozenset(robots[surely_in].tolist())
        outside = self.outside | frozenset(robots[surely_out].tolist())
        minorant = self.minorant.restricted(free, surely_in)
        return replace(self, inside=inside, outside=outside, minorant=minorant), robots[free]

    def enumeration(self, team: PackedTeam, robots: IntArray, size: int) -> Enumeration:
        """The sets of the node one by one: ``size`` of the undecided ``robots``."""
        if self.minorant is None:
            return Enumeration(team, robots, self.inside, size)
        affine = AffineBound(self.minorant.constant, self.minorant.scores)
        return Enumeration.surest_first(team, robots, self.inside, size, affine)

    def split(self, robots: IntArray, bound: float, serial: int) -> tuple[SetNode[Bound], SetNode[Bound]]:
        """Two nodes, by the robot with the most hidden concavity (the strongest where there is no minorant).

        Rather one whose side is clear: its other side is soon closed, and its own hides less. Preferring robots on
        neither side took ten times as long at 60 robots.
        """
        pick, with_it, without = 0, None, None
        if self.minorant is not None:
            x = self.minorant.fraction
            pick = int(np.argmax(self.minorant.tension * (1 - 3 * x * (1 - x))))
            it = np.arange(len(robots)) == pick
            with_it = self.minorant.restricted(~it, it)
            without = self.minorant.restricted(~it, np.zeros_like(it))
        robot = frozenset([int(robots[pick])])
        return (
            SetNode(bound, serial, self.inside | robot, self.outside, with_it),
            SetNode(bound, serial + 1, self.inside, self.outside | robot, without),
        )


HEAVY_ROBOTS = ((50, 4), (10**9, 5))
"""(Undecided robots up to, robots per target whose patterns the minorant enumerates): few nodes are afforded above.
Each doubles the polytopes and sharpens the bound: with two instead of four, 1.7 times the nodes at 40 robots."""


def heavy_robots(n_free: int) -> int:
    """Robots per target whose patterns the minorant of sets of so many free robots enumerates."""
    return next(heavy for most, heavy in HEAVY_ROBOTS if n_free <= most)


@dataclass(frozen=True, slots=True)
class FamilyBound:
    """No set is worth less than ``bound``; ``suggested`` (size,) are positions of robots that may come near it.

    ``minorant`` : where the bound comes from one
    """

    bound: float
    suggested: IntArray | None = None
    minorant: Minorant | None = None


def bound_family(family: SetFamily, goal: float, parent: Minorant | None, budget: Budget) -> FamilyBound:
    """Bound a family by its worst axis where that decides, and else by an affine minorant; not in the plane, by pairs.

    ``goal`` : no better bound is needed; ``parent`` : a minorant of a larger family; ``budget`` : once it is over, the
    minorant is taken as it is
    """
    if family.team.is_by_axis:
        axis = weakest_axis(family)
        return FamilyBound(axis.bound, axis.chosen)
    if not family.team.is_planar:
        return FamilyBound(pairs_of_family(family))
    n_free = len(family.information)
    if not 0 < family.size < n_free:
        return FamilyBound(-np.inf)
    minorant = affine_minorant(family, heavy_robots(n_free), goal, parent, budget)
    weakest = np.lexsort((minorant.scores, -minorant.fraction))[: family.size]
    return FamilyBound(minorant.bound(family.size), weakest, minorant)


AT_ONCE = 34
"""Teams of so many robots are first enumerated whole, without a minorant: that settles them sooner than bounds do."""
WHOLE_ENUMERATION = 4_000_000_000
SHORTEST_ENUMERATION, LONGEST_ENUMERATION = 10_000_000, 40_000_000
"""Criteria of single targets looked at (some nanoseconds each) for the whole team, and for one branch-and-bound node
before it is split: more after successes, fewer after failures."""
BETWEEN_LOOKS = 100_000_000
"""Criteria of single targets between two looks at the clock and at interrupts (about half a second)."""


class WeakestSetSearch:
    """Decides for every set of ``size`` robots whether it is worth less than ``threshold``.

    The caller may lower ``threshold`` at every step of :meth:`run`; sets between are then passed over.

    ``floor`` : no set is worth less; ``inside``, ``outside`` : only sets that contain the first and avoid the second
    """

    def __init__(
        self,
        team: PackedTeam,
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
        self._open: list[SetNode[Minorant]] = [SetNode(floor, 0, inside, outside)]
        self._serial = 1
        self._in_hand = np.inf
        """No set of the node that is being looked at is worth less."""

    @property
    def lower(self) -> float:
        """No set still undecided is worth less; infinite once all are decided."""
        return min([self._in_hand, *(node.bound for node in self._open[:1])])

    def run(self, budget: Budget) -> Iterator[frozenset[int] | None]:
        """Yield sets worth less than the threshold as they are found, and ``None`` where :attr:`lower` may have risen.

        :attr:`lower` stays valid when the budget runs out or the user interrupts, and another run goes on from there.
        """
        is_whole = bool(self._open) and self._serial == 1  # neither decided nor divided
        if is_whole and len(self._among) <= AT_ONCE:
            yield from self._enumerate_all(budget)
        while self._open and self._open[0].bound < self.threshold:
            node = heapq.heappop(self._open)
            self._in_hand = node.bound
            try:
                yield from self._explore(node, budget)
            except BaseException:  # out of budget, interrupted, or closed: another run goes on with the node
                heapq.heappush(self._open, replace(node, bound=self._in_hand))
                raise
            finally:
                self._in_hand = np.inf
            yield None
        self._open.clear()

    def _explore(self, node: SetNode[Minorant], budget: Budget) -> Found:
        """Bound a node, then decide it by enumeration or split it."""
        budget.spend()
        robots, size = node.undecided(self.team), self.size - len(node.inside)
        if not 0 <= size <= len(robots):
            return
        found = bound_family(self.team.family(robots, size, node.inside), self.threshold, node.minorant, budget)
        bound = self._in_hand = max(node.bound, found.bound)
        if found.suggested is not None:
            yield from self._try(node, robots[found.suggested], budget)
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

    def _try(self, node: SetNode[Minorant], others: IntArray, budget: Budget) -> Found:
        """The set that the bound suggests, and as improved by exchanges."""
        candidate = node.inside | frozenset(others.tolist())
        for one in (candidate, exchanged(self.team, candidate, among=self._among, fixed=self._inside, budget=budget)):
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
