"""Proofs that come back are hung below the nodes they are about, every bound derived from the problem's matrices anew.

So nothing a worker says is believed, and a proof may come back at any state: leaves that close are closed, others are
open nodes of this search. A winner that was decided for all plans meanwhile is declared above the whole tree: of a
branch on the same attack then only the winner's part is kept.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.proof import CoverLeaf, ElementBranch, Leaf, MarginalLeaf, Split, TreeNode
from ratt_opt.solvers.maxmin.task import with_choice

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.proof import UpperProof, WinnerBranch
    from ratt_opt.solvers.maxmin.search import BranchAndBound

__all__ = ["hang_below"]


def hang_below(search: BranchAndBound, node: TreeNode, proof: UpperProof) -> None:
    """Continue the tree of ``search`` below ``node`` by a proof; its open leaves are queued, the others closed."""
    outcomes = [search.pool.add(attack) for attack in proof.attacks]
    group = {members: g for g, members in enumerate(search.pool.groups)}
    cuts = [search.cuts.copied(outcomes[c.attack], group[c.group], c.point, c.target) for c in proof.cuts]
    places: list[TreeNode | None] = [node]
    for given in proof.tree:
        place = places.pop()
        assert not isinstance(given, CoverLeaf | MarginalLeaf)  # workers search by cuts
        if isinstance(given, Leaf):
            if place is not None:
                _end(search, place, Leaf(cuts=tuple(cuts[k] for k in given.cuts), weights=given.weights))
        elif place is None:  # below a winner that is none
            places += [None] * len(given.parts)
        elif isinstance(given, ElementBranch):
            places += reversed(_elements(search, place, given))
        else:
            places += reversed(_winners(search, place, outcomes[given.attack], given))


def _end(search: BranchAndBound, node: TreeNode, leaf: Leaf) -> None:
    if leaf.cuts:
        node.tighten(leaf, search.cuts.leaf_bound(leaf, node.choices)[0])
    search.frontier.finish(node)


def _elements(search: BranchAndBound, node: TreeNode, given: ElementBranch) -> list[TreeNode | None]:
    """The children by one robot's elements; of elements that the node has not, none.

    A search knows one of each class of equal elements, and a proof that a group is weak may be about more than a node.
    """
    own = node.choices[given.robot]
    parts = [np.intersect1d(own, part) for part in given.parts]
    if any(len(part) == len(own) for part in parts):
        return [node if len(part) else None for part in parts]
    children = [node.child(with_choice(node.choices, given.robot, part)) if len(part) else None for part in parts]
    node.divide(given.robot, [child for child in children if child is not None], search.task)
    return children


def _winners(search: BranchAndBound, node: TreeNode, outcome: int, given: WinnerBranch) -> list[TreeNode | None]:
    """The children by the group that wins; if that is known already, the node itself in the winner's place."""
    groups = {search.pool.groups[g]: g for g in search.pool.of_outcome[outcome]}
    winner = search.winners.of(node, outcome)
    if winner is not None:
        return [node if groups[part] == winner else None for part in given.parts]
    children = [node.child(winner=(outcome, groups[part])) for part in given.parts]
    node.split = Split(by_winner=True, subject=outcome, parts=tuple(zip(given.parts, children, strict=True)))
    return list(children)
