"""Ways to cut links, and covers: those that a relaxed plan violates, or that an attack on a plan shows."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.communication import robots_of
from ratt_opt.graph.connected_partitions import finest_partitions
from ratt_opt.graph.outcomes import LARGEST_ENUMERATION
from ratt_opt.native.library import address, check_numbers, checked
from ratt_opt.native.loops import WaysRecord
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.information import from_triangles
from ratt_opt.solvers.maxmin.covers.choices import CoverChoices
from ratt_opt.solvers.maxmin.covers.pool import CoverPool
from ratt_opt.solvers.maxmin.elements import padded
from ratt_opt.solvers.maxmin.params import or_default
from ratt_opt.solvers.maxmin.proof import Cover

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.elements import Elements
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.params import MaxMinParams

__all__ = ["Partitions", "Separation", "Ways"]


class Ways:
    """Partitions ``of`` (P, S) of groups, padded by -1, in the ``order`` (P,) in which they are tried; it changes.

    ``members`` : (G, N), ``inside`` : (G, E) which robots and elements are in each group

    Raises
    ------
    InputError : a shape or a type is another, or a number is not that of a group, or of a partition.
    """

    def __init__(
        self, choices: CoverChoices, members: BoolArray, inside: BoolArray, of: IntArray, order: IntArray
    ) -> None:
        groups, partitions = len(members), len(order)
        widest = np.shape(of)[-1] if np.ndim(of) == 2 else 0
        self._arrays = members, inside, of, order  # the record has their addresses only
        checked("members", members, np.bool_, (groups, len(choices.safe)))
        checked("inside", inside, np.bool_, (groups, choices.elements.count))
        checked("of", of, np.int64, (partitions, widest))
        checked("order", order, np.int64, (partitions,), written=True)
        check_numbers("of", of, -1, groups)
        check_numbers("order", order, 0, partitions)
        self.widest = widest
        self.record = WaysRecord(
            groups=groups,
            partitions=partitions,
            widest=widest,
            members=address(members),
            inside=address(inside),
            of=address(of),
            order=address(order),
        )


class Partitions:
    """Partitions of all robots, blinded or not, that cutting at most ``alpha_c`` links leaves.

    ``groups`` : all different groups; ``of`` : the groups of each partition, by their numbers; ``most`` : are listed
    """

    def __init__(self, problem: Problem, most: int) -> None:
        self.problem, self._most = problem, most
        self.groups: list[tuple[int, ...]] = []
        self.of: list[IntArray] = []
        self._looked = 0
        self._group: dict[tuple[int, ...], int] = {}
        self._partition: dict[tuple[tuple[int, ...], ...], int] = {}
        self.add(problem.communication.groups())
        threat = problem.threat
        if threat.alpha_c == 0 or threat.links_alike:
            return
        if problem.n_robots <= LARGEST_ENUMERATION:
            for partition in islice(finest_partitions(threat), most):
                self.add(robots_of(mask) for mask in partition)

    def add_cut(self, links: Iterable[Link]) -> int:
        """Add what is left when links are cut; the partition's number, new or old."""
        return self.add(self.problem.communication.groups(links))

    def add_cuts_of(self, pool: OutcomePool) -> bool:
        """Add what the attacks of a pool leave that were not looked at yet; whether that is new."""
        before = len(self.of)
        while self._looked < len(pool) and len(self.of) < self._most:
            self.add_cut(pool.attack(self._looked).links)
            self._looked += 1
        return len(self.of) > before

    def add(self, partition: Iterable[Iterable[int]]) -> int:
        """Add a partition; its number, new or old."""
        groups = tuple(sorted(tuple(sorted(group)) for group in partition))
        if groups not in self._partition:
            for group in groups:
                if group not in self._group:
                    self._group[group] = len(self.groups)
                    self.groups.append(group)
            self._partition[groups] = len(self.of)
            self.of.append(np.array([self._group[group] for group in groups]))
        return self._partition[groups]

    def cut(self, partition: int) -> frozenset[Link]:
        """The links that are cut."""
        return self.problem.communication.links_between([self.groups[g] for g in self.of[partition].tolist()])

    def members(self) -> BoolArray:
        """(G, N) which robots are in each group."""
        members = np.zeros((len(self.groups), self.problem.n_robots), dtype=np.bool_)
        for row, group in zip(members, self.groups, strict=True):
            row[list(group)] = True
        return members


class Separation:
    """Separation of covers of one problem for any level; they go into its ``pool``."""

    def __init__(self, problem: Problem, params: MaxMinParams | None = None) -> None:
        self.problem, self.choices, self.params = problem, CoverChoices.of(problem), or_default(params)
        self._params = self.params.separation
        self.partitions, self.pool = Partitions(problem, self._params.listed), CoverPool(self.choices, self._params)
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
            self._ways = Ways(self.choices, self.partitions.members(), self._inside, padded(of), self._order)
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
        params = self._params
        noise = self._rng.uniform(1 - params.noise, 1 + params.noise, self._values.shape)
        paid, kept = self.choices.lose(self._inside, price, self._values, level, noise)
        totals = np.array([paid[own].sum() for own in self.partitions.of])
        completed: dict[int, FloatArray] = {}
        found = []
        for p in np.argsort(totals, kind="stable")[: params.grown].tolist():
            if totals[p] == np.inf:
                break
            own = self.partitions.of[p].tolist()
            for g in own:
                if g not in completed:
                    paid[g], completed[g] = self.choices.keep(self._inside[g], price, level, kept[g])
            if (counted := float(paid[own].sum())) < most - params.negligible:
                found.append((counted, p))
        found.sort()
        return [self._cover(p, kept, completed, level) for _, p in found[: params.added]]

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
        partition = int(self.pool.partition[cover])
        own = self.partitions.of[partition].tolist()
        places = sorted(range(len(own)), key=lambda place: self.partitions.groups[own[place]])
        return Cover(
            attack=Attack(frozenset(), self.partitions.cut(partition)),
            left_out=elements.members(np.flatnonzero(self.pool.left_out(cover))),
            points=tuple(from_triangles(self.pool.sums[cover, place]) for place in places),
        )
