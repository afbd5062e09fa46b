"""Proofs that every attack leaves a group worth a threshold, by prices of robots that no weak group pays.

The attacker's search (``attackers/by_prices``) finds the prices in floating point. Here they become integers, and the
search over the robots that see in a group becomes a tree that the verifier follows
(``verifier/lower_end/group_prices.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attack.pricing import Plan
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.group_bounds import BLINDED, ELSE, OPEN, OUTSIDE, SEEING, GroupBounds
from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.size_tree import size_tree
from ratt_opt.certificates.verifier.work import seconds_left, tell, tick

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.by_prices.prices import PriceVector
    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["group_price_proof"]

SEARCHED = 2_000_000
"""Nodes of the search for prices: seconds, up to half a minute at 30 robots."""

LARGEST_PROOF = 1_500_000
"""Most integers of a proof; the verifier reads files of two million."""


@dataclass(frozen=True, slots=True)
class _Node:
    """``part`` (N,) what robots are; ``room`` further robots that may see; ``grown`` : one has just begun to see."""

    part: IntArray
    posterior: FloatArray
    room: int
    grown: bool = True

    @classmethod
    def of(cls, part: IntArray, posterior: FloatArray, room: int) -> _Node:
        """One in which a robot has begun to see; without room, no other can."""
        return cls(part if room else np.where(part == OPEN, ELSE, part), posterior, room)


def group_price_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Return the record of a proof of the sets' threshold.

    Raises
    ------
    NotClosedError : no prices were found, or the tree is too large.
    """
    prices, size = _prices(sets)
    bounds = GroupBounds(sets.problem.threat, prices)
    sizes = size_tree(sets, size + 1, max_nodes)
    tree = _SeeingTree(sets, bounds, max_nodes).run(size)
    return {
        "kind": "group_prices",
        "half_link": bounds.half_link,
        "robots": bounds.robot.tolist(),
        "blinded": bounds.blinded,
        "size": size,
        "sizes": sizes,
        "flows": [{"surcharge": surcharge, "links": flow.tolist()} for surcharge, flow in bounds.used],
        "tree": tree,
    }


def _prices(sets: PlanSets) -> tuple[PriceVector, int]:
    """Prices that refute the threshold, and the largest size of a set worth less."""
    from ratt_opt.attackers.by_prices.decision import ThresholdDecision

    problem, seconds = sets.problem, seconds_left()
    plan = Plan.of(problem.objective, sets.elements, problem.threat)
    if plan is None:
        raise NotClosedError
    budget = Budget(None if seconds == np.inf else seconds)
    decision = ThresholdDecision(plan)
    try:
        prices = decision.refuting_prices(sets.threshold, budget, SEARCHED)
        size = plan.most_below(sets.threshold)
    except OutOfBudget:
        raise NotClosedError from None
    if prices is None:
        raise NotClosedError
    return prices, size


class _SeeingTree:
    """Decide robot by robot who sees in a group, until a bound shows that it does not pay.

    A group with a robot more is worth no less: an open robot that would bring it to the threshold is shown not to see.
    """

    def __init__(self, sets: PlanSets, bounds: GroupBounds, max_nodes: int) -> None:
        self.sets, self.bounds, self.max_nodes = sets, bounds, max_nodes
        self.own = sets.objective.information[sets.elements]
        self.tree: list[int] = []

    def run(self, size: int) -> list[int]:
        n_robots = len(self.own)
        stack = [_Node.of(np.full(n_robots, OPEN), self.sets.start(), size)]
        while stack:
            tick()
            tell(COVERING, len(self.tree))
            if len(self.tree) > self.max_nodes or len(self.tree) + self.bounds.length > LARGEST_PROOF:
                raise NotClosedError
            self._expand(stack.pop(), stack)
        return self.tree

    def _expand(self, node: _Node, stack: list[_Node]) -> None:
        if self._is_closed(node.part, node.room):
            return
        filled, worth = self._filled(node)
        if node.grown and self._closed_by_less(node, filled):
            return
        sides = self.bounds.cut(filled.part, filled.room)
        if self._closed_by_less(node, filled):
            return
        self._emit(node, filled)
        self._branch(filled, sides, worth, stack)

    def _is_closed(self, part: IntArray, room: int) -> bool:
        k = self.bounds.closing(part, room)
        if k is not None:
            self.tree.append(-3 - 2 * k)
        return k is not None

    def _closed_by_less(self, node: _Node, filled: _Node) -> bool:
        """Whether a known bound closes the filled node; as little of the filling as suffices is written down.

        Of the room only with the robots that cannot see: averages over all of the open ones may be too low.
        """
        if self.bounds.closing(filled.part, filled.room) is None:
            return False
        for part in (node.part, filled.part):
            if self.bounds.closing(part, node.room) is not None:
                filled = _Node(part, filled.posterior, node.room)
                break
        self._emit(node, filled)
        return self._is_closed(filled.part, filled.room)

    def _filled(self, node: _Node) -> tuple[_Node, FloatArray]:
        """The node without the open robots that cannot see, and with no more room than averages leave."""
        worth, (open_,) = np.zeros(len(node.part)), np.nonzero(node.part == OPEN)
        if not len(open_):
            return node, worth
        worth[open_] = self.sets.values(node.posterior + self.own[open_])
        part, room = node.part.copy(), node.room
        part[open_[worth[open_] >= self.sets.threshold]] = ELSE
        left = np.flatnonzero(part == OPEN)
        room = min(room, len(left))
        while room > 1 and self.sets.completions_enough(node.posterior + room * self.own[left], room):
            room -= 1
        return _Node(part, node.posterior, room), worth

    def _emit(self, node: _Node, filled: _Node) -> None:
        for i in np.flatnonzero(node.part != filled.part).tolist():
            self.tree += [2 * i, -1]
        if filled.room < min(node.room, int((filled.part == OPEN).sum())):
            self.tree.append(-2 - 2 * filled.room)

    def _branch(self, node: _Node, sides: Any, worth: FloatArray, stack: list[_Node]) -> None:
        """On the open robot inside a minimum cut that is worth most, or else on one that is blinded or outside."""
        part = node.part
        for side in sides:
            inside = np.flatnonzero(side & (part == OPEN))
            if len(inside):
                i = int(inside[np.argmax(worth[inside])])
                self.tree.append(2 * i)
                stack.append(_Node(_with(part, i, ELSE), node.posterior, node.room, grown=False))
                stack.append(_Node.of(_with(part, i, SEEING), self.sets.extend(node.posterior, i), node.room - 1))
                return
        inside = np.flatnonzero(sides[-1] & (part == ELSE))
        if not len(inside):
            raise NotClosedError
        i = int(inside[-1])
        self.tree.append(2 * i + 1)
        stack.append(_Node(_with(part, i, OUTSIDE), node.posterior, node.room, grown=False))
        stack.append(_Node(_with(part, i, BLINDED), node.posterior, node.room, grown=False))


def _with(part: IntArray, robot: int, what: int) -> IntArray:
    changed = part.copy()
    changed[robot] = what
    return changed
