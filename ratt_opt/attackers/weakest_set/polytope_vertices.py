"""Vertices of polytopes of 2 by 2 information matrices, as ``(a, b, c)`` triples, and their values; compiled.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

from ratt_opt.setfunctions.criteria.compiled import target_value

__all__ = ["cut_polytopes", "matrix_values", "vertex_values"]


@numba.njit(cache=True)
def _cut(plane: Any, row: int, vertices: Any, n: int) -> int:
    """Replace ``points[:n]`` by the vertices on or above the plane and those on it; returns their number.

    Loops rather than array expressions: the arrays are tiny, and most of the time was spent on making them.

    Parameters
    ----------
    plane : normal (3,), offset
    row : number of the plane among the facets
    vertices : points (C, 3), the bits of their facets (C,), and scratch: slack (C,), lost points (C, 4), their facets
    """
    normal, offset = plane
    points, facets, slack, lost, lost_facets = vertices
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
    scratch = points, facets, slack, lost, lost_facets
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
                n = _cut((normals[j, row], offsets[j, p, row]), row, scratch, n)
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
def matrix_values(code: int, weights: Any, prior: Any, matrices: Any) -> Any:
    """Each target's value of information matrices: (M,), (M, 3), (K, M, 3) -> (K, M)."""
    values = np.empty(matrices.shape[:2])
    for k in range(matrices.shape[0]):
        for j in range(matrices.shape[1]):
            matrix = matrices[k, j, 0], matrices[k, j, 1], matrices[k, j, 2]
            values[k, j] = target_value(code, weights[j], prior[j], matrix)
    return values


@numba.njit(cache=True)
def vertex_values(code: int, weights: Any, prior: Any, starts: Any, polytopes: Any) -> Any:
    """The same of the information ``starts[j, p]`` (M, P, 3) plus each vertex of polytope ``(j, p)`` -> (V,).

    ``polytopes`` : vertices (V, 3), polytope by polytope, and their numbers (M, P)
    """
    points, numbers = polytopes
    values = np.empty(len(points))
    v = 0
    for j in range(starts.shape[0]):
        for p in range(starts.shape[1]):
            for _ in range(numbers[j, p]):
                a, b, c = starts[j, p, 0] + points[v, 0], starts[j, p, 1] + points[v, 1], starts[j, p, 2] + points[v, 2]
                values[v] = target_value(code, weights[j], prior[j], (a, b, c))
                v += 1
    return values
