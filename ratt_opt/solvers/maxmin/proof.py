"""The proof of an upper bound on the optimum: a search tree, in preorder, whose leaves are checked one by one.

A node stands for the plans whose elements remain allowed on its path and for which the declared
groups win. Children of an :class:`ElementBranch` partition one robot's remaining elements; those of a
:class:`WinnerBranch` say which group of one attack attains the team value, one child a group. At a leaf, a cut
on the only group of an attack, or on the group declared to win, bounds the team value under that attack and so the
worst case; the leaf's convex combination of such cuts bounds every plan that remains. A :class:`CoverLeaf` combines
conditions on plans that are worth more (``covers/pool.py``); no plan that remains meets the combination. A
:class:`MarginalLeaf` adds up what robots can gain under one attack.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from ratt_opt._values import ByValue

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Attack
    from ratt_opt.solvers.maxmin.elements import Choices, Task
    from ratt_opt.solvers.maxmin.value_spacing import ValueSpacing

__all__ = [
    "Cover",
    "CoverLeaf",
    "ElementBranch",
    "Leaf",
    "MarginalLeaf",
    "Node",
    "Split",
    "TangentCut",
    "TargetLemma",
    "TreeNode",
    "UpperProof",
    "WinnerBranch",
    "nodes_below",
    "upper_proof",
]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TargetLemma(ByValue):
    """Claim: ``phi_j(T) <= constant + sum of scores[e] over e in T`` for every plan's set ``T``; ``scores`` (E,)."""

    target: int
    constant: float
    scores: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TangentCut(ByValue):
    """A tangent bound on one group of one attack; of a sum over targets, it may touch elsewhere for each.

    ``point`` : (M, d, d) posterior information where it touches; ``target`` : for max-eigenvalue, which target's.
    ``lemmas`` : inequalities in the place of some targets' tangents; ``by_target`` : whether it is a row, whose
        tangents of single targets many rows share
    """

    attack: int
    group: tuple[int, ...]
    point: FloatArray
    target: int | None = None
    lemmas: tuple[TargetLemma, ...] = ()
    by_target: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Cover(ByValue):
    """Groups that an attack on links leaves, and elements left out; ``covers/pool.py`` derives a condition on plans.

    ``attack`` : on links only; ``left_out`` : elements, ascending; ``points`` : for each group that the attack leaves,
    by lowest robot, the posterior information (M, d, d) where its tangent touches
    """

    attack: Attack
    left_out: tuple[int, ...]
    points: tuple[FloatArray, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Leaf:
    """Cuts by index, and their non-negative weights (normalised by their sum)."""

    cuts: tuple[int, ...]
    weights: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CoverLeaf:
    """Covers by index, and their non-negative weights: no plan of the leaf counts as much as their combination asks.

    So each plan fails one of them, and is worth no more than the largest of their bounds.
    """

    covers: tuple[int, ...]
    weights: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MarginalLeaf:
    """Under one attack no group is worth more, for a submodular function: log-determinants.

    A group is worth at most what its robots of one element left are worth together, and of each other robot the
    largest gain that an element adds to these alone. If one element dominates others, it alone counts.
    """

    attack: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ElementBranch:
    """``parts`` : the elements that remain for ``robot`` in each child, ascending; a partition of what remained."""

    robot: int
    parts: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class WinnerBranch:
    """``parts`` : the group that attains the team value under ``attack`` in each child, ascending; all its groups."""

    attack: int
    parts: tuple[tuple[int, ...], ...]


Node = Leaf | CoverLeaf | MarginalLeaf | ElementBranch | WinnerBranch


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class UpperProof(ByValue):
    """Attacks, cuts and covers that the ``tree`` refers to by index; its nodes are in preorder.

    ``spacing`` : which values plans can have, if the end was lowered to one of these
    """

    attacks: tuple[Attack, ...]
    cuts: tuple[TangentCut, ...]
    tree: tuple[Node, ...]
    covers: tuple[Cover, ...] = ()
    spacing: ValueSpacing | None = None

    def moved(self, to: Callable[[FloatArray], FloatArray]) -> UpperProof:
        """The proof whose tangents touch elsewhere, ``to`` (M, d, d) -> (M, d', d'): in other coordinates."""
        cuts = tuple(replace(cut, point=to(cut.point)) for cut in self.cuts)
        covers = tuple(replace(cover, points=tuple(map(to, cover.points))) for cover in self.covers)
        return replace(self, cuts=cuts, covers=covers)

    def __repr__(self) -> str:
        return f"UpperProof({len(self.attacks)} attacks, {len(self.cuts)} cuts, {len(self.tree)} nodes)"


@dataclass(frozen=True, slots=True)
class Split:
    """Division of a node: by a robot's elements, or by the winner of an outcome.

    ``parts`` : (elements or robots of the winning group, node below)
    """

    by_winner: bool
    subject: int
    parts: tuple[tuple[tuple[int, ...], TreeNode], ...]

    def divides(self, robot: int) -> bool:
        """Tell whether it divides the elements of this robot."""
        return not self.by_winner and self.subject == robot


@dataclass(slots=True, eq=False)
class TreeNode:
    """A node of the search.

    ``choices`` : remaining elements per robot (one of each class of equal elements); ``winners`` : outcome ->
    declared group; ``bound`` : proved for its plans by ``leaf``; ``split`` : what it was divided by, once it was.
    ``relies_on`` : outcomes whose cuts its proof uses, once all below is closed; ``parent`` : the node that was
    divided, if any; ``is_dropped`` : whether it is no longer in the tree (``frontier.py``).
    """

    choices: Choices
    winners: dict[int, int]
    bound: float
    leaf: Leaf
    split: Split | None = None
    parent: TreeNode | None = field(default=None, repr=False)
    relies_on: frozenset[int] | None = None
    is_dropped: bool = False

    def child(self, choices: Choices | None = None, winner: tuple[int, int] | None = None) -> TreeNode:
        """A node below this one, proved so far by the same leaf."""
        winners = self.winners if winner is None else {**self.winners, winner[0]: winner[1]}
        return TreeNode(self.choices if choices is None else choices, winners, self.bound, self.leaf, parent=self)

    def open_again(self) -> None:
        """Note that it is open, and with it what is above."""
        node: TreeNode | None = self
        while node is not None:
            node.relies_on, node = None, node.parent

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


def upper_proof(root: TreeNode, attack_of: Callable[[int], Attack], cut_of: Callable[[int], TangentCut]) -> UpperProof:
    """The proof below ``root``, with the attacks and cuts that it uses, numbered anew."""
    tree = [_proof_node(node) for node in nodes_below(root)]
    used = sorted({k for node in tree if isinstance(node, Leaf) for k in node.cuts})
    cuts = [cut_of(k) for k in used]
    outcomes = sorted({c.attack for c in cuts} | {node.attack for node in tree if isinstance(node, WinnerBranch)})
    cut_number = {k: number for number, k in enumerate(used)}
    attack_number = {outcome: number for number, outcome in enumerate(outcomes)}

    def renumbered(node: Node) -> Node:
        if isinstance(node, Leaf):
            return replace(node, cuts=tuple(cut_number[k] for k in node.cuts))
        return replace(node, attack=attack_number[node.attack]) if isinstance(node, WinnerBranch) else node

    return UpperProof(
        attacks=tuple(attack_of(outcome) for outcome in outcomes),
        cuts=tuple(replace(cut, attack=attack_number[cut.attack]) for cut in cuts),
        tree=tuple(renumbered(node) for node in tree),
    )


def _proof_node(node: TreeNode) -> Node:
    if node.split is None:
        return node.leaf
    parts = tuple(sorted(members for members, _ in node.split.parts))
    if node.split.by_winner:
        return WinnerBranch(attack=node.split.subject, parts=parts)
    return ElementBranch(robot=node.split.subject, parts=parts)
