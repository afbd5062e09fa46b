"""Compiled loops of the large-team attacker (2 by 2 information matrices as ``(a, b, c)`` triples).

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
The plain versions these are tested against are in the tests.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

__all__ = [
    "FINISHED",
    "FOUND",
    "PAUSED",
    "SearchState",
    "criterion",
    "cut_polytopes",
    "matrix_values",
    "point_values",
    "row_weights",
    "search",
]

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
def _cut(  # noqa: PLR0917
    normal: Any, offset: float, row: int, points: Any, facets: Any, slack: Any, lost: Any, lost_facets: Any, n: int
) -> int:
    """Replace ``points[:n]`` by the vertices on or above the plane and those on it; returns their number.

    Loops rather than array expressions: the arrays are tiny, and most of the time was spent on making them.
    """
    least = np.inf
    for i in range(n):
        slack[i] = points[i, 0] * normal[0] + points[i, 1] * normal[1] + points[i, 2] * normal[2] - offset
        least = min(least, slack[i])
    if least >= 0:
        return n
    kept, gone = 0, 0
    for i in range(n):
        if slack[i] >= 0:
            slack[kept], facets[kept] = slack[i], facets[i]
            for t in range(3):
                points[kept, t] = points[i, t]
            kept += 1
        else:
            lost[gone, 3], lost_facets[gone] = slack[i], facets[i]
            for t in range(3):
                lost[gone, t] = points[i, t]
            gone += 1
    m, one = kept, np.uint64(1)
    for i in range(gone):
        for q in range(kept):
            shared = lost_facets[i] & facets[q]
            if shared & (shared - one) == 0:
                continue
            if m >= len(points):
                return -1
            ratio = slack[q] / (slack[q] - lost[i, 3])
            for t in range(3):
                points[m, t] = points[q, t] + ratio * (lost[i, t] - points[q, t])
            facets[m] = shared | (one << np.uint64(row))
            m += 1
    return m


@numba.njit(cache=True)
def cut_polytopes(normals: Any, offsets: Any, factors: Any, capacity: int) -> Any:
    """Vertices of many polytopes in three dimensions.

    Polytope ``(j, p)`` is ``{factors[j] y : normals[j] y >= offsets[j, p]}``; its first six rows are the axes and
    their negatives (a box). Each further row cuts the vertices found so far: a new vertex lies on every
    segment between a kept and a lost vertex that share two facets. Segments that are not edges only
    add points of the polytope, which does no harm to an outer approximation.

    Parameters
    ----------
    normals : (M, D, 3), D <= 64
    offsets : (M, P, D)
    factors : (M, 3, 3)

    Returns
    -------
    (V, 3) vertices, polytope by polytope; (V,) bits of the rows they lie on; (M, P) their numbers, 0 where the
    capacity did not suffice
    """
    n_targets, n_patterns, n_rows = offsets.shape
    vertices = np.empty((n_targets * n_patterns * capacity, 3))
    rows = np.empty(n_targets * n_patterns * capacity, dtype=np.uint64)
    numbers = np.zeros((n_targets, n_patterns), dtype=np.int64)
    points, lost, slack = np.zeros((capacity, 3)), np.zeros((capacity, 4)), np.zeros(capacity)
    facets, lost_facets = np.zeros(capacity, dtype=np.uint64), np.zeros(capacity, dtype=np.uint64)
    total = 0
    for j in range(n_targets):
        for p in range(n_patterns):
            for i in range(8):
                facets[i] = 0
                for t in range(3):
                    high = (i >> t) & 1
                    points[i, t] = -offsets[j, p, 3 + t] if high else offsets[j, p, t]
                    facets[i] |= np.uint64(1) << np.uint64(t + 3 * high)
            n = 8
            for row in range(6, n_rows):
                n = _cut(normals[j, row], offsets[j, p, row], row, points, facets, slack, lost, lost_facets, n)
                if n <= 0:
                    break
            numbers[j, p] = max(n, 0)
            for i in range(max(n, 0)):
                rows[total + i] = facets[i]
                for s in range(3):
                    vertices[total + i, s] = 0.0
                    for t in range(3):
                        vertices[total + i, s] += factors[j, s, t] * points[i, t]
            total += max(n, 0)
    return vertices[:total].copy(), rows[:total].copy(), numbers


@numba.njit(cache=True)
def _value(kind: int, weight: float, prior: Any, a: float, b: float, c: float) -> float:  # noqa: PLR0917
    """One target's value, trace or log-det, of ``[[a, b], [b, c]]``; minus infinity where not positive definite."""
    zero, determinant = prior[0] * prior[2] - prior[1] ** 2, a * c - b * b
    if not (determinant > 1e-12 * (a + c) ** 2 and a + c > 0):
        return -np.inf
    if kind == 0:
        return float(weight * ((prior[0] + prior[2]) / zero - (a + c) / determinant))
    return float(weight * np.log(determinant / zero))


@numba.njit(cache=True)
def matrix_values(kind: int, weights: Any, prior: Any, matrices: Any) -> Any:
    """Each target's value (:func:`_value`) of information matrices (K, M, 3) -> (K, M)."""
    values = np.empty(matrices.shape[:2])
    for k in range(matrices.shape[0]):
        for j in range(matrices.shape[1]):
            a, b, c = matrices[k, j, 0], matrices[k, j, 1], matrices[k, j, 2]
            values[k, j] = _value(kind, weights[j], prior[j], a, b, c)
    return values


@numba.njit(cache=True)
def point_values(kind: int, weights: Any, prior: Any, starts: Any, points: Any, numbers: Any) -> Any:  # noqa: PLR0917
    """The same of the information ``starts[j, p]`` plus each point (V, 3) of polytope ``(j, p)`` -> (V,)."""
    values = np.empty(len(points))
    v = 0
    for j in range(starts.shape[0]):
        for p in range(starts.shape[1]):
            for _ in range(numbers[j, p]):
                a, b, c = starts[j, p, 0] + points[v, 0], starts[j, p, 1] + points[v, 1], starts[j, p, 2] + points[v, 2]
                values[v] = _value(kind, weights[j], prior[j], a, b, c)
                v += 1
    return values


@numba.njit(cache=True)
def row_weights(first: Any, closeness: Any, rows: Any, n_rows: int) -> Any:
    """Sum of the points' ``closeness`` (V,) over each row that they lie on -> (M, n_rows)."""
    weights = np.zeros((len(first) - 1, n_rows))
    for j in range(len(first) - 1):
        for v in range(first[j], first[j + 1]):
            if closeness[v] > 0:
                for row in range(n_rows):
                    if rows[v] >> np.uint64(row) & np.uint64(1):
                        weights[j, row] += closeness[v]
    return weights
