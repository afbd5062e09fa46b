"""Which group of an outcome bounds the team value.

The team value is the best group's. A group that provably stays below the incumbent can be left out: where all but one
can, for every plan, the outcome's *winner* is decided for the whole search; elsewhere a node divides on it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.closed_group import close_group
from ratt_opt.solvers.maxmin.proof import Leaf
from ratt_opt.solvers.maxmin.search_tree import TreeNode, divide, representatives, with_choice

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.closed_group import ClosedGroup
    from ratt_opt.solvers.maxmin.cut_store import CutStore
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.search_tree import Classes

__all__ = ["Winners"]

UNKNOWN, UNDECIDED = -2, -1


class Winners:
    """Winners of the outcomes in the pool, decided when first asked for.

    ``finished`` : largest bound of a group closed for the whole search; part of its upper bound.
    ``close`` : is told every node that a group's proof closes within the tree.
    """

    def __init__(
        self,
        objective: InformationObjective,
        cuts: CutStore,
        incumbent: Incumbent,
        classes: Classes,
        *,
        closes: Callable[[float], bool],
        close: Callable[[TreeNode], None],
    ) -> None:
        self.objective, self.cuts, self.pool = objective, cuts, cuts.pool
        self.incumbent, self.classes = incumbent, classes
        self.closes, self.close = closes, close
        self.finished = -np.inf
        self._everything = representatives(classes)
        self._winner = np.zeros(0, dtype=np.int64)
        self._closed: dict[int, list[tuple[int, ClosedGroup]]] = {}
        self._attempts: dict[tuple[int, bytes], tuple[float, ClosedGroup | None]] = {}
        self._singles = objective.singletons()

    def at(self, node: TreeNode) -> IntArray:
        """(O,) winner of each outcome at a node; negative where that is not decided."""
        self._grow()
        winners = self._winner.copy()
        for outcome, group in node.winners.items():
            winners[outcome] = group
        return winners

    def of(self, node: TreeNode, outcome: int) -> int | None:
        """The group that bounds the team value of an outcome at this node, if that is decided."""
        if outcome in node.winners:
            return node.winners[outcome]
        self._grow()
        if self._winner[outcome] == UNKNOWN:
            self._decide(outcome)
        winner = int(self._winner[outcome])
        return winner if winner >= 0 else None

    def _grow(self) -> None:
        missing = len(self.pool.attacks) - len(self._winner)
        if missing > 0:
            self._winner = np.concatenate([self._winner, np.full(missing, UNKNOWN)])

    def _decide(self, outcome: int) -> None:
        """Close all groups of an outcome but the strongest by bounds that hold for every plan, if that works."""
        groups = self.pool.of_outcome[outcome]
        values = {g: self._value(g) for g in groups}
        winner = max(groups, key=lambda g: (values[g], -g))
        closed = []
        for group in groups:
            if group == winner:
                continue
            proof = self._close(group, self._everything)
            if proof is None:
                self._winner[outcome] = UNDECIDED
                return
            closed.append((group, proof))
        for _, proof in closed:
            self.finished = max(self.finished, proof.bound)
        if closed:
            self._closed[outcome] = closed
        self._winner[outcome] = winner

    def close_by(self, node: TreeNode, outcome: int) -> bool:
        """Close a node by bounds on the winner of one outcome alone; False where that does not work."""
        winner = self.of(node, outcome)
        proof = None if winner is None else self._close(winner, node.choices)
        if winner is None or proof is None:
            return False
        for leaf in self._grow_proof(node, outcome, winner, proof):
            self.close(leaf)
        return True

    def _value(self, group: int) -> float:
        """Value of one group under the incumbent."""
        plan = self.incumbent.best[list(self.pool.groups[group])]
        return float(self.objective.value(self.objective.posterior_information(plan)[None])[0])

    def _close(self, group: int, choices: tuple[IntArray, ...]) -> ClosedGroup | None:
        """Close a group within ``choices``; attempts are remembered until the incumbent improves."""
        members = self.pool.groups[group]
        key = (group, b"|".join(choices[i].tobytes() for i in members))
        level, proof = self._attempts.get(key, (-np.inf, None))
        if proof is not None and not self.closes(proof.bound):
            level, proof = -np.inf, None  # of a time when the incumbent seemed better
        if proof is None and level < self.incumbent.level:
            proof = close_group(self.cuts.problem, self.objective, members=members, choices=choices, closes=self.closes)
            self._attempts[key] = (self.incumbent.level, proof)
        return proof

    def _grow_proof(self, node: TreeNode, outcome: int, group: int, proof: ClosedGroup) -> list[TreeNode]:
        """Write the proof that a group is closed below ``node`` of the search tree; return its leaves."""
        if proof.cut is not None:
            node.leaf = Leaf(cuts=(self.cuts.add(outcome, group, proof.cut),), weights=(1.0,))
            node.bound = proof.bound
            return [node]
        children = [node.child(with_choice(node.choices, proof.robot, part)) for part, _ in proof.parts]
        divide(node, proof.robot, children, self.classes)
        return [
            leaf
            for child, (_, below) in zip(children, proof.parts, strict=True)
            for leaf in self._grow_proof(child, outcome, group, below)
        ]

    def reconsider(self) -> None:
        """After the incumbent turned out worse: close again what no longer closes, where that works."""
        for outcome, closed in self._closed.items():
            again = [(g, p if self.closes(p.bound) else self._close(g, self._everything) or p) for g, p in closed]
            self._closed[outcome] = again
        self.finished = max((p.bound for closed in self._closed.values() for _, p in closed), default=-np.inf)

    # -- dividing a node ---------------------------------------------------------------------------------------

    def divide(self, node: TreeNode, outcome: int) -> list[TreeNode]:
        """Children in which the winner of an outcome is decided, or soon will be; those that need a search.

        Groups that a bound closes within the node's choices need none. A single robot that may win
        with some of its elements only is divided into those and the others, so that the latter close.
        """
        groups = self.pool.of_outcome[outcome]
        winner = max(groups, key=lambda g: (len(self.pool.groups[g]), -g))
        for group in groups:
            robot = self.pool.groups[group][0]
            choice = node.choices[robot]
            weak = self._singles[choice] <= self.incumbent.level
            if len(self.pool.groups[group]) == 1 and group != winner and weak.any() and not weak.all():
                children = [node.child(with_choice(node.choices, robot, choice[part])) for part in (weak, ~weak)]
                divide(node, robot, children, self.classes)
                return children
        parts, open_children = [], []
        for group in groups:
            proof = self._close(group, node.choices)
            child = node.child(winner=(outcome, group))
            if proof is None:
                open_children.append(child)
            else:
                for leaf in self._grow_proof(child, outcome, group, proof):
                    self.close(leaf)
            parts.append((self.pool.groups[group], child))
        node.split = ("winner", outcome, parts)
        return open_children

    def undecided(self, node: TreeNode, of_robot: FloatArray, level: float) -> int | None:
        """The outcome of undecided winner with the smallest value below ``level``, if any has."""
        teams = self.pool.outcome_values(self.pool.group_values(of_robot))
        for outcome in np.argsort(teams, kind="stable").tolist():
            if teams[outcome] >= level:
                return None
            if self.of(node, outcome) is None:
                return int(outcome)
        return None

    def above(self, root: TreeNode, used: set[int]) -> TreeNode:
        """The search tree below the winner branches of those among the ``used`` outcomes decided for all plans."""
        top = root
        for outcome in sorted(used & set(self._closed)):
            winner = int(self._winner[outcome])
            children = [(self.pool.groups[winner], top)]
            for group, proof in self._closed[outcome]:
                node = TreeNode(choices=root.choices, winners={}, bound=-np.inf, leaf=root.leaf)
                self._grow_proof(node, outcome, group, proof)
                children.append((self.pool.groups[group], node))
            parent = TreeNode(choices=root.choices, winners={}, bound=root.bound, leaf=root.leaf)
            parent.split = ("winner", outcome, children)
            top = parent
        return top
