"""The nodes of a search and the bound they leave, which bounds are low enough, and which divisions were needless.

Divisions that a proof does not rely on are taken back. A node is divided on the winner of an outcome. If everything
below one of its children is closed and no leaf there uses a cut on that outcome, the child's proof is one for the whole
node, for every winner. Its siblings need no search then. The same holds for elements that were left out: if the leaves
below still close with them, leaving them out was needless, and so was what that relied on.

Source: conflict-directed backjumping (Prosser 1993).
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.search.open_nodes import OpenNodes
from ratt_opt.solvers.maxmin.elements import with_choice
from ratt_opt.solvers.maxmin.proof import nodes_below

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.solvers.maxmin.candidates import Candidates
    from ratt_opt.solvers.maxmin.cut_store import CutStore
    from ratt_opt.solvers.maxmin.proof import Split, TreeNode
    from ratt_opt.solvers.maxmin.value_spacing import ValueSpacing

__all__ = ["Backjumps", "ClosingRule", "Frontier"]


class ClosingRule:
    """A bound closes a node if no plan below it can be better than the best known, by more than the gap.

    Below that plan's level, proved or not, no better one is to be found. A new outcome may lower the level; then what
    was closed may have to be opened again.
    """

    def __init__(self, plans: Candidates, gap: float, spacing: ValueSpacing | None = None) -> None:
        self.plans, self.gap, self.spacing = plans, gap, spacing
        # A bound may stay so much above a level that it cannot be told from: tangents carry margins of some roundings.
        # Half of what a result counts as closed. With one of them a team whose optimum is 0 was divided without end.
        self._rounding = 8 * plans.pool.objective.rounding

    @property
    def level(self) -> float:
        """Value of the best plan under the known outcomes."""
        return self.plans.level

    @property
    def better(self) -> float:
        """The level that a plan has to exceed to be better by more than the gap."""
        better = (self.level + self._rounding) / (1 - min(self.gap, 0.5))  # a gap of 1 has no such level
        return max(better, self._between)

    @property
    def _between(self) -> float:
        """Bounds up to this close, as no plan has a value between it and one that is not better."""
        if self.spacing is None:
            return -np.inf
        nearly = 1 - 1e-9  # of the next value that a plan can have: rounding must not reach it
        largest = self.spacing.below(self.spacing.next_above(self.level) * nearly)
        return self.spacing.next_above(largest) * nearly if self._missing(largest) >= 0 else -np.inf

    def closes(self, bound: float) -> bool:
        """Tell whether a bound is low enough to close a node."""
        return bool(np.isfinite(bound)) and self.missing(bound) >= 0

    def missing(self, bound: float) -> float:
        """Return the amount by which a bound may rise and still close; negative if it does not close."""
        return max(self._missing(bound), self._between - bound)

    def _missing(self, bound: float) -> float:
        return self.level + self.gap * abs(bound) + self._rounding - bound


class OpenTreeNode:
    """A node of the tree that is open: the largest bound comes first, and no solution of a dropped one counts."""

    __slots__ = ("_order", "node")

    def __init__(self, node: TreeNode, serial: int) -> None:
        self.node, self._order = node, (-node.bound, serial)

    @property
    def bound(self) -> float:
        """Negated bound of the node."""
        return np.inf if self.node.is_dropped else -self.node.bound

    def __lt__(self, other: OpenTreeNode) -> bool:
        return self._order < other._order


class Frontier:
    """Nodes that are open, and those that were closed; any interrupt leaves a valid bound.

    ``depth_first`` : whether the latest node is taken, instead of the one of largest bound.
    """

    def __init__(self, rule: ClosingRule, root: TreeNode, *, depth_first: bool = False) -> None:
        self.rule = rule
        self.open: OpenNodes[OpenTreeNode] = OpenNodes([OpenTreeNode(root, 0)], 0 if depth_first else np.inf)
        self._pushed = 1
        self._closed: list[TreeNode] = []
        self.fresh: list[TreeNode] = []
        """Nodes that were closed and not followed up the tree; see :class:`Backjumps`."""
        self._settled: list[tuple[TreeNode, int]] = []
        """Nodes of a single plan, and how many outcomes were known when their bounds were found."""
        self._finished = -np.inf

    @property
    def bound(self) -> float:
        """The largest bound of an open or finished node."""
        settled = [node.bound for node, _ in self._settled if not node.is_dropped]
        return max([self._finished, self._largest, *settled])

    @property
    def is_closed(self) -> bool:
        """True if every open node closes."""
        largest = self._largest
        return not self.open or self.rule.closes(largest)

    @property
    def _largest(self) -> float:
        """The largest bound of an open node."""
        self.open.prune(lambda one: one.node.is_dropped)
        return -float(self.open.bound)

    def queued(self, node: TreeNode) -> OpenTreeNode:
        """Return a node as the queue has it, behind those of the same bound."""
        self._pushed += 1
        return OpenTreeNode(node, self._pushed)

    def push(self, node: TreeNode) -> None:
        """Queue an open node."""
        self.open.keep([self.queued(node)])

    def nodes(self) -> Iterator[TreeNode]:
        """All that are open, closed or settled."""
        queued, settled = (one.node for one in self.open), (node for node, _ in self._settled)
        return chain(queued, self._closed, settled)

    def finish(self, node: TreeNode) -> None:
        """Close a node if its bound closes it, else queue it."""
        if self.rule.closes(node.bound):
            self.close(node)
        else:
            self.push(node)

    def close(self, node: TreeNode) -> None:
        """Finish a node whose bound closes it."""
        self.finish_up_to(node.bound)
        self._closed.append(node)
        self.fresh.append(node)

    def finish_up_to(self, bound: float) -> None:
        """Let the bound of what is closed be at least this one."""
        self._finished = max(self._finished, bound)

    def replace(self, node: TreeNode, other: TreeNode) -> None:
        """Let another node be closed in the place of one, with its bound."""
        self._closed.append(other)
        node.is_dropped = True

    def settle(self, node: TreeNode) -> None:
        """Finish a node of a single plan, whose bound is as low as the known outcomes make it."""
        self._settled.append((node, len(self.rule.plans.pool)))

    def reopen(self) -> bool:
        """Queue nodes that were closed against a better level than there is now; whether there are any.

        Also single plans above that level, if outcomes were found since: one of them may be their worst.
        """
        again = [node for node in self._closed if not self.rule.closes(node.bound)]
        if again:
            self._closed = [node for node in self._closed if self.rule.closes(node.bound)]
            self._finished = max((node.bound for node in self._closed), default=-np.inf)
        again = [node for node in again if not node.is_dropped]
        for node in again:
            self.push(node)
            node.open_again()
        self._settled = [(node, known) for node, known in self._settled if not node.is_dropped]
        outdated = [(node, known) for node, known in self._settled if self._is_outdated(node, known)]
        for node, _ in outdated:
            self.push(node)
        if outdated:
            self._settled = [one for one in self._settled if one not in outdated]
        return bool(again or outdated)

    def _is_outdated(self, node: TreeNode, known: int) -> bool:
        return not self.rule.closes(node.bound) and known < len(self.rule.plans.pool)


class Backjumps:
    """Backjumping: nodes that close are followed up the tree; an interrupt leaves bound and proof valid."""

    def __init__(self, frontier: Frontier, cuts: CutStore) -> None:
        self.frontier, self.cuts = frontier, cuts

    def follow(self) -> None:
        """Take back divisions above the leaves that were closed since the last time; no node may be in work."""
        while self.frontier.fresh:
            leaf = self.frontier.fresh.pop()
            if not leaf.is_dropped:
                leaf.relies_on = frozenset(self.cuts.outcomes[list(leaf.leaf.cuts)].tolist())
                self._rise(leaf)

    def _rise(self, node: TreeNode) -> None:
        """Go up from a closed node as far as nodes are closed by that."""
        while (parent := node.parent) is not None and parent.split is not None and node.relies_on is not None:
            split = parent.split
            anyone_wins = split.by_winner and split.subject not in node.relies_on
            if anyone_wins or self._closes_wider(split, parent, node):
                self._replace(parent, split, node)
            else:
                parent.relies_on = _relied_on(split)
            node = parent

    def _closes_wider(self, split: Split, parent: TreeNode, node: TreeNode) -> bool:
        """Try to close a child for all elements of the robot that divides its parent; if it stays closed, it gets them.

        Tried only if its siblings are open, or rely on more than it does.
        """
        needed = node.relies_on or frozenset()
        others = [child.relies_on for _, child in split.parts if child is not node]
        if split.by_winner or not any(relied is None or relied - needed for relied in others):
            return False
        below = []
        for one in nodes_below(node):
            below.append(one)
            if len(below) > self.cuts.task.params.division.widened or (
                one.split is not None and one.split.divides(split.subject)
            ):
                return False
        wide = {one: with_choice(one.choices, split.subject, parent.choices[split.subject]) for one in below}
        leaves = [one for one in below if one.split is None]
        bounds = []
        for one in leaves:
            bounds.append(self.cuts.leaf_bound(one.leaf, wide[one])[0])
            if not self.frontier.rule.closes(bounds[-1]):
                return False
        self.frontier.finish_up_to(max(bounds))  # before the proof has them
        for one, bound in zip(leaves, bounds, strict=True):
            one.bound = bound
        for one in below:
            one.choices = wide[one]
        return True

    def _replace(self, parent: TreeNode, split: Split, node: TreeNode) -> None:
        """Put a child's proof in the place of its parent's."""
        parent.relies_on, parent.leaf = node.relies_on, node.leaf
        if node.split is None:
            parent.bound = node.bound
        parent.split = node.split  # from here on the tree is the smaller one
        if node.split is None:
            self.frontier.replace(node, parent)
        for _, child in () if node.split is None else node.split.parts:
            child.parent = parent
        for one in nodes_below(parent) if split.by_winner else ():
            if one is not parent:
                one.winners.pop(split.subject, None)
        for _, child in split.parts:
            for one in nodes_below(child) if child is not node else (node,):
                one.is_dropped = True


def _relied_on(split: Split) -> frozenset[int] | None:
    """The outcomes that the proof of a divided node relies on; ``None`` if something below is open."""
    needed: frozenset[int] = frozenset()
    for _, child in split.parts:
        if child.relies_on is None:
            return None
        needed |= child.relies_on
    return needed - {split.subject} if split.by_winner else needed
