"""Divisions that a proof does not rely on are taken back (conflict-directed backjumping; Prosser 1993).

A node is divided on the winner of an outcome. If everything below one of its children is closed and no leaf there
uses a cut on that outcome, the child's proof is one for the whole node, for every winner. Its siblings need no search
then. The same holds for elements that were left out: if the leaves below still close with them, leaving them out was
needless, and so was what that relied on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.solvers.maxmin.proof import nodes_below
from ratt_opt.solvers.maxmin.task import with_choice

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.frontier import Frontier
    from ratt_opt.solvers.maxmin.proof import Split, TreeNode
    from ratt_opt.solvers.maxmin.relaxed.cut_store import CutStore

__all__ = ["Backjumps"]

MOST_NODES = 128
"""Nodes of a proof that is tried with elements that were left out: some hundredths of a millisecond each. Not tuned."""


class Backjumps:
    """Follows up the tree what closes; an interrupt on the way leaves bound and proof valid."""

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
        """Whether a closed child stays so with all elements of the robot that divides its parent; then it has them.

        Tried only if its siblings are open, or rely on more than it does.
        """
        needed = node.relies_on or frozenset()
        others = [child.relies_on for _, child in split.parts if child is not node]
        if split.by_winner or not any(relied is None or relied - needed for relied in others):
            return False
        below = []
        for one in nodes_below(node):
            below.append(one)
            if len(below) > MOST_NODES or (one.split is not None and one.split.divides(split.subject)):
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
