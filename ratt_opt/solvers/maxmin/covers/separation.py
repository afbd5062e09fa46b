"""Covers that a relaxed plan violates, or that an attack on a plan shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.problem import Attack
from ratt_opt.setfunctions.information import from_triangles
from ratt_opt.solvers.maxmin.covers.choices import Choices
from ratt_opt.solvers.maxmin.covers.cover import Cover
from ratt_opt.solvers.maxmin.covers.partitions import Partitions
from ratt_opt.solvers.maxmin.covers.pool import CoverPool
from ratt_opt.solvers.maxmin.covers.tables import Ways

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.levels.elements import Elements

__all__ = ["Separation"]

GROWN, ADDED = 16, 8
"""Partitions of lowest price whose kept elements are completed in a round, and covers that a round adds at most."""
NOISE = 0.2
"""Relative noise on the order in which targets are lost, so that rounds on the same relaxed plan differ."""
NEGLIGIBLE = 1e-6
"""Violations that count as none."""


class Separation:
    """Finds covers of one problem for any level, and puts them into its ``pool``."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.choices = problem, Choices.of(problem)
        self.partitions, self.pool = Partitions(problem), CoverPool(self.choices)
        self._rng = np.random.default_rng(0)
        self.enough = self.choices.enough
        self.count = self.choices.count[self.choices.owner]
        """(E,) what an element counts in a cover that leaves it out; ``enough`` have to be counted."""
        self._inside = np.zeros((0, problem.objective.n), dtype=np.bool_)
        self._values = np.zeros((0, self.choices.elements.targets))
        self._order = np.zeros(0, dtype=np.int64)

    def ways(self) -> Ways:
        """Ways to cut links as the loops of a dive read them; their order is kept from one to the next."""
        of = self.partitions.of
        if len(self._order) < len(of):
            self._update()
            self._order = np.concatenate([np.arange(len(self._order), len(of)), self._order])
            padded = np.full((len(of), max(map(len, of))), -1, dtype=np.int64)
            for row, own in zip(padded, of, strict=True):
                row[: len(own)] = own
            self._ways = Ways(self.choices, self.partitions.members(), self._inside, padded, self._order)
        return self._ways

    def _update(self) -> None:
        """Value the groups that are new."""
        known = len(self._inside)
        if known == len(self.partitions.groups):
            return
        members = self.partitions.members()[known:]
        self._inside = np.concatenate([self._inside, np.take(members, self.choices.owner, axis=1)])
        self._values = np.concatenate([self._values, self.choices.group_values(members)])

    def violated(self, x: FloatArray, level: float, most: float) -> list[int]:
        """Covers for a level of which a relaxed plan ``x`` (E,) counts less than ``most``, the worst first."""
        self._update()
        price = x * self.count
        noise = self._rng.uniform(1 - NOISE, 1 + NOISE, self._values.shape)
        paid, kept = self.choices.lose(self._inside, price, self._values, level, noise)
        totals = np.array([paid[own].sum() for own in self.partitions.of])
        completed: dict[int, FloatArray] = {}
        found = []
        for p in np.argsort(totals, kind="stable")[:GROWN].tolist():
            if totals[p] == np.inf:
                break
            own = self.partitions.of[p].tolist()
            for g in own:
                if g not in completed:
                    paid[g], completed[g] = self.choices.keep(self._inside[g], price, level, kept[g])
            if (counted := float(paid[own].sum())) < most - NEGLIGIBLE:
                found.append((counted, p))
        found.sort()
        return [self._cover(p, kept, completed, level) for _, p in found[:ADDED]]

    def from_attack(self, plan: IntArray, attack: Attack, level: float) -> int:
        """The number of a cover for a level, by an attack that leaves a plan no more: it keeps what the attack leaves.

        ``plan`` : (N,) elements of this problem
        """
        p = self.partitions.add_cut(attack.links)
        self._update()
        kept = np.zeros_like(self._inside)
        chosen = np.zeros(self.choices.elements.count, dtype=np.bool_)
        chosen[[e for i, e in enumerate(plan.tolist()) if i not in attack.sensing]] = True
        price = self._rng.uniform(0.5, 1.0, len(chosen))
        completed = {}
        for g in self.partitions.of[p].tolist():
            kept[g] = chosen & self._inside[g]
            completed[g] = self.choices.keep(self._inside[g], price, level, kept[g])[1]
        return self._cover(p, kept, completed, level)

    def _cover(self, partition: int, kept: BoolArray, sums: dict[int, FloatArray], level: float) -> int:
        own = self.partitions.of[partition].tolist()
        left_out = ~kept[own].any(axis=0)
        return self.pool.add(partition, left_out, [sums[g] for g in own], level)

    def stated(self, cover: int, elements: Elements) -> Cover:
        """The cover over the elements of the whole problem; ``elements`` : what each element here stands for."""
        partition = int(self.pool.covers.partition[cover])
        own = self.partitions.of[partition].tolist()
        places = sorted(range(len(own)), key=lambda place: self.partitions.groups[own[place]])
        return Cover(
            attack=Attack(frozenset(), self.partitions.cut(partition)),
            left_out=elements.members(np.flatnonzero(self.pool.left_out(cover))),
            points=tuple(from_triangles(self.pool.covers.sums[cover, place]) for place in places),
        )
