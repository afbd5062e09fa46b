"""The search tree while it grows, and its proof when it stops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.solvers.maxmin.proof import ElementBranch, Leaf, WinnerBranch

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.solvers.maxmin.proof import Node
    from ratt_opt.solvers.maxmin.task import Choices, Task

__all__ = ["Split", "TreeNode", "nodes_below", "preorder"]


@dataclass(frozen=True, slots=True)
class Split:
    """What a node was divided by: a robot's elements, or the winner of an outcome.

    ``parts`` : (elements or robots of the winning group, node below)
    """

    by_winner: bool
    subject: int
    parts: tuple[tuple[tuple[int, ...], TreeNode], ...]


@dataclass(slots=True, eq=False)
class TreeNode:
    """A node of the search.

    ``choices`` : remaining elements per robot (one of each class of equal elements); ``winners`` : outcome ->
    declared group; ``bound`` : proved for its plans by ``leaf``; ``split`` : what it was divided by, once it was.
    """

    choices: Choices
    winners: dict[int, int]
    bound: float
    leaf: Leaf
    split: Split | None = None

    def child(self, choices: Choices | None = None, winner: tuple[int, int] | None = None) -> TreeNode:
        """A node below this one, proved so far by the same leaf."""
        return TreeNode(
            choices=self.choices if choices is None else choices,
            winners=self.winners if winner is None else {**self.winners, winner[0]: winner[1]},
            bound=self.bound,
            leaf=self.leaf,
        )

    def tighten(self, leaf: Leaf, bound: float) -> None:
        """Keep a leaf that bounds the node by less than its own does."""
        if bound < self.bound:
            self.bound, self.leaf = bound, leaf

    def divide(self, robot: int, children: list[TreeNode], task: Task) -> None:
        """Record that the node is divided by one robot's elements."""
        parts = tuple((task.members(robot, child.choices[robot]), child) for child in children)
        self.split = Split(by_winner=False, subject=robot, parts=parts)


def nodes_below(root: TreeNode) -> Iterator[TreeNode]:
    """The nodes in preorder, children by what they stand for; iterative, as chains of eliminations may be long."""
    stack = [root]
    while stack:
        node = stack.pop()
        yield node
        if node.split is not None:
            stack.extend(child for _, child in sorted(node.split.parts, key=lambda part: part[0], reverse=True))


def preorder(root: TreeNode) -> tuple[Node, ...]:
    """The proof below ``root``."""
    return tuple(_proof_node(node) for node in nodes_below(root))


def _proof_node(node: TreeNode) -> Node:
    if node.split is None:
        return node.leaf
    parts = tuple(sorted(members for members, _ in node.split.parts))
    if node.split.by_winner:
        return WinnerBranch(attack=node.split.subject, parts=parts)
    return ElementBranch(robot=node.split.subject, parts=parts)
