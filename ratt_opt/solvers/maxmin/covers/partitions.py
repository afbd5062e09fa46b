"""Ways to cut links, and the groups that they leave: all if there are few, else those of known attacks."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.communication import robots_of
from ratt_opt.graph.connected_partitions import finest_partitions
from ratt_opt.graph.outcomes import LARGEST_ENUMERATION

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool

__all__ = ["Partitions"]

Groups = tuple[tuple[int, ...], ...]

MOST_LISTED = 500
"""Partitions that are listed: each is priced in every round."""


class Partitions:
    """Partitions of all robots, blinded or not, that cutting at most ``alpha_c`` links leaves.

    ``groups`` : all different groups; ``of`` : the groups of each partition, by their numbers
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.groups: list[tuple[int, ...]] = []
        self.of: list[IntArray] = []
        self._looked = 0
        self._group: dict[tuple[int, ...], int] = {}
        self._partition: dict[Groups, int] = {}
        self.add(problem.communication.groups())
        threat = problem.threat
        if threat.alpha_c == 0 or threat.links_alike:
            return
        if problem.n_robots <= LARGEST_ENUMERATION:
            for partition in islice(finest_partitions(threat), MOST_LISTED):
                self.add(robots_of(mask) for mask in partition)

    def add_cut(self, links: Iterable[Link]) -> int:
        """Add what is left when links are cut; the partition's number, new or old."""
        return self.add(self.problem.communication.groups(links))

    def add_cuts_of(self, pool: OutcomePool) -> bool:
        """Add what the attacks of a pool leave that were not looked at yet; whether that is new."""
        before = len(self.of)
        while self._looked < len(pool) and len(self.of) < MOST_LISTED:
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
