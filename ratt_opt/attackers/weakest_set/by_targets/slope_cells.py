"""What a target's best choice of robots is worth at least, proved by cells of slopes: compiled.

The value ``phi`` of a target is concave in its information matrix, so for slopes ``C`` and every positive definite
``X``, ``q(C) = max over M of [phi(M) - <C, M>] >= phi(X) - <C, X>``, and ``phi(L) = min over C of [<C, L> + q(C)]``,
where the gradient at ``L`` is a minimiser. What choices ``S`` of ``size`` robots are worth at least, less their shares,

    min over S of [phi(L(S)) - share(S)] = min over C of [q(C) + h(C)],    h(C) = min over S of [<C, L(S)> - share(S)],

where ``h`` is concave, a sum of smallest terms. In a simplex of slopes with corners ``C_v`` the right side is therefore
at least the least ``phi(X) - <C_v, X> + h(C_v)`` over the corners, for any ``X``. Simplices that may contain a gradient
are divided, the one of the least bound first, by the best ``X`` (``cell_bound.py``): where all corners choose the same
set, it is that set's information, and the bound is exact.

Slopes are measured in coordinates in which the mean information is the unit matrix. Gradients there have eigenvalues
between ``low`` and ``high``: by the strongest choice of all, and by what is chosen already.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from typing import Any

import numpy as np

from ratt_opt.attackers.weakest_set.by_targets.cell_bound import (
    ROUNDING,
    Corners,
    as_gradient,
    bound_again,
    cell_bound,
    clipped_middle,
)
from ratt_opt.attackers.weakest_set.by_targets.slope_meshes import HEAVY, begin, keep, resume
from ratt_opt.attackers.weakest_set.by_targets.target_choices import IN_ANY_ORDER, Family, choose, room
from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import LOG_DET, target_gradient

__all__ = ["least_choice"]

RADIAL = 3.0
"""Quotient of the traces of two corners beyond which a simplex is divided between them."""
LEAST = 0.01
"""What the product of two corners' weights counts more than it is, where the edge between them is measured."""
MARGIN = 1e-7
"""Relative margin of the eigenvalues that gradients may have."""
SHARE = 0.5
"""Share of the mean from which a robot's choices are searched apart."""
SOUND = 1e-7
"""Quotient of the eigenvalues of what is chosen already, in the coordinates, below which nothing is claimed."""


@numba.njit(cache=True)
def _axes(matrix: Any) -> Any:
    """Inverse of the lower-triangular factor of a positive definite triple: its entries (1, 1), (2, 1), (2, 2)."""
    first = np.sqrt(matrix[0])
    below = matrix[1] / first
    second = np.sqrt(max(matrix[2] - below * below, 1e-300))
    return 1 / first, -below / (first * second), 1 / second


@numba.njit(cache=True)
def _whitened(axes: Any, matrix: Any) -> Any:
    """Information in the coordinates."""
    p, r, s = axes
    a, b, c = matrix
    return p * p * a, p * (r * a + s * b), r * r * a + 2 * r * s * b + s * s * c


@numba.njit(cache=True)
def _range(family: Any, target: int, axes: Any, mean: Any) -> Any:
    """Eigenvalues of gradients in the coordinates, at least and at most; -1 where rounding forbids to say."""
    information, start = family.information[target], family.start[target]
    traces = np.empty(information.shape[1])
    a, b, c = _whitened(axes, (start[0], start[1], start[2]))
    for i in range(len(traces)):
        x, _, z = _whitened(axes, (information[0, i], information[1, i], information[2, i]))
        traces[i] = x + z
    strongest = a + c + np.sort(traces)[len(traces) - family.size :].sum()
    larger = (a + c) / 2 + np.sqrt(((a - c) / 2) ** 2 + b * b)
    smaller = (a * c - b * b) / larger
    weight = family.weights[target]
    if not (weight > 0 and smaller > SOUND * strongest):
        return -1.0, -1.0
    # The logarithm's gradient L^-1 is the inverse in any coordinates.
    if family.code == LOG_DET:
        return weight / strongest * (1 - MARGIN), weight / smaller * (1 + MARGIN)
    # With L = R W R', L^-2 is in the coordinates W^-1 (R'R)^-1 W^-1, and (R'R)^-1 has the mean's inverse eigenvalues.
    trace, determinant = mean[0] + mean[2], mean[0] * mean[2] - mean[1] * mean[1]
    low, high = 1 / trace, trace / determinant
    return weight * low / strongest**2 * (1 - MARGIN), weight * high / smaller**2 * (1 + MARGIN)


