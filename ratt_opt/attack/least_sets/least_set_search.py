"""The sets of one size that are worth less than a threshold, in teams of any size.

A search in depth (``sets_of_size.py``) decides most questions at once. If it takes long, branch and bound divides the
sets by robots that are inside or outside. At each node an affine underestimator of the value bounds the sets, decides
robots by reduced cost, and orders them for the search in depth, which finishes small nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.exchanges import exchanged
from ratt_opt.attack.least_sets.sets_of_size import BoundedSets, SetFamily
from ratt_opt.attack.least_sets.underestimator import affine_underestimator
from ratt_opt.attack.least_sets.weakest_axis import weakest_axis
from ratt_opt.search.open_nodes import OpenNodes

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.least_sets.underestimator import Underestimator
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget

    Found = Generator[frozenset[int] | None, None, None]

__all__ = ["LeastSetSearch", "SetNode"]


@dataclass(frozen=True, slots=True, order=True)
class SetNode:
    """Sets of robots that contain ``inside`` and avoid ``outside``; none is worth less than ``bound``.

    ``underestimator`` : over the undecided robots, strongest first, of these sets or of more
    ``is_bounded`` : whether a bound of its own was computed
    """

    bound: float
    serial: int
    inside: frozenset[int] = field(compare=False)
    outside: frozenset[int] = field(compare=False)
    underestimator: Underestimator | None = field(compare=False, default=None)
    is_bounded: bool = field(compare=False, default=False)

    def undecided(self, team: Team) -> IntArray:
        """Robots neither inside nor outside, strongest first."""
        order = np.argsort(-team.single, kind="stable")
        return np.array([i for i in order.tolist() if i not in self.inside and i not in self.outside], dtype=np.int64)

    def fixed(self, robots: IntArray, size: int, threshold: float) -> tuple[SetNode, IntArray]:
        """Decide robots by reduced cost: on their other side the underestimator reaches the threshold.

        ``robots`` : the undecided ones, of which ``size`` are chosen

        Returns the node with those decided, and the robots left.
        """
        if self.underestimator is None:
            return self, robots
        scores = self.underestimator.scores
        chosen = np.zeros(len(scores), dtype=np.bool_)
        chosen[np.argsort(scores, kind="stable")[:size]] = True
        last, first = scores[chosen].max(), scores[~chosen].min()
        room = threshold - self.underestimator.bound(size)
        surely_in = chosen & (first - scores >= room)
        surely_out = ~chosen & (scores - last >= room)
        free = ~(surely_in | surely_out)
        inside = self.inside | frozenset(robots[surely_in].tolist())
        outside = self.outside | frozenset(robots[surely_out].tolist())
        underestimator = self.underestimator.restricted(free, surely_in)
        return replace(self, inside=inside, outside=outside, underestimator=underestimator), robots[free]

    def split(self, robots: IntArray, bound: float, serial: int) -> tuple[SetNode, SetNode]:
        """Two nodes, by the robot with the most hidden concavity (the strongest if there is no underestimator).

        Rather one whose side is clear: its other side is soon closed, and its own hides less. Preferring robots on
        neither side took ten times as long at 60 robots.
        """
        pick, with_it, without = 0, None, None
        if self.underestimator is not None:
            x = self.underestimator.fraction
            pick = int(np.argmax(self.underestimator.tension * (1 - 3 * x * (1 - x))))
            it = np.arange(len(robots)) == pick
            with_it = self.underestimator.restricted(~it, it)
            without = self.underestimator.restricted(~it, np.zeros_like(it))
        robot = frozenset([int(robots[pick])])
        return (
            SetNode(bound, serial, self.inside | robot, self.outside, with_it),
            SetNode(bound, serial + 1, self.inside, self.outside | robot, without),
        )


class LeastSetSearch:
    """Search that decides for every set of ``size`` robots whether it is worth less than ``threshold``.

    The caller may lower ``threshold`` at every step of :meth:`run`; sets between are then passed over.

    ``floor`` : no set is worth less; ``inside``, ``outside`` : only sets that contain the first and avoid the second
    ``in_depth`` : partial sets looked at before branch and bound, in the place of those of the parameters

    The loop over nodes is its own, not that of ``search/branch_and_bound.py``: sets are handed out while a node is in
    hand, one by one, and the caller lowers the threshold between two of them, by which the rest of the node is bounded.
    """

    def __init__(
        self,
        team: Team,
        size: int,
        threshold: float,
        floor: float = -np.inf,
        *,
        inside: frozenset[int] = frozenset(),
        outside: frozenset[int] = frozenset(),
        in_depth: int | None = None,
    ) -> None:
        self.team, self.size, self.threshold, self._in_depth = team, size, threshold, in_depth
        self._inside, self._outside = inside, outside
        root = SetNode(floor, 0, inside, outside)
        self._nodes, left = OpenNodes([root]), root.undecided(team)
        is_wide = len(inside) < size <= len(inside) + len(left)
        self._whole: BoundedSets | None = self._sets(root, left) if is_wide else None
        self._serial, self._work = 1, self.team.params.set_search.most

    @property
    def lower(self) -> float:
        """No set still undecided is worth less; infinite once all are decided."""
        return float(self._nodes.bound)

    def run(self, budget: Budget) -> Iterator[frozenset[int] | None]:
        """Yield sets worth less than the threshold as they are found, and ``None`` when :attr:`lower` may have risen.

        :attr:`lower` stays valid when the budget runs out or the user interrupts, and another run goes on from there.
        """
        if self._whole is not None:
            yield from self._search_whole(self._whole, budget)
        while self._nodes and self._nodes.bound < self.threshold:
            yield from self._explore(self._nodes.take(), budget)
            self._nodes.done()
            yield None
        self._nodes.clear()

    def rising_bounds(self, budget: Budget) -> Iterator[float]:
        """Yield bounds on the least set as they rise, up to its value; each set found lowers the threshold.

        Raises
        ------
        OutOfBudget : the budget is spent; the bounds hold.
        """
        for found in self.run(budget):
            if found is not None:
                self.threshold = min(self.threshold, self.team.value(found))
            yield min(self.lower, self.threshold)
        yield self.threshold

    def _search_whole(self, sets: BoundedSets, budget: Budget) -> Found:
        """Search in depth without bounds; to the end if there are none."""
        most = next(nodes for robots, nodes in self.team.params.set_search.whole if self.team.robots <= robots)
        most = min(most, self.team.params.set_search.by_axis) if self.team.is_by_axis else most
        most = most if self._in_depth is None else self._in_depth
        while sets.nodes < most or not self.team.is_planar:
            found = sets.next(self.threshold, sets.nodes + most + 1, budget)
            if found is False:
                self._whole = None
                self._nodes.clear()
                return
            root = self._nodes.take()
            self._nodes.raise_bound(replace(root, bound=max(root.bound, min(sets.least_open, self.threshold))))
            yield found
        self._whole = None

    def _explore(self, node: SetNode, budget: Budget) -> Found:
        """Bound a node, then decide it by a search in depth or split it."""
        budget.spend()
        robots, size = node.undecided(self.team), self.size - len(node.inside)
        if size == 0:
            yield from self._try(node.inside, budget)
        if not 0 < size <= len(robots):
            return
        if not node.is_bounded:
            node, suggested = self._bounded(node, robots, size, budget)
            self._nodes.raise_bound(node)
            yield from self._try(node.inside | frozenset(robots[suggested].tolist()), budget)
        if node.bound >= self.threshold:
            return
        yield None
        node, robots = node.fixed(robots, size, self.threshold)
        sets, finished = self._sets(node, robots), False
        while not finished and sets.nodes < self._work:
            found = sets.next(self.threshold, self._work, budget)
            finished = found is False
            if found:
                yield found
        params = self.team.params.set_search
        factor = params.after_success if finished else params.after_failure
        self._work = min(max(int(self._work * factor), params.fewest), params.most)
        if not finished:
            self._nodes.keep(node.split(robots, node.bound, self._serial))
            self._serial += 2

    def _bounded(self, node: SetNode, robots: IntArray, size: int, budget: Budget) -> tuple[SetNode, IntArray]:
        """The node with its bound, and positions (size,) of robots whose set may come near it."""
        family, first = SetFamily.of(self.team, robots, size, node.inside), np.arange(size)
        if self.team.is_by_axis:
            axis = weakest_axis(family)
            return replace(node, bound=max(node.bound, axis.bound), is_bounded=True), axis.chosen
        if not self.team.is_planar or size == len(robots):
            return replace(node, underestimator=None, is_bounded=True), first
        heavy = next(heavy for most, heavy in self.team.params.set_search.heavy if len(robots) <= most)
        underestimator = affine_underestimator(family, heavy, self.threshold, node.underestimator, budget)
        weakest = np.lexsort((underestimator.scores, -underestimator.fraction))[:size]
        return replace(
            node, bound=max(node.bound, underestimator.bound(size)), underestimator=underestimator, is_bounded=True
        ), weakest

    def _sets(self, node: SetNode, robots: IntArray) -> BoundedSets:
        """The sets of a node, among the undecided ``robots``."""
        size, underestimator = self.size - len(node.inside), node.underestimator
        scores = None if underestimator is None else (underestimator.constant, underestimator.scores)
        return BoundedSets(self.team, robots, node.inside, size, self.threshold, scores)

    def _try(self, candidate: frozenset[int], budget: Budget) -> Found:
        """The set that a bound suggests, and as improved by exchanges."""
        among = frozenset(range(self.team.robots)) - self._outside
        for one in (candidate, exchanged(self.team, candidate, among=among, fixed=self._inside, budget=budget)):
            if self.team.value(one) < self.threshold:
                yield one
