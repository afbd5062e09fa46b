"""Outcomes of small groups, whose values under all their robots' elements can be listed.

Many cut links leave pairs and threes. What a group of so few robots can reach within a node's choices is the largest
value of a table; there a plan above a level has to satisfy one condition for each outcome: *one of its groups is above
the level*. Conditions narrow a node without any linear program (arc consistency; Mackworth 1977):

- If only one group of an outcome can still be above the level, it is the winner; if none can, it
  closes the node.
- An element with which the declared winner of an outcome cannot be above the level is left out.

Every step enters the search tree as a division closed by tangent cuts.
"""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.elements import with_choice

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.division import WinnerDivision
    from ratt_opt.solvers.maxmin.elements import Choices, Task
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.proof import TreeNode

__all__ = ["SmallGroups", "SmallTables"]


class _Domains:
    """The choices of a node, with a number for each robot's: equal numbers are equal choices.

    ``shown`` : (G,) what each group is worth with its robots' individually best elements.
    """

    def __init__(self, task: Task, pool: OutcomePool, choices: Choices, numbers: dict[bytes, int]) -> None:
        self.choices = choices
        self.sizes = [len(choice) for choice in choices]
        self.numbers = [numbers.setdefault(choice.tobytes(), len(numbers)) for choice in choices]
        best = [choice[task.singles[choice].argmax()] for choice in choices]
        self.shown: list[float] = pool.group_values(task.objective.information[best]).tolist()


class _Group:
    """Largest values of one group within the choices of a node."""

    def __init__(self, task: Task, members: tuple[int, ...]) -> None:
        self.task, self.members, self._params = task, members, task.params.small_groups
        self._is_small = 0 < len(members) <= self._params.largest
        self._cost = task.objective.n_targets * (1 if task.objective.dimension == 2 else self._params.not_planar)
        self._is_whole = (
            self._is_small and self._cost * prod(len(task.choices[i]) for i in members) <= self._params.whole
        )
        self._whole: FloatArray | None = None
        self._known: dict[tuple[int, ...], tuple[float, tuple[FloatArray, ...]]] = {}

    def reach(self, domains: _Domains) -> tuple[float, tuple[FloatArray, ...]] | None:
        """The largest value, and per robot that with each of its elements; ``None`` if that is not listed."""
        if not self._is_small:
            return None
        if not self._is_whole and self._cost * prod(domains.sizes[i] for i in self.members) > self._params.part:
            return None
        key = tuple(domains.numbers[i] for i in self.members)
        known = self._known.get(key)
        if known is None:
            values, axes = self._part(domains.choices), range(len(self.members))
            by_robot = tuple(values.max(axis=tuple(other for other in axes if other != axis)) for axis in axes)
            known = self._known[key] = float(by_robot[0].max()), by_robot
        return known

    def most(self, domains: _Domains) -> float:
        """The largest value; infinite if that is not listed."""
        reach = self.reach(domains)
        return np.inf if reach is None else reach[0]

    def _part(self, choices: Choices) -> FloatArray:
        if not self._is_whole:
            return self._values(choices)
        if self._whole is None:
            self._whole = self._values(self.task.choices)
        pairs = [(self.task.choices[i], choices[i]) for i in self.members]
        return self._whole[np.ix_(*(np.searchsorted(own, left) for own, left in pairs))]

    def _values(self, choices: Choices) -> FloatArray:
        """One axis a robot, over its elements."""
        objective = self.task.objective
        points = objective.prior_information
        for i in self.members:
            points = points[..., None, :, :, :] + objective.information[choices[i]]
        return objective.value(points)


class SmallTables:
    """Largest values of the pool's groups, by group; numbers of choices, by what they are."""

    def __init__(self, task: Task, pool: OutcomePool) -> None:
        self.task, self.pool = task, pool
        self.groups: list[_Group] = []
        self.numbers: dict[bytes, int] = {}

    def grow(self) -> None:
        """Make room for groups that are new in the pool."""
        self.groups += [_Group(self.task, members) for members in self.pool.groups[len(self.groups) :]]


class SmallGroups:
    """Domain reduction of nodes by the pool's outcomes whose groups can be listed, within the budget."""

    def __init__(self, tables: SmallTables, division: WinnerDivision, budget: Budget) -> None:
        self.task, self.pool, self.division, self.budget = tables.task, tables.pool, division, budget
        self._tables, self._groups = tables, tables.groups
        self._above: dict[int, list[int]] = {}
        """The two groups of an outcome that could be above the level when it was last looked at, to be looked at first.
        """

    def narrow(self, node: TreeNode, better: float) -> TreeNode | None:
        """Narrow a node to plans above the level ``better``; ``None`` if it is divided, or closed.

        The node itself if all outcomes of a small team are known: linear programs over them are faster.
        """
        if self.pool.complete:
            return node
        self._tables.grow()
        level, before = better - 1e-11 * abs(better), None  # values closer to it may not be proved to be below
        while node is not before:
            before, domains = node, self._domains(node)
            for outcome in range(len(self.pool)):
                if self.budget.is_over:
                    return node
                after = self._narrow_by(node, outcome, level, domains)
                if after is None:
                    return None
                if after is not node:
                    node, domains = after, self._domains(after)
        return node

    def _domains(self, node: TreeNode) -> _Domains:
        return _Domains(self.task, self.pool, node.choices, self._tables.numbers)

    def _narrow_by(self, node: TreeNode, outcome: int, level: float, domains: _Domains) -> TreeNode | None:
        winner = self.division.winners.of(node, outcome)
        if winner is None:
            above = self._two_above(outcome, level, domains)
            if len(above) > 1:
                return node
            children = self.division.divide(node, outcome)
            if len(children) != 1 or not above or children[0].winners[outcome] != above[0]:
                for child in children:  # of groups that were not proved to be below the level
                    self.division.frontier.push(child)
                return None
            node, winner = children[0], above[0]
        return self._filter(node, (outcome, winner), level, domains)

    def _two_above(self, outcome: int, level: float, domains: _Domains) -> list[int]:
        """Groups of an outcome that can be above the level, at most two."""
        above: list[int] = []
        for g in dict.fromkeys([*self._above.get(outcome, ()), *self.pool.of_outcome[outcome]]):
            if domains.shown[g] > level or self._groups[g].most(domains) > level:
                above.append(g)
            if len(above) > 1:
                self._above[outcome] = above
                break
        return above

    def _filter(self, node: TreeNode, won: tuple[int, int], level: float, domains: _Domains) -> TreeNode | None:
        """Split off the elements with which the winner of an outcome is below the level."""
        outcome, group = won[0], self._groups[won[1]]
        reach = group.reach(domains)
        for robot, most in zip(group.members, reach[1], strict=True) if reach is not None else ():
            choice, left = node.choices[robot], most > level
            if left.all():
                continue
            if not left.any():
                return None if self.division.close(node, outcome) else node
            weak = node.child(with_choice(node.choices, robot, choice[~left]))
            if self.division.close(weak, outcome):
                rest = node.child(with_choice(node.choices, robot, choice[left]))
                node.divide(robot, [weak, rest], self.task)
                node = rest
        return node
