"""Branch and bound over a covering problem: few links that block the worst of the known attacks.

A choice of links is worth the weakest of the known attacks that withstand it. At a node some candidates are chosen and
some excluded. Of the attacks that withstand the choice, going from the worst, one that can no longer be blocked bounds
the node, and so do attacks that share no candidate and together need more links than are left: one of them stays. The
node branches on which candidate of the worst attack is chosen first: the ones before it are excluded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack import params as parameters
from ratt_opt.graph.communication import membership

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt.attack.protection.known_attacks import KnownAttack
    from ratt_opt.budget import Budget

__all__ = ["LinkChoice", "best_choice"]


@dataclass(frozen=True, slots=True)
class LinkChoice:
    """Candidates as a bit mask; no known attack that withstands them leaves less than ``value``."""

    chosen: int
    value: float


def best_choice(
    known: Sequence[KnownAttack], count: int, budget: Budget, *, above: float, enough: float
) -> LinkChoice | None:
    """The choice of at most ``count`` candidates of largest value; ``None`` if none is worth more than ``above``.

    Parameters
    ----------
    known : attacks, the weakest value first
    enough : a value that no choice exceeds: one that reaches it is returned at once

    Raises
    ------
    OutOfBudget : the time is up, or the user interrupted.
    """
    search = _ChoiceSearch(known, budget, above, enough)
    search.descend(0, 0, count)
    return search.best


class _ChoiceSearch:
    def __init__(self, known: Sequence[KnownAttack], budget: Budget, above: float, enough: float) -> None:
        self.best: LinkChoice | None = None
        self._known, self._budget, self._level, self._enough = known, budget, above, enough

    def descend(self, chosen: int, excluded: int, left: int) -> None:
        """Search the choices that hold ``chosen``, nothing ``excluded``, and at most ``left`` more."""
        self._budget.check()
        withstands = [attack for attack in self._known if attack.withstands(chosen)]
        if self._bound(withstands, chosen, excluded, left) <= self._level:
            return
        free = withstands[0].links & ~excluded & ~chosen if withstands else 0
        if not withstands or _missing(withstands[0], chosen) > min(left, free.bit_count()):
            # The worst attack stays whatever is chosen: it is what the choice is worth, and the rest is free.
            self._level = withstands[0].value if withstands else math.inf
            self.best = LinkChoice(_filled(withstands, chosen, left), self._level)
            return
        for candidate in _most_useful_first(free, withstands):
            if self._level >= self._enough:
                return
            self.descend(chosen | candidate, excluded, left - 1)
            excluded |= candidate

    @staticmethod
    def _bound(withstands: Sequence[KnownAttack], chosen: int, excluded: int, left: int) -> float:
        used = total = 0
        for attack in withstands:
            missing, free = _missing(attack, chosen), attack.links & ~excluded & ~chosen
            if missing > min(left, free.bit_count()):
                return attack.value
            if not free & used:
                used |= free
                total += missing
                if total > left:
                    return attack.value
        return math.inf


def _missing(attack: KnownAttack, chosen: int) -> int:
    return attack.need - (attack.links & chosen).bit_count()


def _most_useful_first(free: int, withstands: Sequence[KnownAttack]) -> Iterator[int]:
    """The candidates of a mask, those first that block most of the worst attacks; the lowest among equals."""
    first = withstands[: parameters.DEFAULT.protection.ranked]
    blocked = membership([free, *(attack.links & free for attack in first)], free.bit_length())
    members, useful = np.flatnonzero(blocked[0]), blocked[1:].sum(axis=0)
    for k in members[np.argsort(-useful[members], kind="stable")].tolist():
        yield 1 << k


def _filled(withstands: Sequence[KnownAttack], chosen: int, left: int) -> int:
    """A choice with what is left spent on further attacks, from the worst: choosing more never helps the adversary."""
    for attack in withstands:
        missing = _missing(attack, chosen)
        free = attack.links & ~chosen
        if 0 < missing <= min(left, free.bit_count()):
            for bit, _ in zip(_most_useful_first(free, withstands), range(missing), strict=False):
                chosen |= bit
            left -= missing
    return chosen
