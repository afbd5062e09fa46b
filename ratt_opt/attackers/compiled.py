"""Compiled loops of the large-team attacker (2 by 2 information matrices as ``(a, b, c)`` triples).

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
The plain versions these are tested against are in the tests.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

__all__ = ["FINISHED", "FOUND", "PAUSED", "SearchState", "criterion", "cut_polytopes", "search"]

FINISHED, PAUSED, FOUND = 0, 1, 2
"""Why :func:`search` returned: all sets decided, node limit, or a set below the threshold."""


@numba.njit(cache=True)
def criterion(kind: int, weights: Any, matrices: Any) -> float:
    """Weighted criterion over all targets, lower is better: (M,), (M, 3) -> scalar."""
    total, product = 0.0, 1.0
    for j in range(matrices.shape[0]):
        a, b, c = matrices[j, 0], matrices[j, 1], matrices[j, 2]
        determinant = a * c - b * b
        if kind == 0:
            total += weights[j] * (a + c) / determinant
        elif kind == 1 and weights[j] == weights[0]:
            product *= determinant  # one logarithm for many targets
            if product > 1e150 or product < 1e-150:
                total -= weights[0] * np.log(product)
                product = 1.0
        elif kind == 1:
            total -= weights[j] * np.log(determinant)
        else:
            half = (a - c) / 2
            worst = weights[j] * ((a + c) / 2 + np.sqrt(half * half + b * b)) / determinant
            total = max(total, worst)
    return total if kind != 1 else total - weights[0] * np.log(product)


class SearchState:
    """Where a depth-first search over sets of ``size`` of some robots stands; it can be resumed.

    ``position`` : (size + 1,) next robot to try at each depth; the chosen ones are ``position[:depth] - 1``
    """

    __slots__ = ("counters", "linear", "position", "sums")

    def __init__(self, start: Any, size: int) -> None:
        self.position = np.zeros(size + 1, dtype=np.int64)
        self.sums = np.zeros((size + 1, *start.shape))
        self.sums[0] = start
        self.linear = np.zeros(size + 1)
        self.counters = np.zeros(2, dtype=np.int64)  # depth, nodes


@numba.njit(cache=True)
def _averaged(kind: int, weights: Any, sums: Any, information: Any, left: int) -> float:
    """No ``left`` of the robots bring the criterion above this: (M,), (M, 3), (F, M, 3) -> scalar.

    ``sums`` plus the information of robots ``T`` is the average over ``i`` in ``T`` of ``sums + |T| information[i]``,
    and the criterion is convex: it is at most the average there, so at most that of the ``|T|`` largest.
    """
    n_robots, n_targets = information.shape[0], information.shape[1]
    one, worth = np.empty((n_targets, 3)), np.empty(n_robots)
    for i in range(n_robots):
        for j in range(n_targets):
            for t in range(3):
                one[j, t] = sums[j, t] + left * information[i, j, t]
        worth[i] = criterion(kind, weights, one)
    return float(np.sort(worth)[n_robots - left :].mean())


@numba.njit(cache=True)
def search(  # noqa: PLR0917  (compiled code takes arrays, not records)
    kind: int,
    weights: Any,
    baseline: float,
    information: Any,
    scores: Any,
    smallest: Any,
    threshold: float,
    limit: int,
    position: Any,
    sums: Any,
    linear: Any,
    counters: Any,
) -> int:
    """Continue to the next set of ``size`` robots whose value is below ``threshold``.

    Robots are taken or left in the order given. A partial choice is left when the affine minorant ``linear +
    scores`` or the averaged bound (:func:`_averaged`) of every completion reaches the threshold.

    Parameters
    ----------
    information : (F, M, 3) of the robots to choose from
    scores : (F,) affine minorant: value of a set >= linear[0] + sum of its scores
    smallest : (F + 1, size + 1) sum of the q smallest scores among robots p.. at [p, q]
    limit : nodes (partial choices looked at) before pausing, counted in ``counters[1]``
    """
    n_robots, n_targets = information.shape[0], information.shape[1]
    size = position.shape[0] - 1
    depth = counters[0]
    while depth >= 0:
        p = position[depth]
        left = size - depth
        if p > n_robots - left or linear[depth] + smallest[p, left] >= threshold:
            depth -= 1
            continue
        if counters[1] >= limit:
            counters[0] = depth
            return 1
        counters[1] += 1
        if baseline - _averaged(kind, weights, sums[depth], information[p:], left) >= threshold:
            depth -= 1
            continue
        position[depth] = p + 1
        bound = linear[depth] + scores[p]
        if bound + smallest[p + 1, left - 1] >= threshold:
            continue
        for j in range(n_targets):
            for t in range(3):
                sums[depth + 1, j, t] = sums[depth, j, t] + information[p, j, t]
        if left == 1:
            if baseline - criterion(kind, weights, sums[depth + 1]) >= threshold:
                continue
            counters[0] = depth
            return 2
        linear[depth + 1] = bound
        position[depth + 1] = p + 1
        depth += 1
    counters[0] = depth
    return 0


@numba.njit(cache=True)
def _cut(normal: Any, offset: float, row: Any, points: Any, facets: Any, n: int) -> int:  # noqa: PLR0917
    """Replace ``points[0, :n]`` by the vertices on or above the plane and those on it; returns their number."""
    capacity = points.shape[1]
    slack = points[0, :n] @ normal - offset
    if slack.min() >= 0:
        return n
    m = 0
    for i in range(n):
        if slack[i] >= 0:
            points[1, m] = points[0, i]
            facets[1, m] = facets[0, i]
            m += 1
    for i in range(n):
        if slack[i] >= 0:
            continue
        for q in range(n):
            shared = facets[0, i] & facets[0, q]
            if slack[q] < 0 or shared & (shared - np.uint64(1)) == 0:
                continue
            if m >= capacity:
                return -1
            ratio = slack[q] / (slack[q] - slack[i])
            points[1, m] = points[0, q] + ratio * (points[0, i] - points[0, q])
            facets[1, m] = shared | (np.uint64(1) << row)
            m += 1
    points[0, :m] = points[1, :m]
    facets[0, :m] = facets[1, :m]
    return m


@numba.njit(cache=True)
def cut_polytopes(normals: Any, offsets: Any, capacity: int) -> Any:
    """Vertices of many polytopes in three dimensions.

    Polytope ``k`` is ``{y : normals[k] y >= offsets[k]}``; its first six rows are the axes and their
    negatives (a box). Each further row cuts the vertices found so far: a new vertex lies on every
    segment between a kept and a lost vertex that share two facets. Segments that are not edges only
    add points of the polytope, which does no harm to an outer approximation.

    Parameters
    ----------
    normals : (K, D, 3), D <= 64
    offsets : (K, D)

    Returns
    -------
    (K, capacity, 3) vertices and (K,) their numbers, -1 where the capacity did not suffice
    """
    count, n_rows = normals.shape[0], normals.shape[1]
    vertices = np.zeros((count, capacity, 3))
    numbers = np.zeros(count, dtype=np.int64)
    points = np.zeros((2, capacity, 3))
    facets = np.zeros((2, capacity), dtype=np.uint64)
    for k in range(count):
        for i in range(8):
            facets[0, i] = 0
            for t in range(3):
                high = (i >> t) & 1
                points[0, i, t] = -offsets[k, 3 + t] if high else offsets[k, t]
                facets[0, i] |= np.uint64(1) << np.uint64(t + 3 * high)
        n = 8
        for row in range(6, n_rows):
            n = _cut(normals[k, row], offsets[k, row], np.uint64(row), points, facets, n)
            if n <= 0:
                break
        numbers[k] = n if n > 0 else -1
        for i in range(max(n, 0)):
            vertices[k, i] = points[0, i]
    return vertices, numbers