@numba.njit(cache=True)
def _difference(points: Any, one: int, two: int) -> Any:
    return points[one, 0] - points[two, 0], points[one, 1] - points[two, 1], points[one, 2] - points[two, 2]


@numba.njit(cache=True)
def _longest_edge(corners: Any, cell: Any, middle: Any, weights: Any) -> Any:
    """The two corners of a cell between which it is divided: far apart in size, or from the middle's point of view.

    What a bound misses between two corners grows with the product of their weights (4,).
    """
    a, b, c = middle
    determinant = a * c - b * b
    p, q, r = 1.0, 0.0, 1.0
    if determinant > 0:  # not where rounding hides the smaller eigenvalue
        p, q, r = c / determinant, -b / determinant, a / determinant
    small, large, ends, longest = np.inf, -np.inf, (0, 0), -1.0
    x0, x1 = 0, 0
    for x in range(4):
        trace = corners.white[cell[x], 0] + corners.white[cell[x], 2]
        if trace < small:
            small, x0 = trace, x
        if trace > large:
            large, x1 = trace, x
        for y in range(x):
            d, e, f = _difference(corners.white, cell[x], cell[y])
            first, second, third, fourth = p * d + q * e, p * e + q * f, q * d + r * e, q * e + r * f
            length = (first * first + 2 * second * third + fourth * fourth) * (weights[x] * weights[y] + LEAST)
            if length > longest:
                longest, ends = length, (x, y)
    return (x0, x1) if large > RADIAL * small else ends


@numba.njit(cache=True, fastmath=IN_ANY_ORDER)
def _add_corner(  # noqa: PLR0917
    family: Any, shares: Any, corners: Any, k: int, axes: Any, work: Any, best: float, slopes: Any
) -> float:
    """Fill slopes and height of a corner; the set chosen there is worth what is returned, less its shares.

    ``slopes`` : becomes the gradient at that set where it is worth less than ``best``
    """
    a, b, c = as_gradient(axes, (corners.white[k, 0], corners.white[k, 1], corners.white[k, 2]))
    corners.slopes[k, 0], corners.slopes[k, 1], corners.slopes[k, 2] = a, 2 * b, c
    corners.heights[k], value = choose(family, 0, shares, corners.slopes[k], work)
    size = 0.0
    for score in work[0]:
        size += abs(score)
    # Sums of F terms: the height is rounded.
    corners.heights[k] -= ROUNDING * size
    if value < best:
        matrix = work[3][0], work[3][1], work[3][2]
        slopes[0], slopes[1], slopes[2] = target_gradient(family.code, family.weights[0], matrix)
    return float(value)


@numba.njit(cache=True)
def _setting(family: Any, meshes: Any, slot: int, most: int) -> Any:
    """Axes of the coordinates, and the eigenvalues of gradients there, at least (-1: cannot be said) and at most.

    A slot keeps its cells if they contain all these gradients, and are few enough to be divided.
    """
    mean = meshes.mean[slot]
    if 0 < meshes.n_corners[slot] <= most:
        axes = _axes(mean)
        low, high = _range(family, 0, axes, mean)
        if low >= 0 and high <= meshes.high[slot]:
            return axes, low, high
    meshes.n_corners[slot] = 0
    mean[:] = family.start[0]
    n_robots = family.information.shape[2]
    for i in range(n_robots):
        mean += family.information[0, :, i] * (family.size / n_robots)
    axes = _axes(mean)
    low, high = _range(family, 0, axes, mean)
    meshes.high[slot] = high
    return axes, low, high


