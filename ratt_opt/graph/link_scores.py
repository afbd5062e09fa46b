"""Largest scores of groups by number of robots: an attack's groups must score enough together.

A group ``g`` with ``e(g)`` links inside and degrees ``d`` (in the whole graph) scores, for a share ``w`` in [0, 1],

    2 e(g) - (1 - w) sum of d over g:

twice the links inside for ``w = 1``, minus the links it cuts for ``w = 0``. Over the groups of a partition the scores
add up to ``2 (w |links| - cut)``, so a partition within the budget scores at least ``2 (w |links| - alpha_c)``; and no
group cuts more than ``alpha_c`` links.

What a group of ``s`` robots scores at most is bounded by Lagrangian duality: ``x_i^2 = x_i`` for members, with a
multiplier ``u_i`` each, and the sum ``s`` of all, which leaves a quadratic form on a sphere, whose largest value
eigenvalues give. Any multipliers are valid; descent improves them. This is the bound of a semidefinite relaxation.

Source: for the relaxation, Poljak, Rendl and Wolkowicz, Journal of Global Optimization 7 (1995); for the largest value
of a quadratic form on a sphere, More and Sorensen, SIAM Journal on Scientific and Statistical Computing 4 (1983).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import CommunicationGraph

__all__ = [
    "SHARES",
    "LinkScores",
    "MostScores",
    "RelaxedScores",
    "SphereMaximum",
    "link_scores",
    "most_scores",
    "scoring_group",
]

SHARES = (1.0, 0.5, 0.0)
"""Shares ``w``: links inside, links cut, and one between, whose scores are multiples of a half too."""


@dataclass(frozen=True, slots=True)
class LinkScores:
    """Necessary condition on the groups of an attack.

    For each share ``k``, a group of ``s`` robots scores at most ``most[k, s]``, and all groups together at least
    ``need[k]``.

    ``most`` : (K, N + 1), minus infinity if no group of an attack has that many robots; ``need`` : (K,);
    ``least`` : (K,) least score of each group
    """

    most: FloatArray
    need: FloatArray
    least: FloatArray


def link_scores(graph: CommunicationGraph, alpha_c: int, budget: Budget) -> LinkScores:
    """Scores for each of ``SHARES``; when the budget is over, bounds are what is known by then.

    ``alpha_c`` : links that may be cut. What was found out about the last few graphs is kept, and gone on with.
    """
    need = np.array([2.0 * (share * len(graph.links) - alpha_c) for share in SHARES])
    least = np.array([-alpha_c if share == 0.0 else -np.inf for share in SHARES])
    most = most_scores(graph).run(budget)
    return LinkScores(np.where(most < least[:, None], -np.inf, most), need, least)


@lru_cache(maxsize=8)
def most_scores(graph: CommunicationGraph) -> MostScores:
    """Return the cached score bounds of a graph (the last few graphs), so that searches share them."""
    return MostScores(graph)


class MostScores:
    """Best bounds so far for every share and size, from everybody down to nobody.

    ``multipliers`` : (K, N + 1, N) that give them
    """

    def __init__(self, graph: CommunicationGraph) -> None:
        n_robots, sizes = graph.n_robots, np.arange(graph.n_robots + 1)
        adjacent = np.zeros((n_robots, n_robots))
        for i, j in graph.links:
            adjacent[i, j] = adjacent[j, i] = 1.0
        degrees = adjacent.sum(axis=1)
        charges = [(1.0 - share) * degrees for share in SHARES]
        least = np.array([np.concatenate([[0.0], np.cumsum(np.sort(charge))]) for charge in charges])
        self._most = np.minimum(sizes * (sizes - 1.0), degrees.sum()) - least
        self.relaxed = [RelaxedScores(adjacent, charge) for charge in charges]
        self.multipliers = np.zeros((len(SHARES), n_robots + 1, n_robots))
        self._left = [(k, size) for size in range(2, n_robots) for k in range(len(SHARES))]

    def run(self, budget: Budget) -> FloatArray:
        """(K, N + 1) bounds; descends for the sizes that are left."""
        while self._left and not budget.is_over:
            k, size = self._left[-1]
            bound, self.multipliers[k, size] = self.relaxed[k].descend(size, self.multipliers[k, size + 1])
            self._most[k, size] = min(self._most[k, size], _rounded(bound))
            self._left.pop()
        return np.array(self._most)

    def branch(self, node: tuple[BoolArray, BoolArray], joining: int, needed: FloatArray) -> int | None:
        """``None`` if robots inside with ``joining`` undecided ones (N,) never score so much, else one to decide."""
        inside, undecided = node
        starts = self.multipliers[:, int(inside.sum()) + joining][:, undecided]
        unclear = np.zeros(len(starts[0]))
        for relaxed, start, least in zip(self.relaxed, starts, needed, strict=True):
            fixed, others = relaxed.around(inside, undecided)
            if joining in {0, len(start)}:
                bound = float(others.adjacent.sum() - others.charge.sum()) * bool(joining)
            else:
                bound, unclear = others.bound(start, joining)
                bound += others.rounding(start)
                if _rounded(fixed + bound) >= least:
                    bound = min(bound, others.descend(joining, start)[0])
            if _rounded(fixed + bound) < least:
                return None
        return int(np.flatnonzero(undecided)[unclear.argmax()]) if len(unclear) else -1


def scoring_group(
    graph: CommunicationGraph, members: BoolArray, joining: int, needed: FloatArray, budget: Budget, *, most: int = 100
) -> BoolArray | None:
    """Find these robots (N,) and ``joining`` others that score enough (K,); ``None`` if it is proved that none do.

    Others are taken or left one by one, a node each in ``budget``; after ``most`` of them (100 take about 0.1 s)
    ``members`` are returned, and nothing is known.

    Raises
    ------
    OutOfBudget : the budget is spent.
    """
    known, size = most_scores(graph), int(members.sum()) + joining
    nodes = [(members, ~members)]
    for _ in range(most):
        if not nodes:
            return None
        budget.spend()
        inside, undecided = nodes.pop()
        left = size - int(inside.sum())
        if left > undecided.sum():
            continue
        robot = known.branch((inside, undecided), left, needed)
        if robot is None:
            continue
        if left == 0:
            return inside
        one = np.arange(graph.n_robots) == robot
        nodes += [(inside, undecided & ~one), (inside | one, undecided & ~one)]
    return members


def _rounded(bound: float) -> float:
    """Scores are multiples of a half."""
    margin = 1e-6  # eigenvalues and sums are off by some 1e-14 of the numbers that go into them
    return float(np.floor(2.0 * (bound + margin * (1.0 + abs(bound)))) / 2.0)


@dataclass(frozen=True, slots=True)
class SphereMaximum:
    """A bound of a quadratic form on a sphere, the point that attains it, and the sphere's multiplier."""

    value: float
    place: FloatArray
    level: float


