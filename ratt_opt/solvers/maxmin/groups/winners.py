"""Which group of an outcome bounds the team value.

The team value is the best group's. A group that provably stays below the best plan can be left out: if all but one
can, for every plan, the outcome's *winner* is decided for the whole search; elsewhere a node divides on it.
"""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.proof import Split, TreeNode, nodes_below
from ratt_opt.solvers.maxmin.task import with_choice

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.frontier import Frontier
    from ratt_opt.solvers.maxmin.groups.closed_group import ClosedGroup, GroupProofs
    from ratt_opt.solvers.maxmin.plans.candidates import Candidates

__all__ = ["WinnerDivision", "Winners"]

UNKNOWN, UNDECIDED = -2, -1
COMPARED = 8
"""Outcomes of which the one that the fewest groups may win is divided on. Of 20 robots at (0, 180), max-eigenvalue,
before nodes were attacked whole, 1 left 5 % open after 12 s and 2 % after 30 s; 8 left 1 and 5 % after 12 s and closed
in 16 s; 32 left 5 % after 12 s."""


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
        self._reopened: dict[int, tuple[tuple[tuple[int, ...], TreeNode | None], ...]] = {}
        """Outcome -> robots of each group and the node where it wins; ``None`` is all that was searched before."""

    @property
    def decided(self) -> dict[int, int]:
        """Outcome -> winner, if other groups were closed for all plans."""
        return {outcome: int(self._winner[outcome]) for outcome in self._closed}

    def at(self, node: TreeNode) -> IntArray:
        """(O,) winner of each outcome at a node; negative if that is not decided."""
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
        missing = len(self.pool) - len(self._winner)
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

    def reconsider(self) -> list[int]:
        """After the best plan turned out worse: close again what no longer closes; the outcomes if that fails."""
        if self.proofs.rule.closes(self.finished):
            return []
        failed = []
        for outcome, closed in self._closed.items():
            for k, (group, proof) in enumerate(closed):
                if not self.proofs.rule.closes(proof.bound):
                    closed[k] = group, self.proofs.find(group, self._everything) or proof
            if any(not self.proofs.rule.closes(proof.bound) for _, proof in closed):
                failed.append(outcome)
        self._bound_closed()
        return failed

    def _bound_closed(self) -> None:
        self.finished = max((p.bound for closed in self._closed.values() for _, p in closed), default=-np.inf)

    def reopen(self, outcome: int, root: TreeNode, frontier: Frontier) -> None:
        """Divide the whole search on the winner of an outcome that was decided for all plans and no longer is.

        What was searched is the part where that winner wins; parts where others win are bounded by their old proofs
        and go to the frontier. An interrupt on the way leaves bounds and proof as valid as before.
        """
        winner, closed = int(self._winner[outcome]), self._closed[outcome]
        for node in frontier.nodes():
            node.winners.setdefault(outcome, winner)
        parts: list[tuple[tuple[int, ...], TreeNode | None]] = [(self.pool.groups[winner], None)]
        for group, proof in closed:
            node = TreeNode(choices=root.choices, winners={outcome: group}, bound=np.inf, leaf=root.leaf)
            for leaf in self.proofs.graft(node, outcome, group, proof):
                frontier.finish(leaf)
            parts.append((self.pool.groups[group], node))
        self._reopened[outcome] = tuple(parts)
        self._winner[outcome] = UNDECIDED
        del self._closed[outcome]
        self._bound_closed()

    def above(self, root: TreeNode) -> TreeNode:
        """The search tree below the branches on winners that were decided for all plans, if they are relied on.

        Those that no longer are come last, the latest above the others: only what was searched before relies on them.
        """
        top = root
        for outcome, parts in self._reopened.items():
            top = self._branch(root, outcome, [(members, top if node is None else node) for members, node in parts])
        used = {k for node in nodes_below(top) if node.split is None for k in node.leaf.cuts}
        outcomes = {int(self.proofs.cuts.outcomes[k]) for k in used}
        for outcome in sorted((outcomes & set(self._closed)) - set(self._reopened)):
            below = [(self.pool.groups[int(self._winner[outcome])], top)]
            for group, proof in self._closed[outcome]:
                node = TreeNode(choices=root.choices, winners={}, bound=-np.inf, leaf=root.leaf)
                self.proofs.graft(node, outcome, group, proof)
                below.append((self.pool.groups[group], node))
            top = self._branch(root, outcome, below)
        return top

    def _branch(self, root: TreeNode, outcome: int, parts: list[tuple[tuple[int, ...], TreeNode]]) -> TreeNode:
        split = Split(by_winner=True, subject=outcome, parts=tuple(parts))
        return TreeNode(choices=root.choices, winners={}, bound=root.bound, leaf=root.leaf, split=split)


