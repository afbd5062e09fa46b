"""Which group of an outcome bounds the team value.

The team value is the best group's. A group that provably stays below the best plan can be left out: where all but one
can, for every plan, the outcome's *winner* is decided for the whole search; elsewhere a node divides on it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.tree import Split, TreeNode

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.solvers.maxmin.groups.closed_group import ClosedGroup
    from ratt_opt.solvers.maxmin.groups.group_proofs import GroupProofs
    from ratt_opt.solvers.maxmin.plans.candidates import Candidates

__all__ = ["Winners"]

UNKNOWN, UNDECIDED = -2, -1


class Winners:
    """Winners of the outcomes in the pool, decided when first asked for.

    ``finished`` : largest bound of a group closed for the whole search; part of its upper bound.
    """

    def __init__(self, proofs: GroupProofs, plans: Candidates) -> None:
        self.task, self.pool, self.proofs, self.plans = proofs.task, proofs.pool, proofs, plans
        self.finished = -np.inf
        self._everything = self.task.choices
        self._winner = np.zeros(0, dtype=np.int64)
        self._closed: dict[int, list[tuple[int, ClosedGroup]]] = {}

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
            proof = self.proofs.find(group, self._everything)
            if proof is None:
                self._winner[outcome] = UNDECIDED
                return
            closed.append((group, proof))
        if closed:
            self._closed[outcome] = closed
            self.finished = max(self.finished, *(proof.bound for _, proof in closed))
        self._winner[outcome] = winner

    def _value(self, group: int) -> float:
        """Value of one group under the best plan."""
        objective, plan = self.task.objective, self.plans.best[list(self.pool.groups[group])]
        return float(objective.value(objective.posterior_information(plan)[None])[0])

    def reconsider(self) -> None:
        """After the best plan turned out worse: close again what no longer closes, where that works."""
        if self.proofs.rule.closes(self.finished):
            return
        for outcome, closed in self._closed.items():
            self._closed[outcome] = [(g, self._again(g, proof)) for g, proof in closed]
        self.finished = max((p.bound for closed in self._closed.values() for _, p in closed), default=-np.inf)

    def _again(self, group: int, proof: ClosedGroup) -> ClosedGroup:
        if self.proofs.rule.closes(proof.bound):
            return proof
        return self.proofs.find(group, self._everything) or proof

    def above(self, root: TreeNode, used: set[int]) -> TreeNode:
        """The search tree below the winner branches of those among the ``used`` outcomes decided for all plans."""
        top = root
        for outcome in sorted(used & set(self._closed)):
            parts = [(self.pool.groups[int(self._winner[outcome])], top)]
            for group, proof in self._closed[outcome]:
                node = TreeNode(choices=root.choices, winners={}, bound=-np.inf, leaf=root.leaf)
                self.proofs.graft(node, outcome, group, proof)
                parts.append((self.pool.groups[group], node))
            top = TreeNode(choices=root.choices, winners={}, bound=root.bound, leaf=root.leaf)
            top.split = Split(by_winner=True, subject=outcome, parts=tuple(parts))
        return top
