"""The search tree while it grows, and its proof when it stops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.proof import ElementBranch, Leaf, WinnerBranch

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.proof import Node

__all__ = ["Classes", "TreeNode", "divide", "equal_elements", "freeze", "representatives", "used_cuts", "with_choice"]

Classes = list[dict[int, list[int]]]
"""Per robot, lowest element -> all elements with the same information: one of each is searched."""


@dataclass(slots=True, eq=False)
class TreeNode:
    """A node of the search.

    ``choices`` : remaining elements per robot (one of each class of equal elements); ``winners`` : outcome ->
    declared group; ``bound`` : proved for its plans by ``leaf``; ``split`` : what it was divided by, once it was.
    """

    choices: tuple[IntArray, ...]
    winners: dict[int, int]
    bound: float
    leaf: Leaf
    split: tuple[str, int, list[tuple[tuple[int, ...], TreeNode]]] | None = None
    depth: int = 0

    def child(self, choices: tuple[IntArray, ...] | None = None, winner: tuple[int, int] | None = None) -> TreeNode:
        """A node below this one, proved so far by the same leaf."""
        return TreeNode(
            choices=self.choices if choices is None else choices,
            winners=self.winners if winner is None else {**self.winners, winner[0]: winner[1]},
            bound=self.bound,
            leaf=self.leaf,
            depth=self.depth + 1,
        )


def equal_elements(problem: Problem, objective: InformationObjective) -> Classes:
    """Group each robot's elements by equal information."""
    classes = []
    for choice in problem.choices:
        seen: dict[bytes, int] = {}
        own: dict[int, list[int]] = {}
        for e in choice.tolist():
            first = seen.setdefault(objective.information[e].tobytes(), e)
            own.setdefault(first, []).append(e)
        classes.append(own)
    return classes


def representatives(classes: Classes) -> tuple[IntArray, ...]:
    """The first element of each class of each robot: all that a search has to choose from."""
    return tuple(np.array(sorted(own), dtype=np.int64) for own in classes)


def with_choice(choices: tuple[IntArray, ...], robot: int, elements: IntArray) -> tuple[IntArray, ...]:
    """``choices`` with those of one robot replaced."""
    return (*choices[:robot], elements, *choices[robot + 1 :])


def divide(node: TreeNode, robot: int, children: list[TreeNode], classes: Classes) -> None:
    """Record that a node is divided by one robot's elements."""
    parts = []
    for child in children:
        members = sorted(e for r in child.choices[robot].tolist() for e in classes[robot][r])
        parts.append((tuple(members), child))
    node.split = ("element", robot, parts)


def used_cuts(root: TreeNode) -> set[int]:
    """Cuts that some leaf below ``root`` weighs."""
    found: set[int] = set()
    stack = [root]
    while stack:
        node = stack.pop()
        if node.split is None:
            found.update(node.leaf.cuts)
        else:
            stack.extend(child for _, child in node.split[2])
    return found


def freeze(root: TreeNode) -> Node:
    """Return the proof below ``root``; iterative, as chains of eliminations may be long."""
    order, stack = [], [root]
    while stack:
        node = stack.pop()
        order.append(node)
        if node.split is not None:
            stack.extend(child for _, child in node.split[2])
    done: dict[int, Node] = {}
    for node in reversed(order):
        if node.split is None:
            done[id(node)] = node.leaf
            continue
        kind, subject, parts = node.split
        children = tuple((members, done[id(child)]) for members, child in parts)
        if kind == "element":
            done[id(node)] = ElementBranch(robot=subject, children=children)
        else:
            done[id(node)] = WinnerBranch(attack=subject, children=children)
    return done[id(root)]
