"""Polytopes that contain the information of every set of robots of one size, by their vertices.

For sets ``R`` of ``r`` of the free robots ``Lambda_j(R)`` lies in every half-space
``<g, Lambda> >= (sum of the r smallest <g, I_e>)``. Directions ``g = v v'`` keep the polytope among the positive
definite matrices. Per target a few "heavy" robots are enumerated: one polytope of the light ones for each pattern.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import target_value

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attackers.weakest_set.packed_team import SetFamily

__all__ = ["OuterPolytopes", "cut_polytopes", "matrix_values", "outer_polytopes", "target_values", "vertex_values"]


@numba.njit(cache=True)
def _cut(plane: Any, row: int, vertices: Any, n: int) -> int:
    """Replace ``points[:n]`` by the vertices on or above the plane and those on it; returns their number.

    Loops rather than array expressions: the arrays are tiny, and most of the time was spent on making them.

    ``plane`` : normal (3,), offset; ``row`` : number of the plane among the facets; ``vertices`` : points (C, 3), the
    bits of their facets (C,), and scratch: slack (C,), lost points (C, 4), their facets
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

    ``normals`` : (M, D, 3), D <= 64; ``offsets`` : (M, P, D); ``factors`` : (M, 3, 3)

    Returns (V, 3) vertices, polytope by polytope; (V,) bits of the rows they lie on; (M, P) their numbers, 0 where the
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


SPHERE, RANK_ONE = 10, 8
"""Directions of half-spaces beside the box: spread evenly where a family has no parent, and along lines of sight. Each
tightens a polytope and adds vertices to it; all of them, a parent's and the box have to fit the 64 bits of a row set.
With four instead of ten at 40 robots: a tenth fewer nodes for trace, a tenth more for log-det, the same time."""
CAPACITY = 160
"""Vertices kept per polytope: with up to 64 half-spaces, rarely more than 100."""
SAFETY = 1e-9
"""Relative amount by which every half-space is widened against rounding; distinct per row, so no two meet."""


def target_values(family: SetFamily, matrices: FloatArray) -> FloatArray:
    """Value of each target's information (..., M, 3) -> (..., M); minus infinity where it is not positive definite."""
    team = family.team
    flat = np.ascontiguousarray(matrices).reshape(-1, *matrices.shape[-2:])
    return np.asarray(matrix_values(team.code, team.weights, team.prior, flat).reshape(matrices.shape[:-1]))


@dataclass(frozen=True, slots=True)
class OuterPolytopes:
    """Vertices of all outer polytopes, target by target; ``sound[j]`` says that ``j``'s are all positive definite.

    ``first`` : (M + 1,) target ``j`` owns vertices ``first[j]:first[j + 1]``, none unless sound;
    ``pattern``, ``values`` : (V,); ``light`` : (V, 3) information of the set's light robots;
    ``rows`` : (V,) bits of the half-spaces a vertex bounds; ``normals`` : (M, D, 3) of these, as slopes in (a, b, c);
    ``heavy`` : (M, h) robots enumerated for each target; ``patterns`` : (P, h) which of them are in the set;
    ``base`` : (M, P, 3) their information
    """

    first: IntArray
    pattern: IntArray
    values: FloatArray
    light: FloatArray
    rows: IntArray
    normals: FloatArray
    sound: BoolArray
    heavy: IntArray
    patterns: IntArray
    base: FloatArray


def outer_polytopes(family: SetFamily, n_heavy: int, further: FloatArray | None = None) -> OuterPolytopes:
    """Vertices of the outer polytopes of a family, with ``n_heavy`` robots per target enumerated.

    ``further`` : (M, A, 3) half-space normals, as slopes in (a, b, c), beside a box and ``RANK_ONE`` directions;
    zero rows are idle; A <= 50. By default some are spread evenly.
    """
    gains = target_values(family, family.start[None] + family.information)
    n_heavy = min(n_heavy, family.size, len(gains) - family.size)
    heavy = np.argsort(-gains, axis=0, kind="stable")[:n_heavy].T
    light = np.ones(gains.shape, dtype=np.bool_)
    np.put_along_axis(light, heavy.T, False, axis=0)
    patterns = np.arange(2**n_heavy)[:, None] >> np.arange(n_heavy) & 1
    return _cut_out(family, heavy, light, patterns, further)


