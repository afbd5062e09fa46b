"""Attacks as they bear on links still to be chosen: what each leaves, and how many of which links block it.

An attack is kept as the groups it separates and the robots it blinds. Whatever links are chosen, it stays possible
until ``need`` of the candidates between its groups are. So the fewer groups, the harder it is to block: groups are
joined as long as the joint one is worth no more than what the attack has to show.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack import params as parameters

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.protection.upgrades import Upgrade
    from ratt_opt.attack.task import PlanValues
    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Attack, Problem

__all__ = ["KnownAttack", "KnownAttacks"]

Groups = list[frozenset[int]]


@dataclass(frozen=True, slots=True, order=True)
class KnownAttack:
    """Attack of at most ``value``, unless ``need`` or more of the candidates in the bit mask ``links`` are chosen."""

    value: float
    links: int
    need: int
    groups: tuple[frozenset[int], ...]
    blinded: frozenset[int]

    def withstands(self, chosen: int) -> bool:
        """Tell whether the attack is still possible after these candidates (a bit mask) are chosen."""
        return (self.links & chosen).bit_count() < self.need


class KnownAttacks:
    """All attacks met so far, weakest team first; each is kept once.

    Where the budget is over, groups are no longer joined: what is kept still holds.
    """

    def __init__(self, upgrade: Upgrade, values: PlanValues, budget: Budget) -> None:
        self.upgrade = upgrade
        self.ascending: list[KnownAttack] = []
        self._values, self._budget = values, budget
        self._worth: dict[frozenset[int], float] = {}
        self._candidates = _as_array(upgrade.candidates)
        # Links of the graph count too: only groups with something between them are worth joining.
        others = upgrade.problem.communication.links.difference(upgrade.candidates)
        self._pairs = np.concatenate([self._candidates, _as_array(others)])

    def meet(self, attack: Attack, problem: Problem, goal: float) -> None:
        """Keep an attack on the team of a changed problem, with as few groups as leave ``goal``, or what it leaves."""
        groups = list(problem.communication.groups(attack.links))
        value = max(self._worths(groups, attack.sensing))
        self._keep(self._joined(groups, attack.sensing, max(value, goal)), attack.sensing)

    def adapt(self, chosen: Sequence[Link], below: float) -> bool:
        """Keep what known attacks become where links are chosen that block them, if one leaves at most ``below``.

        Groups between which a chosen link remains are joined, the weakest first. Whether one was kept.
        """
        mask = self.mask(chosen)
        for known in self.ascending:
            if known.value > below:
                break
            if known.withstands(mask):
                continue
            groups = self._withstanding(list(known.groups), known.blinded, chosen, below)
            if groups is not None:
                self._keep(self._joined(groups, known.blinded, below), known.blinded)
                return True
        return False

    def mask(self, links: Iterable[Link]) -> int:
        """Candidates as a bit mask."""
        return sum(1 << bisect_left(self.upgrade.candidates, link) for link in set(links))

    def _withstanding(
        self, groups: Groups, blinded: frozenset[int], chosen: Sequence[Link], below: float
    ) -> Groups | None:
        while len(_between(groups, chosen)) >= self.upgrade.needed(groups):
            joint = {pair: self._joint(groups, pair, blinded) for pair in _between(groups, chosen)}
            pair = min(joint, key=lambda p: (joint[p], p))
            if joint[pair] > below:
                return None
            _join(groups, pair)
        return groups

    def _joined(self, groups: Groups, blinded: frozenset[int], goal: float) -> Groups:
        """The groups, those with most links between them joined first, as long as none is worth more than ``goal``."""
        counts = self._links_between(groups)
        while (pair := self._most_linked(groups, counts, blinded, goal)) is not None:
            _join(groups, pair)
            first, second = pair
            counts[first] += counts[second]
            counts[:, first] = counts[first]
            counts[first, first] = 0
            counts = np.delete(np.delete(counts, second, axis=0), second, axis=1)
        return groups

    def _links_between(self, groups: Groups) -> IntArray:
        """(G, G) candidates and links of the graph between each two groups."""
        home = self._home(groups)[self._pairs]
        counts = np.zeros((len(groups), len(groups)), dtype=np.int64)
        np.add.at(counts, (home[:, 0], home[:, 1]), 1)
        counts += counts.T
        np.fill_diagonal(counts, 0)
        return counts

    def _most_linked(
        self, groups: Groups, counts: IntArray, blinded: frozenset[int], goal: float
    ) -> tuple[int, int] | None:
        """Find the pair of groups with most links between among those worth at most ``goal`` together."""
        first, second = np.nonzero(np.triu(counts))
        order = np.argsort(-counts[first, second], kind="stable")
        at_once = parameters.DEFAULT.protection.at_once
        for start in range(0, len(order), at_once):
            if self._budget.is_over:
                return None
            some = order[start : start + at_once]
            pairs = list(zip(first[some].tolist(), second[some].tolist(), strict=True))
            worths = self._worths([groups[a] | groups[b] for a, b in pairs], blinded)
            for pair, worth in zip(pairs, worths, strict=True):
                if worth <= goal:
                    return pair
        return None

    def _home(self, groups: Groups) -> IntArray:
        """(N,) which group each robot is in."""
        home = np.empty(self.upgrade.problem.n_robots, dtype=np.int64)
        for k, group in enumerate(groups):
            home[list(group)] = k
        return home

    def _keep(self, groups: Groups, blinded: frozenset[int]) -> None:
        home = self._home(groups)[self._candidates]
        separated = np.packbits(home[:, 0] != home[:, 1], bitorder="little")
        links = int.from_bytes(separated.tobytes(), "little")
        value = max(self._worths(groups, blinded))
        known = KnownAttack(value, links, self.upgrade.needed(groups), tuple(groups), blinded)
        if known not in self.ascending:
            self.ascending.append(known)
            self.ascending.sort(key=lambda attack: attack.value)

    def _joint(self, groups: Groups, pair: tuple[int, int], blinded: frozenset[int]) -> float:
        return self._worths([groups[pair[0]] | groups[pair[1]]], blinded)[0]

    def _worths(self, groups: Sequence[frozenset[int]], blinded: frozenset[int]) -> list[float]:
        """Values of the groups' robots that see."""
        left = [group - blinded for group in groups]
        if new := sorted({group for group in left if group not in self._worth}, key=sorted):
            rows = np.zeros((len(new), self._values.n), dtype=np.bool_)
            for row, group in zip(rows, new, strict=True):
                row[list(group)] = True
            self._worth.update(zip(new, self._values.evaluate(rows).tolist(), strict=True))
        return [self._worth[group] for group in left]


def _as_array(links: Iterable[Link]) -> IntArray:
    """(L, 2) their ends."""
    return np.fromiter(chain.from_iterable(links), dtype=np.int64).reshape(-1, 2)


def _between(groups: Groups, links: Iterable[Link]) -> list[tuple[int, int]]:
    """Return the pairs of groups (numbers, the lower first) that the links join, one for each link."""
    home = {i: k for k, group in enumerate(groups) for i in group}
    pairs = ((home[i], home[j]) for i, j in links)
    return [(min(pair), max(pair)) for pair in pairs if pair[0] != pair[1]]


def _join(groups: Groups, pair: tuple[int, int]) -> None:
    groups[pair[0]] |= groups[pair[1]]
    del groups[pair[1]]