@lru_cache(maxsize=256)
def _across(n_robots: int) -> FloatArray:
    """(N, N - 1) orthonormal, across the vector of ones."""
    columns = np.column_stack([np.ones(n_robots), np.eye(n_robots)[:, 1:]])
    return np.linalg.qr(columns)[0][:, 1:]


@dataclass(frozen=True, slots=True)
class RelaxedScores:
    """Bounds of ``x' A x - charge' x`` over vectors of zeros and ``s`` ones."""

    adjacent: FloatArray
    charge: FloatArray
    across: FloatArray = field(init=False)
    inner: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        across = _across(len(self.adjacent))
        object.__setattr__(self, "across", across)
        object.__setattr__(self, "inner", across.T @ self.adjacent @ across)

    def around(self, members: BoolArray, others: BoolArray) -> tuple[float, RelaxedScores]:
        """Return the score of ``members`` (N,) alone, and the form of what some of the ``others`` (N,) add to it."""
        ties = self.adjacent[:, members].sum(axis=1)
        alone = float(ties[members].sum() - self.charge[members].sum())
        return alone, RelaxedScores(self.adjacent[np.ix_(others, others)], self.charge[others] - 2.0 * ties[others])

    @staticmethod
    def rounding(multipliers: FloatArray) -> float:
        """More than what a bound by these is off by, if it is not much larger than 1: some 1e-14 of the largest."""
        return 1e-11 * len(multipliers) * float(np.abs(multipliers).max(initial=0.0))

    def descend(self, size: float, start: FloatArray, steps: int = 6) -> tuple[float, FloatArray]:
        """A better bound for groups of ``size`` and its multipliers (N,), by quasi-Newton steps.

        ``steps`` : from the multipliers of the size before. On twelve threats of 30 and 50 robots (dense, disks of mean
            degree 12, hubs), with 3 the vectors of dense graphs are coarser, with 12 only those of disks and hubs are a
            little finer; 6 take a quarter of a second at 30 robots, one at 50
        """
        from scipy.optimize import minimize  # a third of a second

        found = minimize(self.bound, start, args=(size,), jac=True, method="L-BFGS-B", options={"maxiter": steps})
        return float(found.fun) + self.rounding(found.x), found.x

    def bound(self, multipliers: FloatArray, size: float) -> tuple[float, FloatArray]:
        """The bound for these multipliers (N,), and its gradient.

        Members are ``x = s / N + y`` with ``y`` across the vector of ones, ``|y|^2 = s (1 - s / N)``.
        """
        top = self.top(multipliers, size)
        return top.value, top.place - top.place**2

    def top(self, multipliers: FloatArray, size: float) -> SphereMaximum:
        """The bound for these multipliers (N,), and the point that attains it."""
        n_robots = len(multipliers)
        mean, linear = size / n_robots, multipliers - self.charge
        radius = size * (1.0 - mean)
        row_sums = self.adjacent.sum(axis=1) - multipliers
        fixed = mean * (mean * row_sums.sum() + linear.sum())
        levels, turn = np.linalg.eigh(self.inner - (self.across * multipliers[:, None]).T @ self.across)
        slope = turn.T @ (self.across.T @ (2.0 * mean * row_sums + linear))
        top = _on_sphere(levels, slope, radius)
        return SphereMaximum(fixed + top.value, mean + self.across @ (turn @ top.place), top.level)


def _on_sphere(levels: FloatArray, slope: FloatArray, radius: float) -> SphereMaximum:
    """A bound of ``sum of levels z^2 + slope z`` over ``|z|^2 = radius``, the largest value up to rounding; its point.

    For every ``t > levels`` the value is at most ``t radius + sum of slope^2 / (4 (t - levels))``; the best ``t`` has
    ``z = slope / (2 (t - levels))`` on the sphere.
    """
    least = levels[-1] + 1e-9 * max(1.0, abs(levels[-1]))
    low, high = least, least + 0.5 * float(np.linalg.norm(slope)) / np.sqrt(radius)
    best = least if _squared(levels, slope, least) <= radius else high
    while best > least and high - low > 1e-12 * (1.0 + abs(high)):
        best = (low + high) / 2.0
        if _squared(levels, slope, best) > radius:
            low = best
        else:
            high = best
    place = slope / (2.0 * (best - levels))
    top = best * radius + float((slope**2 / (4.0 * (best - levels))).sum())
    place[-1] += np.sqrt(max(radius - float(place @ place), 0.0))
    return SphereMaximum(top, place, best)


def _squared(levels: FloatArray, slope: FloatArray, t: float) -> float:
    return float(((slope / (2.0 * (t - levels))) ** 2).sum())
