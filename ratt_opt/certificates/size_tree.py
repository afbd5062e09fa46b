"""Proofs that every set of so many robots of a plan is worth a threshold: a tree over its robots."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.certificates.plan_sets import NotClosedError

if TYPE_CHECKING:
    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["SizeTree"]


class SizeTree:
    """Include or exclude robots until the included are worth the threshold or too many are out."""

    def __init__(self, sets: PlanSets, size: int, max_nodes: int) -> None:
        self.sets, self.size, self.max_nodes = sets, size, max_nodes

    def run(self) -> list[int]:
        """Return the tree, or raise ``NotClosedError``."""
        order = self.sets.order()[::-1]
        own = self.sets.objective.information[self.sets.elements[order]]
        tree: list[int] = []
        stack = [(self.sets.start(), 0, 0)]
        while stack:
            posterior, depth, out = stack.pop()
            if out > len(order) - self.size:
                tree.append(-2)
            elif self.sets.enough(posterior):
                tree.append(-1)
            elif (missing := self.size - depth + out) == 0 or len(tree) > self.max_nodes:
                raise NotClosedError
            elif self.sets.completions_enough(posterior + missing * own[depth:], missing):
                tree.append(-3)
            else:
                tree.append(order[depth])
                stack.append((posterior, depth + 1, out + 1))
                stack.append((self.sets.extend(posterior, order[depth]), depth + 1, out))
        return tree