class WinnerDivision:
    """Uses proofs of weak groups within a node's own choices; the leaves they close go to the frontier."""

    def __init__(self, winners: Winners, frontier: Frontier) -> None:
        self.task, self.pool, self.winners, self.frontier = winners.task, winners.pool, winners, frontier
        self._proofs = winners.proofs

    def close(self, node: TreeNode, outcome: int) -> bool:
        """Close a node by bounds on the winner of one outcome alone; False if that does not work."""
        winner = self.winners.of(node, outcome)
        proof = None if winner is None else self._proofs.find(winner, node.choices)
        if winner is None or proof is None:
            return False
        self._close(node, outcome, winner, proof)
        return True

    def _close(self, node: TreeNode, outcome: int, group: int, proof: ClosedGroup) -> None:
        for leaf in self._proofs.graft(node, outcome, group, proof):
            self.frontier.close(leaf)

    def undecided(self, node: TreeNode, of_robot: FloatArray, level: float) -> int | None:
        """Of the outcomes of undecided winner and smallest value below ``level`` one that the fewest groups may win."""
        values = self.pool.group_values(of_robot)
        teams = self.pool.outcome_values(values)
        rising = np.argsort(teams, kind="stable")
        low = (outcome for outcome in rising[teams[rising] < level].tolist() if self.winners.of(node, outcome) is None)
        chosen, fewest = None, np.inf
        for outcome in islice(low, COMPARED):
            groups = sorted(self.pool.of_outcome[outcome], key=lambda g: -values[g])
            may_win = (g for g in groups if self._proofs.find(g, node.choices) is None)
            count = sum(1 for _ in islice(may_win, None if chosen is None else int(fewest)))
            if count < fewest:
                chosen, fewest = outcome, count
            if fewest <= 1:
                break
        return chosen

    def divide(self, node: TreeNode, outcome: int) -> list[TreeNode]:
        """Children in which the winner of an outcome is decided, or soon will be; those that need a search.

        Groups that a bound closes within the node's choices need none. A single robot that may win
        with some of its elements only is divided into those and the others, so that the latter close.
        """
        return self._divide_lone_robot(node, outcome) or self.divide_groups(node, outcome)

    def divide_groups(self, node: TreeNode, outcome: int) -> list[TreeNode]:
        """The same by the groups alone."""
        parts, open_children = [], []
        for group in self.pool.of_outcome[outcome]:
            proof = self._proofs.find(group, node.choices)
            child = node.child(winner=(outcome, group))
            if proof is None:
                open_children.append(child)
            else:
                self._close(child, outcome, group, proof)
            parts.append((self.pool.groups[group], child))
        node.split = Split(by_winner=True, subject=outcome, parts=tuple(parts))
        return open_children

    def _divide_lone_robot(self, node: TreeNode, outcome: int) -> list[TreeNode]:
        groups = self.pool.of_outcome[outcome]
        winner = max(groups, key=lambda g: (len(self.pool.groups[g]), -g))
        for group in groups:
            if len(self.pool.groups[group]) != 1 or group == winner:
                continue
            (robot,) = self.pool.groups[group]
            choice = node.choices[robot]
            weak = self.task.singles[choice] <= self.frontier.rule.level
            if weak.any() and not weak.all():
                children = [node.child(with_choice(node.choices, robot, choice[part])) for part in (weak, ~weak)]
                node.divide(robot, children, self.task)
                return children
        return []
