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

__all__ = ["FamilyPrices", "FamilyProgram"]


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


class FamilyProgram:
    """The linear program for a complete graph; sets may be added, and the threshold changed, at any time.

    Columns: w (N,), mu, sigma, a level, and how far each price is below it (N,): the sum of the smallest prices.
    """

    def __init__(self, threat: Threat) -> None:
        self._n_robots, self._n_blinded = threat.graph.n_robots, threat.n_blinded
        self._n_seeing = self._n_robots - self._n_blinded
        self._kept = comb(self._n_robots, 2) - threat.alpha_c - comb(self._n_blinded, 2)
        self._sets: dict[bytes, tuple[BoolArray, float]] = {}
        self._program: LinearProgram | None = None
        self._threshold = -np.inf

    def add(self, members: BoolArray, value: float) -> bool:
        """Add a set (N,) of that value; whether it is new."""
        key = members.tobytes()
        if key in self._sets:
            return False
        self._sets[key] = members.copy(), value
        if self._program is not None and value < self._threshold:
            self._append(self._program, [members])
        return True

    def solve(self, threshold: float, seconds: float = np.inf) -> FamilyPrices | None:
        """Prices that no known set worth less pays, and that claim most; ``None`` where the program says nothing."""
        if self._program is None or threshold != self._threshold:
            self._program, self._threshold = self._start(), threshold
            self._append(self._program, [members for members, value in self._sets.values() if value < threshold])
        x = self._program.solve(seconds).x
        n = self._n_robots
        if len(x) != 2 * n + 3:
            return None
        robots, link, bonus = x[:n], max(float(x[n]), 0.0), float(x[n + 1])
        sizes = np.arange(n + 1, dtype=np.float64)
        limits = -link * sizes * (sizes - 1) / 2
        if self._n_blinded:
            limits = np.minimum(limits, bonus + limits - link * self._n_blinded * sizes)
        claim = float(np.sort(robots)[: self._n_seeing].sum()) + link * self._kept - bonus
        return FamilyPrices(robots=robots, limits=limits, claim=claim, n_seeing=self._n_seeing)

    def _start(self) -> LinearProgram:
        n, most = self._n_robots, float(self._n_robots)
        cost = np.concatenate([np.zeros(n), [self._kept, -1.0, self._n_seeing], -np.ones(n)])
        bonus = np.inf if self._n_blinded else 0.0
        low = np.concatenate([np.full(n, -most), [0.0, -bonus, -np.inf], np.zeros(n)])
        high = np.concatenate([np.full(n, most), [1.0, bonus, np.inf], np.full(n, np.inf)])
        below = [([i, n + 2, n + 3 + i], [-1.0, 1.0, -1.0]) for i in range(n)]
        return LinearProgram(cost, low, high, rows=rows_of(below, -np.inf, 0.0), maximise=True)

    def _append(self, program: LinearProgram, sets: list[BoolArray]) -> None:
        """That these sets do not pay."""
        n, entries = self._n_robots, []
        for members in sets:
            robots = np.flatnonzero(members).tolist()
            size, ones = len(robots), [1.0] * len(robots)
            entries.append(([*robots, n], [*ones, float(comb(size, 2))]))
            if self._n_blinded:
                held = float(comb(size, 2) + self._n_blinded * size)
                entries.append(([*robots, n, n + 1], [*ones, held, -1.0]))
        program.add_rows(rows_of(entries, np.full(len(entries), -np.inf), np.zeros(len(entries))))
