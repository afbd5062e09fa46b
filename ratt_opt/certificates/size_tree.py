"""Proofs that every set of so many robots of a plan is worth a threshold: a tree over its robots."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.packed_team import PackedTeam
from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.verifier.work import tell

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["size_tree"]

LARGEST_PLAIN = 12
"""Robots up to which a cover is found sooner than compiled code is loaded."""


def size_tree(sets: PlanSets, size: int, max_nodes: int, among: Sequence[int] | None = None) -> list[int]:
    """Return the tree; compiled for larger teams, where the criterion and its targets have compiled loops.

    Parameters
    ----------
    among : the robots of which so many are worth the threshold; all of them where absent

    Raises
    ------
    NotClosedError : a set is worth less, or the tree is too large.
    """
    team = PackedTeam.planar(sets.objective, sets.elements)
    robots = list(range(sets.problem.n_robots) if among is None else among)
    if team is None or len(robots) <= LARGEST_PLAIN or size > len(robots):
        return _SizeTree(sets, size, max_nodes, frozenset(robots)).run()
    from ratt_opt.certificates.forced_size import forced_size_tree  # compiles

    own = np.array(robots, dtype=np.int64)
    part = replace(team, information=team.information[own], single=team.single[own])
    tree = forced_size_tree(part, size, sets.threshold, max_nodes)
    if tree is None:
        raise NotClosedError
    return [robots[node] if node >= 0 else node for node in tree]


class _SizeTree:
    """Include or exclude robots until the included are worth the threshold or too many are out."""

    def __init__(self, sets: PlanSets, size: int, max_nodes: int, robots: frozenset[int]) -> None:
        self.sets, self.size, self.max_nodes, self.robots = sets, size, max_nodes, robots

    def run(self) -> list[int]:
        order = [i for i in self.sets.order()[::-1] if i in self.robots]
        own = self.sets.objective.information[self.sets.elements[order]]
        tree: list[int] = []
        stack = [(self.sets.start(), 0, 0)]
        while stack:
            tell(COVERING, len(tree))
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
