"""The proof from the record of a dive, written when it is needed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.covers.tables import BY_COVER, BY_SUM, TRIED
from ratt_opt.solvers.maxmin.proof import CoverLeaf, ElementBranch, UpperProof

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.covers.cover import Cover
    from ratt_opt.solvers.maxmin.levels.elements import Elements

__all__ = ["DiveProof"]


class DiveProof:
    """A record with the covers and sums that it names, over the elements of the search.

    ``nodes`` : (R, 5), the last is the root; ``left_out`` : of each cover in use, masks (N,); ``terms`` : (R', E)
    """

    def __init__(
        self,
        elements: Elements,
        nodes: IntArray,
        *,
        covers: dict[int, Cover],
        left_out: dict[int, list[int]],
        sums: list[CoverLeaf],
        terms: FloatArray,
    ) -> None:
        self._elements, self._nodes, self._sums, self._terms = elements, nodes, sums, terms
        self._covers, self._left_out = covers, left_out
        self._branches: dict[tuple[int, int, int], ElementBranch] = {}
        self._leaves: dict[int, CoverLeaf] = {}

    def written(self) -> UpperProof:
        """The tree in preorder, with the covers that it uses."""
        choices = self._elements.problem.choices
        stack = [(len(self._nodes) - 1, [(1 << len(choice)) - 1 for choice in choices])]
        tree: list[CoverLeaf | ElementBranch] = []
        while stack:
            number, allowed = stack.pop()
            kind, subject, robot, place, following = self._nodes[number if number >= 0 else -1 - number].tolist()
            if robot < 0 or number < 0:  # what ends a frame, or what a step forbids
                tree.append(self._leaf(kind, subject))
                continue
            gone = allowed[robot] & self._gone(kind, subject, robot, place)
            rest = allowed[robot] & ~gone
            below = {mask: [*allowed[:robot], mask, *allowed[robot + 1 :]] for mask in (gone, rest) if mask}
            if len(below) == 2:
                below = dict(sorted(below.items(), key=lambda item: item[0].bit_count()))
                tree.append(self._branch(robot, *below))
            for mask, own in reversed(below.items()):
                stack.append((following if mask == rest else subject if kind == TRIED else -1 - number, own))
        return self._numbered(tree)

    def _gone(self, kind: int, subject: int, robot: int, place: int) -> int:
        """The mask of a robot's elements that one step forbids, whatever was forbidden before."""
        if kind == TRIED:
            return 1 << place
        if kind == BY_COVER:
            return ~self._left_out[subject][robot]
        terms = self._terms[subject][self._elements.problem.choices[robot]]
        return sum(1 << p for p in np.flatnonzero(terms <= terms[place]).tolist())

    def _leaf(self, kind: int, subject: int) -> CoverLeaf:
        if kind == BY_SUM:
            return self._sums[subject]
        if subject not in self._leaves:
            self._leaves[subject] = CoverLeaf(covers=(subject,), weights=(1.0,))
        return self._leaves[subject]

    def _branch(self, robot: int, first: int, second: int) -> ElementBranch:
        key = robot, first, second
        if key not in self._branches:
            choice = self._elements.problem.choices[robot]
            parts = tuple(
                self._elements.members(choice[[p for p in range(len(choice)) if mask >> p & 1]])
                for mask in (first, second)
            )
            self._branches[key] = ElementBranch(robot=robot, parts=parts)
        return self._branches[key]

    def _numbered(self, tree: list[CoverLeaf | ElementBranch]) -> UpperProof:
        """The proof, its covers numbered anew."""
        used = sorted({k for node in tree if isinstance(node, CoverLeaf) for k in node.covers})
        number = {k: n for n, k in enumerate(used)}
        leaves: dict[CoverLeaf, CoverLeaf] = {}
        for node in tree:
            if isinstance(node, CoverLeaf) and node not in leaves:
                leaves[node] = CoverLeaf(covers=tuple(number[k] for k in node.covers), weights=node.weights)
        nodes = tuple(leaves[node] if isinstance(node, CoverLeaf) else node for node in tree)
        return UpperProof(attacks=(), cuts=(), tree=nodes, covers=tuple(self._covers[k] for k in used))
