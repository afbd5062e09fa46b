"""Attacks as they bear on links still to be chosen: what each leaves, and how many of which links spoil it.

An attack is kept as the groups it separates and the robots it blinds. Whatever links are chosen, it stays possible
until ``need`` of the candidates between its groups are. So the fewer groups, the harder it is to spoil: groups are
joined as long as the joint one is worth no more than what the attack has to show.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt.attackers.link_choice.upgrades import Upgrade
    from ratt_opt.attackers.task import PlanValues
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Attack, Problem

__all__ = ["KnownAttack", "KnownAttacks"]

Groups = list[frozenset[int]]


@dataclass(frozen=True, slots=True, order=True)
class KnownAttack:
    """Leaves at most ``value``, unless ``need`` or more of the candidates in the bit mask ``links`` are chosen."""

    value: float
    links: int
    need: int
    groups: tuple[frozenset[int], ...]
    blinded: frozenset[int]

    def withstands(self, chosen: int) -> bool:
        """Whether it is still possible where these candidates (a bit mask) are chosen."""
        return (self.links & chosen).bit_count() < self.need


class KnownAttacks:
    """All attacks met so far, weakest team first; each is kept once."""

    def __init__(self, upgrade: Upgrade, values: PlanValues) -> None:
        self.upgrade = upgrade
        self.ascending: list[KnownAttack] = []
        self._values = values
        self._worth: dict[frozenset[int], float] = {}
        # Links of the graph count too: only groups with something between them are worth joining.
        self._pairs = sorted({*upgrade.candidates, *upgrade.problem.communication.links})

    def meet(self, attack: Attack, problem: Problem, goal: float) -> None:
        """Keep an attack on the team of a changed problem, with as few groups as leave ``goal``, or what it leaves."""
        groups = list(problem.communication.groups(attack.links))
        value = max(self._worths(groups, attack.sensing))
        self._keep(self._joined(groups, attack.sensing, max(value, goal)), attack.sensing)

    def adapt(self, chosen: Sequence[Link], below: float) -> bool:
        """Keep what known attacks become where links are chosen that spoil them, if one leaves at most ``below``.

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
        wanted = set(links)
        return sum(1 << k for k, link in enumerate(self.upgrade.candidates) if link in wanted)

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
        while True:
            between = _between(groups, self._pairs)
            counts = {pair: between.count(pair) for pair in sorted(set(between))}
            worths = self._worths([groups[a] | groups[b] for a, b in counts], blinded)
            allowed = [pair for pair, worth in zip(counts, worths, strict=True) if worth <= goal]
            if not allowed:
                return groups
            _join(groups, max(allowed, key=lambda pair: counts[pair]))

    def _keep(self, groups: Groups, blinded: frozenset[int]) -> None:
        home = {i: k for k, group in enumerate(groups) for i in group}
        links = sum(1 << k for k, (i, j) in enumerate(self.upgrade.candidates) if home[i] != home[j])
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


def _between(groups: Groups, links: Iterable[Link]) -> list[tuple[int, int]]:
    """For each link between two groups, the numbers of these, the lower first."""
    home = {i: k for k, group in enumerate(groups) for i in group}
    pairs = ((home[i], home[j]) for i, j in links)
    return [(min(pair), max(pair)) for pair in pairs if pair[0] != pair[1]]


def _join(groups: Groups, pair: tuple[int, int]) -> None:
    groups[pair[0]] |= groups[pair[1]]
    del groups[pair[1]]
