"""Stages: branch and bound over all attacks on any non-decreasing function, by its values alone.

Robots are placed one after the other, each in a group and blinded or not. Placed robots cut the links between their
groups: nodes beyond a budget are left out. A robot that is placed later makes no group worth less, so the best group of
the robots placed bounds every completion from below, and so does the strongest robot that can no longer be blinded. The
node of the least bound is divided first: its bound is one on all attacks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import AttackNodes, Stage, go_on
from ratt_opt.budget import Stop
from ratt_opt.search.open_nodes import OpenNodes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import FloatArray
    from ratt_opt.attack.task import AttackTask


__all__ = ["AttackTree", "BranchAndBoundLaterStage", "BranchAndBoundOfOwnCriterionStage", "BranchAndBoundStage"]


class BranchAndBoundStage(Stage[AttackState]):
    """Stage that divides the attacks on any set function."""

    name = "branch and bound"

    def applies(self, attack: AttackState) -> bool:
        """A limit, or no other search asks."""
        return attack.is_limited or not attack.is_inner

    def run(self, attack: AttackState) -> Stop:
        """Branch and bound over all attacks."""
        attack.task.budget.check()
        return go_on(attack.task, AttackTree(attack.task))


class BranchAndBoundLaterStage(BranchAndBoundStage):
    """Stage that leaves the branch and bound to a call that asks again."""

    def applies(self, attack: AttackState) -> bool:
        """A limit, another search asks."""
        return attack.is_limited and attack.is_inner

    def run(self, attack: AttackState) -> Stop:
        """Keep a branch and bound in the memory; the next call continues it."""
        attack.task.budget.check()
        attack.task.memory.search = AttackTree(attack.task)
        return attack.task.budget.stop() or Stop.HEURISTIC


class BranchAndBoundOfOwnCriterionStage(BranchAndBoundStage):
    """Stage for a criterion without compiled code."""

    def applies(self, attack: AttackState) -> bool:
        """Criterion of one's own; a limit of time, or no other search asks."""
        return not attack.has_prices and (attack.has_time_limit or not attack.is_inner)


class _AttackNode(NamedTuple):
    """Some robots placed; of nodes of one bound those that placed most go first."""

    bound: float
    left: int
    number: int
    group: tuple[int, ...]
    """Group of each robot placed, numbered in the order of their first robots."""
    blind: tuple[bool, ...]


class AttackTree(AttackNodes[_AttackNode, _AttackNode]):
    """Branch and bound over attacks: the group of one robot after the other."""

    def __init__(self, task: AttackTask) -> None:
        self.task = task
        problem, threat = task.problem, task.problem.threat
        self._single = task.values.singletons()
        self._order = _order(self._single, problem.communication.links)
        at = {robot: k for k, robot in enumerate(self._order)}
        self._near: list[list[int]] = [[] for _ in self._order]
        self._held: list[set[int]] = [set() for _ in self._order]
        for i, j in problem.communication.links:
            first, last = sorted((at[i], at[j]))
            self._near[last].append(first)
            if (i, j) in problem.protected_links:
                self._held[last].add(first)
        self._sees = [robot in problem.protected_robots for robot in self._order]
        self._most_blind, self._most_cut = threat.n_blinded, problem.alpha_c
        self._count = 0
        root = _AttackNode(-np.inf, len(self._order), 0, (), ())
        self.nodes = OpenNodes([root], task.params.branching.most_open)

    def explore(self, node: _AttackNode) -> _AttackNode | None:
        """Offer the attack if all robots are placed; a bound has come with the placement of each."""
        if node.left:
            return node
        self._offer(node)
        return None

    def branch(self, node: _AttackNode) -> Iterator[_AttackNode]:
        """Branch on the group of one more robot, within the budgets."""
        k, groups = len(node.group), max(node.group, default=-1) + 1
        inside = np.bincount([node.group[j] for j in self._near[k]], minlength=groups + 1)
        held = {node.group[j] for j in self._held[k]}
        left = self._most_cut - self._cut(node) - len(self._near[k])
        homes = [g for g in range(groups + 1) if left + inside[g] >= 0 and held <= {g}]
        worth = self._worth(node, homes)
        children = [self._child(node, g, max(node.bound, value), is_blind=False) for g, value in worth]
        if not self._sees[k] and sum(node.blind) < self._most_blind:
            children += [self._child(node, g, node.bound, is_blind=True) for g in homes]
        return (c for c in sorted(children, reverse=True) if c.bound < self.task.bracket.goal)

    def _child(self, node: _AttackNode, group: int, bound: float, *, is_blind: bool) -> _AttackNode:
        self._count += 1
        blind = (*node.blind, is_blind)
        bound = max(bound, self._strongest_left(blind))
        return _AttackNode(bound, node.left - 1, self._count, (*node.group, group), blind)

    def _strongest_left(self, blind: tuple[bool, ...]) -> float:
        """The largest individual value of a robot to be placed, once the strongest that may be are blinded."""
        later = self._order[len(blind) :]
        sees = self._sees[len(blind) :]
        free = sorted((self._single[i] for i, sure in zip(later, sees, strict=True) if not sure), reverse=True)
        sure = [self._single[i] for i, sure in zip(later, sees, strict=True) if sure]
        return float(max([*free[self._most_blind - sum(blind) :][:1], *sure], default=-np.inf))

    def _worth(self, node: _AttackNode, homes: list[int]) -> list[tuple[int, float]]:
        """Groups, and what the robots that see there are worth once the next one sees there too."""
        sets = np.zeros((len(homes), len(self._order)), dtype=np.bool_)
        sets[:, self._order[len(node.group)]] = True
        for robot, group, blind in zip(self._order, node.group, node.blind, strict=False):
            if not blind and group in homes:
                sets[homes.index(group), robot] = True
        return list(zip(homes, self.task.values.evaluate(sets).tolist(), strict=True)) if homes else []

    def _cut(self, node: _AttackNode) -> int:
        """Links between the groups of the robots placed."""
        group = node.group
        return sum(group[j] != group[k] for k in range(len(group)) for j in self._near[k])

    def _offer(self, node: _AttackNode) -> None:
        parts: list[list[int]] = [[] for _ in range(max(node.group) + 1)]
        for robot, group in zip(self._order, node.group, strict=True):
            parts[group].append(robot)
        self.task.offer_split(parts, [i for i, blind in zip(self._order, node.blind, strict=True) if blind])


def _order(single: FloatArray, links: frozenset[tuple[int, int]]) -> list[int]:
    """Robots as they are placed: next to most of those placed before, the strongest of these."""
    near = np.zeros((len(single), len(single)), dtype=np.int64)
    for i, j in links:
        near[i, j] = near[j, i] = 1
    order: list[int] = []
    placed = np.zeros(len(single), dtype=np.int64)
    while len(order) < len(single):
        rest = [i for i in range(len(single)) if i not in order]
        order.append(max(rest, key=lambda i: (placed[i], single[i], -i)))
        placed += near[order[-1]]
    return order