def _cut_out(
    family: SetFamily, heavy: IntArray, light: BoolArray, patterns: IntArray, further: FloatArray | None
) -> OuterPolytopes:
    n_free = len(family.information)
    by_target = family.information.transpose(1, 0, 2)
    factor = _whitening(family, light)
    white = _directions(factor, further)
    normals = white @ np.linalg.inv(factor)
    heights = normals @ by_target.transpose(0, 2, 1)  # (M, D, F)
    heights[np.broadcast_to(~light.T[:, None, :], heights.shape)] = np.inf
    heights.sort(axis=-1)
    sums = np.concatenate([np.zeros((*heights.shape[:2], 1)), np.cumsum(heights, axis=-1)], axis=-1)
    counts = family.size - patterns.sum(axis=1)
    possible = np.flatnonzero((counts >= 0) & (counts <= n_free - heavy.shape[1]))
    support = sums[:, :, counts[possible]].transpose(0, 2, 1)  # (M, P, D)
    widen = SAFETY * (1 + np.arange(normals.shape[1]) / normals.shape[1])
    support = np.ascontiguousarray(support - widen * (1 + np.abs(support)))
    points, rows, numbers = cut_polytopes(white, support, factor, CAPACITY)
    base = patterns @ np.take_along_axis(by_target, heavy[..., None], axis=1)  # (M, P, 3)
    starts = family.start[:, None] + base[:, possible]
    team = family.team
    values = vertex_values(team.code, team.weights, team.prior, starts, (points, numbers))
    last = np.cumsum(numbers.sum(axis=1))
    first = np.concatenate([[0], last])
    pattern = np.repeat(np.tile(possible, len(heavy)), numbers.ravel())
    sound = (numbers > 0).all(axis=1)
    sound[np.searchsorted(last, np.flatnonzero(np.isneginf(values)), side="right")] = False
    if not sound.all():
        used = np.repeat(sound, np.diff(first))
        points, rows, pattern, values = points[used], rows[used], pattern[used], values[used]
        first = np.concatenate([[0], np.cumsum(np.diff(first) * sound)])
    return OuterPolytopes(first, pattern, values, points, rows, normals, sound, heavy, patterns, base)


def _whitening(family: SetFamily, light: BoolArray) -> FloatArray:
    """(M, 3, 3) lower-triangular factors of the spread of the light robots' information about each target."""
    share = light / light.sum(axis=0)
    centred = family.information - np.einsum("fm,fmt->mt", share, family.information)
    spread = np.einsum("fm,fms,fmt->mst", share, centred, centred)
    size = np.trace(spread, axis1=1, axis2=2) + 1e-12 * (family.start**2).sum(axis=1)
    return np.asarray(np.linalg.cholesky(spread + 1e-8 * size[:, None, None] * np.eye(3)))


def _directions(factor: FloatArray, further: FloatArray | None) -> FloatArray:
    """(M, D, 3) normals in whitened coordinates: a box, rank-one directions, further ones."""
    box = np.broadcast_to(np.concatenate([np.eye(3), -np.eye(3)]), (len(factor), 6, 3))
    angle = (np.arange(RANK_ONE) + 0.5) * np.pi / RANK_ONE
    rank_one = np.stack([np.cos(angle) ** 2, np.sin(2 * angle), np.sin(angle) ** 2], axis=-1) @ factor
    given = np.broadcast_to(_sphere(), (len(factor), SPHERE, 3)) if further is None else further @ factor
    others = np.concatenate([rank_one, given], axis=1)
    others /= np.maximum(np.linalg.norm(others, axis=-1, keepdims=True), 1e-300)
    return np.concatenate([box, others], axis=1)


def _sphere() -> FloatArray:
    """(SPHERE, 3) unit vectors."""
    index = np.arange(SPHERE) + 0.5
    height, turn = 1 - 2 * index / SPHERE, np.pi * (1 + 5**0.5) * index
    flat = np.sqrt(1 - height**2)
    return np.stack([np.cos(turn) * flat, np.sin(turn) * flat, height], axis=-1)
