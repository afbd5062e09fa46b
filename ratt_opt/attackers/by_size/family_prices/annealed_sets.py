"""Weak sets that pay the prices most, by annealing one around every robot, and one of every size: no claim.

A state is a set of robots worth less than the threshold. Moves add a robot, take one away or exchange two; where sizes
between pay little, sets do not grow through them (at 60 robots, (8, 999), log-det, none of 24 robots was found from
single robots), so sets of one size begin with a weak one and only exchange.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attackers.weakest_set.pair_bound import worth
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.attackers.weakest_set.pair_bound import View
    from ratt_opt.budget import Budget

__all__ = ["annealed_of_size", "annealed_sets"]

HOT, COLD = 0.3, 0.003
"""First and last temperature, relative to the dearest robot."""
EXCHANGE = 0.6
"""Chance that a move exchanges two robots."""


def annealed_sets(  # noqa: PLR0917
    view: View,
    threshold: float,
    robots: FloatArray,
    links: FloatArray,
    moves: int,
    rng: np.random.Generator,
    budget: Budget,
) -> Iterator[tuple[BoolArray, float]]:
    """A weak set (N,) with each weak robot, and what it pays: ``robots`` (N,), and ``links`` (N + 1,) by its size."""
    dearest = max(float(np.abs(robots).max()), float(np.abs(np.diff(links)).max()) / len(robots), 1e-300)
    cooling, prices = (moves, HOT * dearest, COLD / HOT), (robots, links)
    for first in range(len(robots)):
        if budget.is_over:
            return
        best = np.zeros(len(robots), dtype=np.bool_)
        paid = _anneal(view, threshold, prices, first, cooling, rng, best)
        if best.any():
            yield best, float(paid)


def annealed_of_size(  # noqa: PLR0917
    view: View, threshold: float, robots: FloatArray, weak: BoolArray, moves: int, rng: np.random.Generator
) -> BoolArray:
    """The set (N,) that pays most of those that exchanges make of a weak one; prices are ``robots`` (N,)."""
    best = weak.copy()
    spread = max(float(np.ptp(robots)), 1e-300)
    _exchange(view, threshold, robots, weak.copy(), (moves, HOT * spread, COLD / HOT), rng, best)
    return best


@numba.njit(cache=True)
def _exchange(view: Any, threshold: float, robots: Any, members: Any, cooling: Any, rng: Any, best: Any) -> None:  # noqa: PLR0917
    """Anneal ``members`` (N,) by exchanges; ``best`` (N,) is the set that pays most; ``cooling`` as below."""
    moves, hot, fall = cooling
    inside, outside = np.flatnonzero(members), np.flatnonzero(~members)
    sums, trial, paid, most = view.prior.copy(), np.empty_like(view.prior), 0.0, 0.0
    for i in inside:
        sums += view.information[i]
    for move in range(moves if len(inside) * len(outside) > 0 else 0):
        x, y = int(rng.random() * len(inside)), int(rng.random() * len(outside))
        rise = robots[outside[y]] - robots[inside[x]]
        if rise < 0 and rng.random() >= np.exp(rise / (hot * fall ** (move / moves))):
            continue
        if _change(view, sums, trial, outside[y], inside[x], 1) >= threshold:
            continue
        sums[:], paid = trial, paid + rise
        inside[x], outside[y] = outside[y], inside[x]
        if paid > most:
            most = paid
            best[:] = False
            best[inside] = True


@numba.njit(cache=True)
def _change(view: Any, sums: Any, trial: Any, robot: int, other: int, sign: float) -> float:  # noqa: PLR0917
    """The value after a robot joins (sign 1) or leaves (-1), and another one (-1: none) the other way round."""
    for j in range(len(sums)):
        for t in range(3):
            moved = view.information[robot, j, t] - (view.information[other, j, t] if other >= 0 else 0.0)
            trial[j, t] = sums[j, t] + sign * moved
    return worth(view, trial)


@numba.njit(cache=True)
def _anneal(view: Any, threshold: float, prices: Any, first: int, cooling: Any, rng: Any, best: Any) -> float:  # noqa: PLR0917
    """Anneal a set around one robot; ``best`` (N,) is the one that pays most, empty where the robot is not weak.

    ``cooling`` : moves, first temperature, the last over it
    """
    (robots, links), (moves, hot, fall) = prices, cooling
    inside, n_robots = np.zeros(len(robots), dtype=np.bool_), len(robots)
    sums, trial = view.prior + view.information[first], np.empty_like(view.prior)
    if worth(view, sums) >= threshold:
        return -np.inf
    inside[first], size, paid = True, 1, robots[first] + links[1]
    best[:], most = inside, paid
    for move in range(moves):
        i, other = int(rng.random() * n_robots), -1
        if rng.random() < EXCHANGE:
            other = int(rng.random() * n_robots)
        if first in (i, other) or (other >= 0 and inside[i] == inside[other]):
            continue
        sign = -1 if inside[i] else 1
        after = size + (sign if other < 0 else 0)
        rise = sign * (robots[i] - (robots[other] if other >= 0 else 0.0)) + links[after] - links[size]
        if rise < 0 and rng.random() >= np.exp(rise / (hot * fall ** (move / moves))):
            continue
        if _change(view, sums, trial, i, other, sign) >= threshold:
            continue
        sums[:], size, paid = trial, after, paid + rise
        inside[i] = not inside[i]
        if other >= 0:
            inside[other] = not inside[other]
        if paid > most:
            best[:], most = inside, paid
    return float(most)
