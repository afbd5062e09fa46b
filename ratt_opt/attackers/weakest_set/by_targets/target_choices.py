"""Sets that targets choose, each for itself, at shares that make them agree: compiled.

Let ``share[j, i]`` be what target ``j`` is paid for robot ``i``. Then a set ``S`` of ``q`` robots is worth

    sum_j [value_j(S) - share_j(S)] + sum_j share_j(S),

at least what is left where every target, and the last sum, choose ``q`` robots of their own (Lagrangian
decomposition: Guignard and Kim, Mathematical Programming 39 (1987)). A target's value is concave in its information,
so some slopes in it make the ``q`` smallest ``<slopes, information[i]> - share[j, i]`` a best choice. Choices are
improved from several slopes: the gradient at a choice's information has the slopes of the next one. That finds
local choices; ``slope_cells.py`` proves what the best one is worth.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.weakest_set.selection import move_least_first
from ratt_opt.attackers.weakest_set.smoothed_dual import soft_level
from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import target_gradient, target_value

__all__ = ["Ascent", "Family", "ascend", "choose", "pick", "room"]

IMPROVED = 6
"""Steps from slopes to slopes, at most, each time that shares have changed."""
KEPT = 0.7
"""Share of the last direction in the next one."""
SOFT = 0.1
"""Temperature of the choices in a direction, of what the next step aims at."""
STALLED, NEARER = 15, 0.6
"""Steps without progress after which an aim is nearer, and by how much."""
PROGRESS = 0.02
"""Share of what is aimed at that counts as progress."""
FURTHEST = 40.0
"""How much longer than the last direction itself says a step may be that a mean of directions makes."""
HALVINGS = 45
IN_ANY_ORDER = {"reassoc", "nsz", "contract"}
"""Sums of robots' terms may be made in any order, some at once; margins for their rounding hold for each."""


class Family(NamedTuple):
    """Sets of ``size`` of F robots, beside some chosen ones: ``code``, ``weights`` (M,) of the criterion, ``prior``
    (M, 3); ``start`` (M, 3) information with the chosen ones; ``information`` (M, 3, F); ``lacking`` (F,), all 0 where
    nothing is lacking.
    """

    code: int
    weights: Any
    prior: Any
    start: Any
    information: Any
    lacking: Any
    size: int


class Ascent(NamedTuple):
    """``shares`` (M, F), ``multiplier`` (1,) of what is lacking, ``slopes`` (M, K, 3) from which choices are improved,
    ``fraction`` (F,) of each robot in the choices: changed in place.
    """

    shares: Any
    multiplier: Any
    slopes: Any
    fraction: Any


@numba.njit(cache=True)
def pick(scores: Any, size: int, chosen: Any) -> float:
    """Choose the ``size`` smallest scores, the first of equals; their sum."""
    last = move_least_first(scores.copy(), size) if size > 0 else -np.inf
    count, total = 0, 0.0
    for i in range(len(scores)):
        chosen[i] = scores[i] < last
        if chosen[i]:
            count += 1
            total += scores[i]
    for i in range(len(scores)):
        if count < size and scores[i] == last:
            chosen[i] = True
            count += 1
            total += last
    return total


@numba.njit(cache=True, fastmath=IN_ANY_ORDER)
def choose(family: Any, target: int, shares: Any, slopes: Any, work: Any) -> Any:
    """The set that slopes choose: what it costs at these slopes, and its value less its shares; ``work`` of ``room``:
    scores (F,), some of them in another order (F,), the set (F,), its information (3,).
    """
    scores, ordered, chosen, matrix = work
    information, start, n_robots = family.information[target], family.start[target], len(scores)
    x, y, z = slopes[0], slopes[1], slopes[2]
    for i in range(n_robots):
        scores[i] = x * information[0, i] + y * information[1, i] + z * information[2, i] - shares[i]
        ordered[i] = scores[i]
    last, count = move_least_first(ordered, family.size) if family.size > 0 else -np.inf, 0
    a, b, c, paid, cost = start[0], start[1], start[2], 0.0, 0.0
    for i in range(n_robots):
        is_in = scores[i] < last
        chosen[i] = is_in
        count += 1 if is_in else 0
        a += information[0, i] if is_in else 0.0
        b += information[1, i] if is_in else 0.0
        c += information[2, i] if is_in else 0.0
        paid += shares[i] if is_in else 0.0
        cost += scores[i] if is_in else 0.0
    for i in range(n_robots):
        if count < family.size and scores[i] == last:  # of equals the first
            chosen[i], count = True, count + 1
            a, b, c = a + information[0, i], b + information[1, i], c + information[2, i]
            paid, cost = paid + shares[i], cost + last
    matrix[0], matrix[1], matrix[2] = a, b, c
    cost += x * start[0] + y * start[1] + z * start[2]
    return cost, target_value(family.code, family.weights[target], family.prior[target], (a, b, c)) - paid


