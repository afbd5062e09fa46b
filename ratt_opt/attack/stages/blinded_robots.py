"""Stage: robots blinded, on functions whose gains diminish: branch and bound by modular minorants.

Take robots in any order, and of each what it adds to those before it. Of a submodular function the sum of these gains
over any set of robots is at most the set's value (Edmonds 1970). A linear program over fractional sets of robots that
sense is bounded by such sums, part by part if the function is a sum: the order by falling shares gives those that are
largest there (the Lovász extension). With multipliers that add up to a part's weight, the gains combine to one for each
robot, and no set of the given size is worth less than the smallest of them. The program only suggests the multipliers.
A node is divided by whether one robot senses.

Applies if no links are cut: an attack then leaves one group. The function says that it is submodular; a set that is
worth less than a minorant refutes it, and an error shows the sets.
"""

from __future__ import annotations

from math import comb
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ratt_opt.attack.plan_parts import parts_of_plan, refuse_larger_gain
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import AttackNodes, Stage, go_on
from ratt_opt.budget import Stop
from ratt_opt.errors import InputError
from ratt_opt.highs import LinearProgram, rows_of
from ratt_opt.problem import Attack
from ratt_opt.search.open_nodes import OpenNodes
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.task import AttackTask


__all__ = ["BlindedRobotsStage", "BlindingTree"]


class BlindedRobotsStage(Stage[AttackState]):
    """Stage that bounds sets of sensing robots by sums of diminishing gains."""

    name = "blinded robots"

    def applies(self, attack: AttackState) -> bool:
        """Submodular, non-decreasing function, one group, over 20,000 sets; a limit, or no other search asks."""
        return (attack.is_limited or not attack.is_inner) and _is_one_submodular_group(attack)

    def run(self, attack: AttackState) -> Stop:
        """Branch and bound over sets of blinded robots, by modular minorants."""
        attack.task.budget.check()
        return go_on(attack.task, BlindingTree(attack.task))


def _is_one_submodular_group(attack: AttackState) -> bool:
    problem = attack.task.problem
    one_group = problem.threat.n_cut == 0 and len(problem.communication.groups()) == 1
    f = unmetered(problem.objective)
    if not (one_group and f.is_submodular and f.is_non_decreasing):  # otherwise blinding fewer robots may be worse
        return False
    free = problem.n_robots - len(problem.threat.protected_robots)
    return comb(free, problem.threat.n_blinded) > attack.task.params.stages.blinded_sets


ROUNDING = 64 * np.finfo(np.float64).eps
"""Relative error by which a quotient may be too large."""


class _Node(NamedTuple):
    """Sets of sensing robots: (N,) at least ``low`` and at most ``high``; of one bound, deeper ones go first."""

    bound: float
    free: int
    number: int
    low: BoolArray
    high: BoolArray