@numba.njit(cache=True)
def _search_cells(  # noqa: PLR0917
    family: Any, shares: Any, slopes: Any, known: float, effort: Any, meshes: Any, slot: int
) -> Any:
    """:func:`least_choice` of the only target of a family, where it is at most ``known``; with the cells of a slot."""
    (tolerance, most), best = effort, known
    work = room(len(shares))
    axes, low, high = _setting(family, meshes, slot, most)
    if low < 0:
        return -np.inf, best
    corners = Corners(np.empty((most + 4, 3)), np.empty((most + 4, 3)), np.empty(most + 4))
    cells, weights = np.empty((most + 4, 4), dtype=np.int64), np.empty((most + 4, 4))
    n_corners = resume(meshes, slot, corners, cells, weights)
    is_known = n_corners > 0
    if not is_known:
        n_corners = begin(high, corners, cells)
    for k in range(n_corners):
        best = min(best, _add_corner(family, shares, corners, k, axes, work, best, slopes))
    waiting = [(-np.inf, 0)]
    waiting.pop()
    for k in range(n_corners - 3):
        enough = best - tolerance
        if is_known:
            bound = bound_again(family, corners, cells[k], (axes, low), weights[k], enough)
        else:
            bound = cell_bound(family, corners, cells[k], (axes, low), weights[k], enough)
        if bound < np.inf:
            waiting.append((bound, k))
    heapify(waiting)
    while n_corners < most + 4 and len(waiting) > 0 and waiting[0][0] < best - tolerance:
        bound, one = heappop(waiting)
        cell, other = cells[one], n_corners - 3
        middle, _, _ = clipped_middle(corners, cell, low)
        x, y = _longest_edge(corners, cell, middle, weights[one])
        corners.white[n_corners] = (corners.white[cell[x]] + corners.white[cell[y]]) / 2
        best = min(best, _add_corner(family, shares, corners, n_corners, axes, work, best, slopes))
        cells[other] = cell
        cells[other, x] = n_corners
        cells[one, y] = n_corners
        n_corners += 1
        for child in (one, other):
            mine = cell_bound(family, corners, cells[child], (axes, low), weights[child], best - tolerance)
            if mine < np.inf:
                heappush(waiting, (max(bound, mine), child))
    keep(meshes, slot, n_corners, corners, cells, weights)
    least = waiting[0][0] if len(waiting) > 0 else best
    return min(least, best), best


@numba.njit(cache=True)
def _heavy(family: Any, target: int) -> Any:
    """Robots without which the mean information of the others is much smaller, (h,), and all others (F - h,)."""
    information = family.information[target]
    n_robots, is_light = information.shape[1], np.ones(information.shape[1], dtype=np.bool_)
    for _ in range(min(HEAVY, family.size, n_robots - family.size)):
        part = family.size / is_light.sum()
        mean = family.start[target].copy()
        for i in range(n_robots):
            if is_light[i]:
                mean += information[:, i] * part
        axes, heaviest, most = _axes(mean), -1, -np.inf
        for i in range(n_robots):
            x, _, z = _whitened(axes, (information[0, i], information[1, i], information[2, i]))
            if is_light[i] and x + z > most:
                heaviest, most = i, x + z
        if most * part < SHARE:
            break
        is_light[heaviest] = False
    return np.flatnonzero(~is_light), np.flatnonzero(is_light)


@numba.njit(cache=True)
def least_choice(family: Any, target: int, shares: Any, slopes: Any, effort: Any, meshes: Any) -> Any:  # noqa: PLR0917
    """What choices (``target_choices.py``) of a target are worth at least, less their shares (F,); the least one met.

    Minus infinity where rounding forbids to say. ``slopes`` (3,) : those of a good choice, replaced by a better one's;
    ``effort`` : the tolerance between the bound and the least, from which no cell is divided, and the most corners of
    each search; ``meshes`` : cells to begin with, and those of the end
    """
    n_robots = len(shares)
    work = room(n_robots)
    _, best = choose(family, target, shares, slopes, work)
    heavy, light = _heavy(family, target)
    information, lighter = family.information[target], np.empty((1, 3, len(light)))
    lighter[0] = information[:, light]
    one, least = slice(target, target + 1), np.inf
    for pattern in range(2 ** len(heavy)):
        start, paid, size = family.start[one].copy(), 0.0, family.size
        for t in range(len(heavy)):
            if pattern >> t & 1:
                start[0] += information[:, heavy[t]]
                paid += shares[heavy[t]]
                size -= 1
        part = Family(family.code, family.weights[one], family.prior[one], start, lighter, family.lacking[light], size)
        slot = target * 2**HEAVY + pattern
        bound, found = _search_cells(part, shares[light], slopes, best + paid, effort, meshes, slot)
        least, best = min(least, bound - paid), min(best, found - paid)
    return least, best
