"""Convex forms of half the links that groups of a few sizes cut, for the search over seeing robots.

With ``A`` the adjacency matrix, ``d`` degrees and any multipliers ``u``, half the links cut by a group ``x`` are

    x' (diag(u + t) - A) x / 2 + (d - u - t)' x / 2,

as ``x_i^2 = x_i``. Across the vector of ones the matrix is positive semidefinite where ``t`` is the largest eigenvalue
of ``A - diag(u)`` there, and with ``rho`` added to each entry it is along it, too. That adds ``rho size^2 / 2``, which
is taken away again by a line through the least and the largest size: sizes between cut more than is said. The
multipliers are those of the semidefinite bound of the middle size at these prices (``graph/link_scores.py``).

Source: Billionnet and Elloumi, Mathematical Programming 109 (2007).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.groups.size_forms import SizeForms
from ratt_opt.graph.link_scores import RelaxedScores

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["ConvexForms"]

MOST_FORMS, FEWEST_SIZES = 15, 2
"""Forms at most, and sizes of each at least: at 30 robots on hubs forms of four take 1.4 times the nodes."""

FIRST_STEPS, STEPS = 20, 4
"""Of the descent of a form's multipliers, from none and from those at other prices: at 30 robots on hubs 5, 10, 20 and
40 first steps leave 39,000, 30,000, 21,600 and 21,100 nodes."""

SHIFT, SURE = 0.02, 1e-9
"""Added to ``t``, so that ``rho`` need not be large, and to the form, so that rounding leaves it semidefinite."""


class ConvexForms:
    """Forms of one threat's graph.

    ``known`` : the last ones, valid at any prices; ``none`` : no forms; ``n_forms`` : how many there are once fitted
    """

    def __init__(self, threat: Threat) -> None:
        n_robots = threat.graph.n_robots
        self._adjacent = np.zeros((n_robots, n_robots))
        for i, j in threat.graph.links:
            self._adjacent[i, j] = self._adjacent[j, i] = 1.0
        sizes = max(FEWEST_SIZES, -(-n_robots // MOST_FORMS))
        self._low = np.arange(1, n_robots + 1, sizes)
        self._high = np.minimum(self._low + sizes - 1, n_robots)
        self._multipliers = np.zeros((self.n_forms, n_robots))
        self._is_fitted = np.zeros(self.n_forms, dtype=np.bool_)
        self.none = self._none()
        self.known = self.none

    @property
    def n_forms(self) -> int:
        """How many there are once they are fitted."""
        return len(self._low)

    def fit(self, prices: FloatArray, largest: int, budget: Budget) -> None:
        """Fit the forms of at most ``largest`` robots to prices (N,) of robots.

        Raises
        ------
        OutOfBudget : the time is up; the forms are as before.
        """
        relaxed = RelaxedScores(self._adjacent, self._adjacent.sum(axis=1) - 2.0 * prices)
        forms = []
        for k in range(self.n_forms - 1, -1, -1):
            budget.check()
            low, high = int(self._low[k]), int(self._high[k])
            if low <= largest and high < len(prices):
                self._descend(relaxed, k, (low + high) / 2.0)
            forms.append(self._form(relaxed, self._multipliers[k], (low, high)))
        form, linear, constant = zip(*forms[::-1], strict=True)
        self.known = SizeForms(np.array(form), np.array(linear), np.array(constant), self._low, self._high)

    def _descend(self, relaxed: RelaxedScores, k: int, size: float) -> None:
        start = self._multipliers[k]
        if not self._is_fitted[k] and k + 1 < self.n_forms:
            start = self._multipliers[k + 1]
        _, self._multipliers[k] = relaxed.descend(size, start, STEPS if self._is_fitted[k] else FIRST_STEPS)
        self._is_fitted[k] = True

    def _form(
        self, relaxed: RelaxedScores, multipliers: FloatArray, sizes: tuple[int, int]
    ) -> tuple[FloatArray, FloatArray, float]:
        """Form, linear part and constant for groups of so many robots."""
        n_robots, (low, high), across = len(multipliers), sizes, relaxed.across
        inner = relaxed.inner - (across * multipliers[:, None]).T @ across
        level = float(np.linalg.eigvalsh(inner)[-1]) + SHIFT if len(inner) else SHIFT
        form = np.diag(multipliers + level) - self._adjacent
        along = across.T @ form.sum(axis=1) / np.sqrt(n_robots)
        missing = along @ np.linalg.solve(level * np.eye(len(inner)) - inner, along) - form.sum() / n_robots
        rho = max(float(missing), 0.0) / n_robots + SURE
        linear = 0.5 * (self._adjacent.sum(axis=1) - multipliers - level - SURE - rho * (low + high))
        return form + rho + SURE * np.eye(n_robots), linear, 0.5 * rho * low * high

    def _none(self) -> SizeForms:
        n_robots = len(self._adjacent)
        none = np.zeros(0, dtype=self._low.dtype)
        return SizeForms(np.zeros((0, n_robots, n_robots)), np.zeros((0, n_robots)), np.zeros(0), none, none)