@numba.njit(cache=True)
def room(n_robots: int) -> Any:
    """Arrays for :func:`choose` to work with."""
    return np.empty(n_robots), np.empty(n_robots), np.zeros(n_robots, dtype=np.bool_), np.empty(3)


@numba.njit(cache=True)
def _improve(family: Any, ascent: Any, values: Any, sets: Any) -> None:
    """Improve every choice from its slopes: values less shares (M, K), and the sets (M, K, F)."""
    n_targets, n_choices, n_robots = sets.shape
    work = room(n_robots)
    for j in range(n_targets):
        for k in range(n_choices):
            slopes, values[j, k] = ascent.slopes[j, k], np.inf
            for _ in range(IMPROVED):
                _, value = choose(family, j, ascent.shares[j], slopes, work)
                if not value < values[j, k]:
                    break
                values[j, k] = value
                sets[j, k] = work[2]
                matrix = work[3][0], work[3][1], work[3][2]
                slopes[0], slopes[1], slopes[2] = target_gradient(family.code, family.weights[j], matrix)


@numba.njit(cache=True)
def _soften(scores: Any, size: int, temperature: float, fraction: Any) -> None:
    """Fractions (F,) that add up to the size, near 1 where scores are small."""
    low, _ = soft_level(scores, size, temperature, (scores.min(), scores.max()), HALVINGS)
    for i in range(len(scores)):
        fraction[i] = 1 / (1 + np.exp((scores[i] - low) / temperature))


@numba.njit(cache=True)
def _add_direction(values: Any, sets: Any, temperature: float, fraction: Any, direction: Any) -> Any:
    """Turn ``direction`` (M, F) to where choices of the whole and of the targets differ; squared lengths of both."""
    n_targets, n_choices, n_robots = sets.shape
    length, fresh = 0.0, 0.0
    weights = np.empty(n_choices)
    for j in range(n_targets):
        least = values[j].min()
        for k in range(n_choices):
            weights[k] = np.exp((least - values[j, k]) / temperature)
        total = weights.sum()
        for i in range(n_robots):
            rise = fraction[i]
            for k in range(n_choices):
                if sets[j, k, i]:
                    rise -= weights[k] / total
            direction[j, i] = KEPT * direction[j, i] + (1 - KEPT) * rise
            length += direction[j, i] ** 2
            fresh += rise * rise
    return length, fresh


@numba.njit(cache=True)
def ascend(family: Any, ascent: Any, steps: int, goal: float, first: float) -> float:
    """Raise what is left by subgradients with steps of Polyak's kind; ends where it reaches the goal.

    ``first`` : how much more than the best so far steps aim at in the beginning

    Returns what the local choices say at the best shares, which ``ascent`` has at the end.
    """
    n_targets, n_robots = ascent.shares.shape
    values = np.empty(ascent.slopes.shape[:2])
    sets = np.zeros((*ascent.slopes.shape[:2], n_robots), dtype=np.bool_)
    shares, multiplier = ascent.shares.copy(), ascent.multiplier[0]
    unit = 1 / np.sqrt((family.lacking**2).mean() + 1e-300) if family.lacking.any() else 0.0
    best, aim, stalled, turn = -np.inf, first, 0, 0.0
    direction, chosen, fraction = np.zeros((n_targets, n_robots)), np.zeros(n_robots, dtype=np.bool_), ascent.fraction
    for _ in range(steps):
        _improve(family, ascent, values, sets)
        scores = ascent.multiplier[0] * family.lacking
        for j in range(n_targets):
            scores += ascent.shares[j]
        bound = pick(scores, family.size, chosen)
        for j in range(n_targets):
            bound += values[j].min()
        stalled = 0 if bound > best + PROGRESS * aim else stalled + 1
        if bound > best:
            best, multiplier = bound, ascent.multiplier[0]
            shares[:] = ascent.shares
            if best >= goal:
                break
        if stalled >= STALLED:
            stalled, aim, turn = 0, NEARER * aim, 0.0
            direction[:] = 0.0
            ascent.shares[:] = shares
            ascent.multiplier[0] = multiplier
        _soften(scores, family.size, SOFT * aim, fraction)
        lack = unit * (fraction * family.lacking).sum()
        length, fresh = _add_direction(values, sets, SOFT * aim, fraction, direction)
        turn = KEPT * turn + (1 - KEPT) * lack
        length, fresh = length + turn * turn, fresh + lack * lack
        step = min((best + aim - bound) / max(length, 1e-300), FURTHEST * aim / max(fresh, 1e-300))
        for j in range(n_targets):
            ascent.shares[j] += step * direction[j]
        ascent.multiplier[0] = max(ascent.multiplier[0] + step * turn * unit, 0.0)
    ascent.shares[:] = shares
    ascent.multiplier[0] = multiplier
    return float(best)
