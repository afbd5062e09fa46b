"""A lower bound on the value of sets of one size, their prices taken off: every set is an average over its pairs.

``q`` robots ``R`` beside those chosen, whose information adds up to ``A``, make ``A + I(R)``, the average of
``A + (q / 2) (I_i + I_k)`` over the pairs ``i != k`` of ``R``. The value is concave in the information, so with
``v_ik`` the value at a pair and prices ``p``

    value(R) - p(R) >= mean over i in R of  mean over k in R, k != i, of  v_ik - q (p_i + p_k) / 2.

The inner mean is at least that of the ``q - 1`` smallest among all robots, ``least_i``, and the outer one at least that
of the ``q`` smallest of those. (Bounds of this kind on quadratic choices: Gilmore, Journal of SIAM 10 (1962); Lawler,
Management Science 9 (1963).) At 60 robots, 40 targets, log-det, the weakest 12 found are worth 185.1; pairs prove
173.3, single robots ``v_ii`` 164.0, triples 177.3 in thirty times as long, affine minorants 170.9.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ratt_opt.attackers.weakest_set.selection import move_least_first
from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import team_criterion

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam, SetFamily

__all__ = ["View", "fill_pairs", "mean_of_least", "pairs_of_family", "views", "weakest_bound", "worth"]


class View(NamedTuple):
    """What decides whether a set is weak: some of a team's targets.

    ``code``, ``weights`` (M,), ``baseline`` : of the criterion; ``prior`` : (M, T); ``information`` : (N, M, T)
    """

    code: int
    weights: FloatArray
    baseline: float
    prior: FloatArray
    information: FloatArray


def views(team: PackedTeam) -> list[View]:
    """A set is weak where it is in one of these: all targets at once, or each alone where the worst one decides."""
    n_targets = len(team.weights)
    by_target = team.objective.states("planar_levels")
    parts = [slice(j, j + 1) for j in range(n_targets)] if by_target else [slice(None)]
    return [
        View(
            team.code,
            team.weights[part].copy(),
            team.baseline,
            team.prior[part].copy(),
            team.information[:, part].copy(),
        )
        for part in parts
    ]


def weakest_bound(view: View, size: int) -> float:
    """No set of ``size`` robots is worth less; minus infinity below three, which need no bound."""
    n_robots = len(view.information)
    if not 2 < size <= n_robots:
        return -np.inf
    pairs, least = np.empty((n_robots, n_robots)), np.empty(n_robots)
    fill_pairs(view, view.prior, np.arange(n_robots), size, pairs)
    return float(mean_of_least(pairs, np.zeros(n_robots), n_robots, size, least))


def pairs_of_family(family: SetFamily) -> float:
    """No set of the family is worth less; minus infinity of sets of fewer than three free robots."""
    team = replace(family.team, prior=family.start, information=family.information)
    return min(weakest_bound(view, family.size) for view in views(team))


@numba.njit(cache=True)
def worth(view: Any, matrices: Any) -> float:
    """The value of posterior information (M, T)."""
    return float(view.baseline - team_criterion(view.code, view.weights, matrices))


@numba.njit(cache=True)
def fill_pairs(view: Any, sums: Any, robots: Any, size: int, pairs: Any) -> None:
    """``pairs[x, y]`` is the value of ``sums`` and ``size / 2`` copies of each of two of the ``robots`` (n,)."""
    one, half = np.empty_like(sums), 0.5 * size
    for x in range(len(robots)):
        for y in range(x):
            first, second = view.information[robots[x]], view.information[robots[y]]
            for j in range(len(one)):
                for t in range(one.shape[1]):
                    one[j, t] = sums[j, t] + half * (first[j, t] + second[j, t])
            pairs[x, y] = pairs[y, x] = worth(view, one)


@numba.njit(cache=True)
def mean_of_least(pairs: Any, prices: Any, n_robots: int, size: int, least: Any) -> float:
    """The bound for ``size`` > 1 of the first ``n_robots``; fills ``least`` (n,): a set's mean of it is a bound too."""
    row = np.empty(n_robots - 1)
    for x in range(n_robots):
        count = 0
        for y in range(n_robots):
            if y != x:
                row[count] = pairs[x, y] - 0.5 * size * prices[y]
                count += 1
        move_least_first(row, size - 1)
        least[x] = row[: size - 1].sum() / (size - 1) - 0.5 * size * prices[x]
    outer = least[:n_robots].copy()
    move_least_first(outer, size)
    return float(outer[:size].sum() / size)
