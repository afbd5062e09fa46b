"""Prices of robots and links that no weak set pays, by a linear program over the sets known so far.

An attack blinds ``b`` of N robots and leaves groups of the others, the largest of ``s`` robots and perhaps with the
blinded ones; they keep at most ``sum_k C(s_k, 2) + b s + C(b, 2)`` links, and ``kept`` of all have to stay. Let robots
have prices ``w``, links ``mu >= 0``, the largest group a bonus ``sigma``, and let every set ``S`` worth less than a
threshold have

    w(S) <= -mu C(|S|, 2),    and    w(S) <= sigma - mu (C(|S|, 2) + b |S|).

If all groups are worth less, the second line for the largest and the first for the others add up to
``w(all groups) <= sigma - mu (kept - C(b, 2))``. So there is no such attack where the ``N - b`` smallest prices add up
to more.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.graph.threat import Threat

__all__ = ["Choice", "FamilyPrices", "FamilyProgram"]


TAKEN = 1e6
"""What a set pays less for a robot that has a group: more than any set may pay."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FamilyPrices:
    """``robots`` (N,) : w; ``limits`` (N + 1,) : what a weak set of each size must not exceed; ``claim`` [links] : by
    how much the smallest prices exceed what the groups of an attack then pay: above 0, there is none.
    """

    robots: FloatArray
    limits: FloatArray
    claim: float
    n_seeing: int

    def lowered(self, claim: float) -> FamilyPrices:
        """Every robot cheaper, so that less is claimed."""
        return replace(self, robots=self.robots - (self.claim - claim) / self.n_seeing, claim=claim)


@dataclass(frozen=True, slots=True)
class Choice:
    """A group (N,) of an attack, perhaps the one that the blinded robots stay with."""

    members: BoolArray
    has_blinded: bool


class FamilyProgram:
    """The linear program for a complete graph; sets may be added, and the threshold changed, at any time.

    Columns: w (N,), mu, sigma, a level, and how far each price is below it (N,): the sum of the smallest prices.

    ``chosen`` : groups that an attack has already; the program is about its other groups
    ``is_scaled`` : links have a price of 1, so that minus the claim is how many links more than necessary a relaxed
    attack keeps; else the scale is free, and the claim 0 where there is such an attack
    """

    def __init__(self, threat: Threat, chosen: tuple[Choice, ...] = (), *, is_scaled: bool = False) -> None:
        self._threat, self.chosen, self._is_scaled = threat, chosen, is_scaled
        self._n_robots, self._n_blinded = threat.graph.n_robots, threat.n_blinded
        self.free = np.ones(self._n_robots, dtype=np.bool_)
        self.kept = comb(self._n_robots, 2) - threat.alpha_c - comb(self._n_blinded, 2)
        """Links that the other groups have to keep."""
        for choice in chosen:
            self.free &= ~choice.members
            self.kept -= self.links(choice)
        self.n_seeing = int(self.free.sum()) - self._n_blinded
        self.may_have_blinded = self._n_blinded > 0 and not any(choice.has_blinded for choice in chosen)
        self._sets: dict[bytes, tuple[BoolArray, float]] = {}
        self._program: LinearProgram | None = None
        self._threshold = -np.inf
        self._rows: list[Choice] = []

    @property
    def most_links(self) -> int:
        """Links that all robots left keep in one group."""
        size = max(self.n_seeing, 0)
        return comb(size, 2) + (self._n_blinded * size if self.may_have_blinded else 0)

    def with_choice(self, choice: Choice) -> FamilyProgram:
        """The program for an attack with one more group; it knows the same sets."""
        after = FamilyProgram(self._threat, (*self.chosen, choice), is_scaled=self._is_scaled)
        for members, value in self._sets.values():
            after.add(members, value)
        return after

    def add(self, members: BoolArray, value: float) -> bool:
        """Add a set (N,) of that value; whether it is new, and may be a group beside those chosen."""
        key = members.tobytes()
        if key in self._sets or not self.free[members].all() or members.sum() > self.n_seeing:
            return False
        self._sets[key] = members.copy(), value
        if self._program is not None and value < self._threshold:
            self._append(self._program, [members])
        return True

    def solve(self, threshold: float, seconds: float = np.inf) -> FamilyPrices | None:
        """Prices that no known set worth less pays, and that claim most; ``None`` where the program says nothing."""
        self._set_threshold(threshold)
        assert self._program is not None
        x = self._program.solve(seconds).x
        n = self._n_robots
        if len(x) != 2 * n + 3:
            return None
        robots, link, bonus = np.where(self.free, x[:n], -TAKEN), max(float(x[n]), 0.0), float(x[n + 1])
        sizes = np.arange(n + 1, dtype=np.float64)
        limits = -link * sizes * (sizes - 1) / 2
        if self.may_have_blinded:
            limits = np.minimum(limits, bonus + limits - link * self._n_blinded * sizes)
        claim = float(np.sort(robots[self.free])[: self.n_seeing].sum()) + link * self.kept - bonus
        return FamilyPrices(robots=robots, limits=limits, claim=claim, n_seeing=self.n_seeing)

    def shares(self, threshold: float, seconds: float = np.inf) -> list[tuple[float, Choice]]:
        """How much of each group has the relaxed attack, of known sets worth less, that keeps most links.

        Empty where the program says nothing; of a scaled program.
        """
        self._set_threshold(threshold)
        assert self._program is not None
        duals = np.abs(self._program.solve(seconds).duals[self._n_robots :])
        return [(float(share), choice) for share, choice in zip(duals, self._rows, strict=False) if share > 0]

    def _set_threshold(self, threshold: float) -> None:
        if self._program is None or threshold != self._threshold:
            self._program, self._threshold, self._rows = self._start(), threshold, []
            self._append(self._program, [members for members, value in self._sets.values() if value < threshold])

    def links(self, choice: Choice) -> int:
        """Links that a group keeps."""
        size = int(choice.members.sum())
        return comb(size, 2) + (self._n_blinded * size if choice.has_blinded else 0)

    def _start(self) -> LinearProgram:
        n, most = self._n_robots, float(self._n_robots)
        cost = np.concatenate([np.zeros(n), [self.kept, -1.0, self.n_seeing], -1.0 * self.free])
        bonus = np.inf if self.may_have_blinded else 0.0
        low = np.concatenate([np.full(n, -most), [float(self._is_scaled), -bonus, -np.inf], np.zeros(n)])
        high = np.concatenate([np.full(n, most), [1.0, bonus, np.inf], np.full(n, np.inf)])
        below = [([i, n + 2, n + 3 + i], [-1.0, 1.0, -1.0]) for i in range(n)]
        return LinearProgram(cost, low, high, rows=rows_of(below, -np.inf, 0.0), maximise=True)

    def _append(self, program: LinearProgram, sets: list[BoolArray]) -> None:
        """That these sets do not pay."""
        n, entries = self._n_robots, []
        for members in sets:
            robots = np.flatnonzero(members).tolist()
            for has_blinded in (False, True) if self.may_have_blinded else (False,):
                choice = Choice(members, has_blinded)
                self._rows.append(choice)
                columns, values = [*robots, n], [*[1.0] * len(robots), float(self.links(choice))]
                entries.append(([*columns, n + 1], [*values, -1.0]) if has_blinded else (columns, values))
        program.add_rows(rows_of(entries, np.full(len(entries), -np.inf), np.zeros(len(entries))))
