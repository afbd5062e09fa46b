"""Polytopes that contain the information of every set of robots of one size, by their vertices.

For sets ``R`` of ``r`` of the free robots ``Lambda_j(R)`` lies in every half-space
``<g, Lambda> >= (sum of the r smallest <g, I_e>)``. Directions ``g = v v'`` keep the polytope among the positive
definite matrices. Per target a few "heavy" robots are enumerated: one polytope of the light ones for each pattern.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import address
from ratt_opt.native.loops import loops

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.least_sets.sets_of_size import SetFamily
    from ratt_opt.attack.params.least_sets import PolytopeParams

__all__ = ["OuterPolytopes", "outer_polytopes", "target_values"]


def target_values(family: SetFamily, matrices: FloatArray) -> FloatArray:
    """Value of each target's information (..., M, 3) -> (..., M); minus infinity if it is not positive definite."""
    targets = len(family.team.weights)
    by_target = matrices.reshape(-1, targets, 3).transpose(1, 0, 2)
    numbers = np.ones(by_target.shape[:2], dtype=np.int64)
    values = _vertex_values(family, by_target, np.zeros((numbers.size, 3)), numbers)
    return values.reshape(targets, -1).T.reshape(matrices.shape[:-1])


def _cut_polytopes(
    normals: FloatArray, offsets: FloatArray, factors: FloatArray, capacity: int
) -> tuple[FloatArray, NDArray[np.uint64], IntArray]:
    """Vertices of many polytopes in three dimensions.

    Polytope ``(j, p)`` is ``{factors[j] y : normals[j] y >= offsets[j, p]}``; its first six rows are a box.

    ``normals`` : (M, D, 3), D <= 64; ``offsets`` : (M, P, D); ``factors`` : (M, 3, 3)

    Returns (V, 3) vertices, polytope by polytope; (V,) bits of the rows they lie on; (M, P) their numbers, 0 if the
    capacity did not suffice
    """
    n_targets, n_patterns, n_rows = offsets.shape
    most = n_targets * n_patterns * capacity
    vertices, rows, numbers = (
        np.empty((most, 3)),
        np.empty(most, np.uint64),
        np.zeros((n_targets, n_patterns), np.int64),
    )
    normals, offsets, factors = map(np.ascontiguousarray, (normals, offsets, factors))
    given = address(normals), address(offsets), address(factors)
    found = address(vertices), address(rows), address(numbers)
    total = loops.cut_polytopes(n_targets, n_patterns, n_rows, capacity, *given, *found)
    return vertices[:total].copy(), rows[:total].copy(), numbers


def _vertex_values(family: SetFamily, starts: FloatArray, points: FloatArray, numbers: IntArray) -> FloatArray:
    """(V,) values of the information ``starts[j, p]`` (M, P, 3) plus each vertex of polytope ``(j, p)``."""
    starts, values = np.ascontiguousarray(starts), np.empty(len(points))
    given = address(starts), address(points), address(numbers)
    loops.vertex_values(family.team.record, starts.shape[1], *given, address(values))
    return values


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
    rows: NDArray[np.uint64]
    normals: FloatArray
    sound: BoolArray
    heavy: IntArray
    patterns: IntArray
    base: FloatArray


def outer_polytopes(family: SetFamily, n_heavy: int, further: FloatArray | None = None) -> OuterPolytopes:
    """Vertices of the outer polytopes of a family, with ``n_heavy`` robots per target enumerated.

    ``further`` : (M, A, 3) half-space normals, as slopes in (a, b, c), beside a box and lines of sight;
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
    white = _directions(factor, further, family.team.params.polytopes)
    normals = white @ np.linalg.inv(factor)
    heights = normals @ by_target.transpose(0, 2, 1)  # (M, D, F)
    heights[np.broadcast_to(~light.T[:, None, :], heights.shape)] = np.inf
    heights.sort(axis=-1)
    sums = np.concatenate([np.zeros((*heights.shape[:2], 1)), np.cumsum(heights, axis=-1)], axis=-1)
    counts = family.size - patterns.sum(axis=1)
    possible = np.flatnonzero((counts >= 0) & (counts <= n_free - heavy.shape[1]))
    support = sums[:, :, counts[possible]].transpose(0, 2, 1)  # (M, P, D)
    widen = family.team.params.polytopes.safety * (1 + np.arange(normals.shape[1]) / normals.shape[1])
    support = np.ascontiguousarray(support - widen * (1 + np.abs(support)))
    points, facets, numbers = _cut_polytopes(white, support, factor, family.team.params.polytopes.capacity)
    base = patterns @ np.take_along_axis(by_target, heavy[..., None], axis=1)  # (M, P, 3)
    starts = family.start[:, None] + base[:, possible]
    values = _vertex_values(family, starts, points, numbers)
    last = np.cumsum(numbers.sum(axis=1))
    first = np.concatenate([[0], last])
    pattern = np.repeat(np.tile(possible, len(heavy)), numbers.ravel())
    sound = np.asarray((numbers > 0).all(axis=1))
    sound[np.searchsorted(last, np.flatnonzero(np.isneginf(values)), side="right")] = False
    if not sound.all():
        used = np.repeat(sound, np.diff(first))
        points, facets, pattern, values = points[used], facets[used], pattern[used], values[used]
        first = np.concatenate([[0], np.cumsum(np.diff(first) * sound)])
    return OuterPolytopes(first, pattern, values, points, facets, normals, sound, heavy, patterns, base)


def _whitening(family: SetFamily, light: BoolArray) -> FloatArray:
    """(M, 3, 3) lower-triangular factors of the spread of the light robots' information about each target."""
    share = light / light.sum(axis=0)
    centred = family.information - np.einsum("fm,fmt->mt", share, family.information)
    spread = np.einsum("fm,fms,fmt->mst", share, centred, centred)
    size = np.trace(spread, axis1=1, axis2=2) + 1e-12 * (family.start**2).sum(axis=1)
    return np.asarray(np.linalg.cholesky(spread + 1e-8 * size[:, None, None] * np.eye(3)))


def _directions(factor: FloatArray, further: FloatArray | None, params: PolytopeParams) -> FloatArray:
    """(M, D, 3) normals in whitened coordinates: a box, rank-one directions, further ones."""
    box = np.broadcast_to(np.concatenate([np.eye(3), -np.eye(3)]), (len(factor), 6, 3))
    angle = (np.arange(params.sight) + 0.5) * np.pi / params.sight
    rank_one = np.stack([np.cos(angle) ** 2, np.sin(2 * angle), np.sin(angle) ** 2], axis=-1) @ factor
    given = (
        np.broadcast_to(_sphere(params.sphere), (len(factor), params.sphere, 3))
        if further is None
        else further @ factor
    )
    others = np.concatenate([rank_one, given], axis=1)
    others /= np.maximum(np.linalg.norm(others, axis=-1, keepdims=True), 1e-300)
    return np.concatenate([box, others], axis=1)


def _sphere(points: int) -> FloatArray:
    """(params.sphere, 3) unit vectors."""
    index = np.arange(points) + 0.5
    height, turn = 1 - 2 * index / points, np.pi * (1 + 5**0.5) * index
    flat = np.sqrt(1 - height**2)
    return np.stack([np.cos(turn) * flat, np.sin(turn) * flat, height], axis=-1)