class BlindingTree(AttackNodes[_Node, "tuple[_Node, float, FloatArray]"]):
    """Branch and bound over blinded robots, by rows of a linear program."""

    def __init__(self, task: AttackTask) -> None:
        self.task = task
        problem, n = task.problem, task.problem.n_robots
        self._f, self._plan = unmetered(problem.objective), task.values.plan
        self._spacing = self._f.spacing
        self._size = n - problem.threat.n_blinded
        self._nothing = float(task.values.evaluate(np.zeros((1, n), dtype=np.bool_))[0])
        self._parts = parts_of_plan(task.values, self._f)
        self._weights = np.array([part.weight for part in self._parts])
        self._orders: list[IntArray] = []
        self._part, self._gains = np.zeros(0, dtype=np.int64), np.zeros((0, n))
        count = len(self._parts)
        everyone = rows_of([(list(range(n)), [1.0] * n)], float(self._size), float(self._size))
        lower, upper = np.append(np.zeros(n), np.full(count, -np.inf)), np.append(np.ones(n), np.full(count, np.inf))
        cost = np.append(np.zeros(n), self._weights)
        self._program = LinearProgram(cost, lower, upper, rows=everyone, solver="simplex")
        held = np.isin(np.arange(n), list(problem.protected_robots))
        self._count = 0
        root = _Node(-np.inf, n, 0, held, np.ones(n, dtype=np.bool_))
        self.nodes = OpenNodes([root], task.params.branching.most_open)
        self._add_rows(np.full(n, self._size / n), np.full(count, -np.inf))

    def run(self) -> Stop:
        """Divide nodes; at the end no value lies between the ends of multiples."""
        self.task.bracket.is_submodular = True
        super().run()
        if self._spacing > 0:
            self.task.bracket.raise_lower(self.task.bracket.upper)
        return Stop.CLOSED

    def explore(self, node: _Node) -> tuple[_Node, float, FloatArray] | None:
        """Bound a node; its bound, and a fractional set."""
        bound, share = self._bounded(node)
        return None if bound >= self.task.bracket.goal or share is None else (node, bound, share)

    def branch(self, bounded: tuple[_Node, float, FloatArray]) -> list[_Node]:
        """Branch on the robot whose share is least whole."""
        node, bound, share = bounded
        free = np.flatnonzero(node.low != node.high)
        robot = int(free[np.abs(share[free] - 1 / 2).argmin()])
        children = []
        for senses in (False, True):
            low, high = node.low.copy(), node.high.copy()
            low[robot], high[robot] = senses, senses
            if low.sum() <= self._size <= high.sum():
                self._count += 1
                children.append(_Node(bound, len(free) - 1, self._count, low, high))
        return children

    def _bounded(self, node: _Node) -> tuple[float, FloatArray | None]:
        """A bound on the sets of a node, and a fractional set; none if all sets of the node have been valued."""
        budget, bound = self.task.budget, node.bound
        if node.low.sum() == self._size or node.high.sum() == self._size:
            self._offer(node.low if node.low.sum() == self._size else node.high)
            return bound, None
        self._program.bound_columns(node.low.astype(np.float64), node.high.astype(np.float64))
        while True:
            budget.check()
            found = self._program.solve(budget.seconds_left)
            if not found.is_optimal:
                return bound, np.where(node.low, 1.0, np.where(node.high, 0.5, 0.0))
            share = found.x[: len(node.low)]
            bound = max(bound, self._least(np.abs(found.duals[1:]), node))
            if bound >= self.task.bracket.goal:
                return bound, share
            self._offer(self._rounded(share, node))
            if not self._add_rows(share, found.x[len(node.low) :]):
                return bound, share

    def _least(self, duals: FloatArray, node: _Node) -> float:
        """The least sum of gains, combined by the multipliers, over the sets of a node."""
        gains = self._multipliers(duals) @ self._gains
        free = np.sort(gains[node.low != node.high])[: self._size - int(node.low.sum())]
        size = float(np.abs(gains).sum()) + abs(self._nothing)
        error = 4 * (len(gains) + len(self._parts)) * np.finfo(np.float64).eps * size
        bound = self._nothing + float(gains[node.low].sum() + free.sum()) - error
        spacing = self._spacing
        return spacing * float(np.ceil(bound / spacing * (1 - ROUNDING))) if spacing > 0 else bound

    def _multipliers(self, duals: FloatArray) -> FloatArray:
        """Multipliers of the rows in proportion to some duals; those of each part add up to its weight."""
        total = np.bincount(self._part, duals, len(self._parts))
        first = np.unique(self._part, return_index=True)[1]
        scale = np.divide(self._weights, total, out=np.zeros_like(total), where=total > 0)
        scaled = duals * scale[self._part]
        scaled[first[total <= 0]] = self._weights[total <= 0]
        return np.asarray(scaled)

    def _add_rows(self, share: FloatArray, level: FloatArray) -> bool:
        """Add each part's gains in the order of falling shares, if they exceed its level; whether any do."""
        self.task.budget.evaluate(len(share))
        order: IntArray = np.argsort(-share, kind="stable")
        new: list[FloatArray] = []
        parts: list[int] = []
        tolerance = 1e-9  # of what a part may be worth: rows that exceed a level by less are the solver's rounding
        self._orders.append(order)
        for j, part in enumerate(self._parts):
            gains = part.gains(order)
            if float(gains @ share) > level[j] + tolerance * part.most:
                new.append(gains)
                parts.append(j)
        if new:
            n = len(share)
            self._part, self._gains = np.append(self._part, parts), np.concatenate([self._gains, new])
            own = [np.flatnonzero(gains) for gains in new]
            entries = [
                ([*some.tolist(), n + j], [*(-gains[some]).tolist(), 1.0])
                for some, gains, j in zip(own, new, parts, strict=True)
            ]
            self._program.add_rows(rows_of(entries, 0.0))
        return bool(new)

    def _rounded(self, share: FloatArray, node: _Node) -> BoolArray:
        """(N,) the sensing robots of largest shares."""
        order = np.argsort(-(share + 2.0 * node.low - 2.0 * ~node.high), kind="stable")
        senses: BoolArray = np.zeros(len(share), dtype=np.bool_)
        senses[order[: self._size]] = True
        return senses

    def _offer(self, senses: BoolArray) -> None:
        """Offer the attack that leaves these robots sensing."""
        value = float(self.task.values.evaluate(senses[None])[0])
        least = np.maximum.reduceat((self._gains @ senses)[np.argsort(self._part, kind="stable")], self._starts())
        if value < self._nothing + float(self._weights @ least) - self._f.least_improvement(value, terms=self._terms):
            self._refuse(senses)
        if value < self.task.bracket.upper:
            self.task.offer(Attack(frozenset(np.flatnonzero(~senses).tolist()), frozenset()))

    def _starts(self) -> IntArray:
        return np.searchsorted(np.sort(self._part), np.arange(len(self._parts)))

    @property
    def _terms(self) -> int:
        return 4 * (len(self._parts) + len(self._plan))

    def _refuse(self, senses: BoolArray) -> None:
        """Show where gains do not diminish: a set is worth less than what its robots add to more of them."""
        for order in self._orders:
            inside = list[int]()
            for k, robot in enumerate(order.tolist()):
                if senses[robot]:
                    refuse_larger_gain(self._f, self._plan[order[:k]], self._plan[inside], int(self._plan[robot]))
                    inside.append(robot)
        shown = f"one whose gains do not diminish on {self._plan[senses].tolist()}"
        raise InputError("f", "must be a sum of submodular parts, as it says (is_submodular = True)", shown)
