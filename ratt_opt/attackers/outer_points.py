"""Polytopes that contain the information of every set of robots of one size, by their vertices.

For sets ``R`` of ``r`` of the free robots ``Lambda_j(R)`` lies in every half-space
``<g, Lambda> >= (sum of the r smallest <g, I_e>)``. Directions ``g = v v'`` keep the polytope among the positive
definite matrices. Per target a few "heavy" robots are enumerated: one polytope of the light ones for each pattern.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.compact import LOG_DET, TRACE
from ratt_opt.attackers.compiled import cut_polytopes

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["OuterPoints", "SetFamily", "outer_points", "target_values"]

SPHERE_DIRECTIONS = 10
RANK_ONE_DIRECTIONS = 12
CAPACITY = 128
"""Vertices kept per polytope: 28 half-spaces have at most 52, the rest is for repeated points."""

SAFETY = 1e-9
"""Relative amount by which every half-space is widened against rounding; distinct per row, so no two meet."""


@dataclass(frozen=True, slots=True)
class SetFamily:
    """All ``R`` of ``size`` of F free robots, beside those already chosen.

    ``kind`` : TRACE or LOG_DET; ``weights`` : (M,); ``prior`` : (M, 3) criterion's zero; ``start`` : (M, 3)
    prior plus the chosen robots' information; ``information`` : (F, M, 3)
    """

    kind: int
    weights: FloatArray
    prior: FloatArray
    start: FloatArray
    information: FloatArray
    size: int


def target_values(family: SetFamily, matrices: FloatArray) -> FloatArray:
    """Value of each target's information (..., M, 3) -> (..., M); minus infinity where it is not positive definite."""
    a, b, c = matrices[..., 0], matrices[..., 1], matrices[..., 2]
    determinant = a * c - b * b
    safe = (determinant > 1e-12 * (a + c) ** 2) & (a + c > 0)
    determinant = np.where(safe, determinant, 1.0)
    prior = family.prior
    zero = prior[:, 0] * prior[:, 2] - prior[:, 1] ** 2
    if family.kind == TRACE:
        value = (prior[:, 0] + prior[:, 2]) / zero - (a + c) / determinant
    else:
        assert family.kind == LOG_DET
        value = np.log(determinant / zero)
    return np.where(safe, family.weights * value, -np.inf)


@dataclass(frozen=True, slots=True)
class OuterPoints:
    """Vertices of all outer polytopes; ``sound[j]`` says that target ``j``'s are all positive definite.

    ``target``, ``pattern`` : (V,); ``sums`` : (V, 3) information of the set; ``values`` : (V,);
    ``heavy`` : (M, h) robots enumerated for each target; ``patterns`` : (P, h) which of them are in the set
    """

    target: IntArray
    pattern: IntArray
    sums: FloatArray
    values: FloatArray
    sound: BoolArray
    heavy: IntArray
    patterns: IntArray


def outer_points(family: SetFamily, n_heavy: int, normals: FloatArray) -> OuterPoints:
    """Vertices of the outer polytopes of a family, with ``n_heavy`` robots per target enumerated.

    ``normals`` : (M, A, 3) further half-space normals, as slopes in (a, b, c); zero rows are idle; A <= 36
    """
    gains = target_values(family, family.start[None] + family.information)
    n_heavy = min(n_heavy, family.size, len(gains) - family.size)
    heavy = np.argsort(-gains, axis=0, kind="stable")[:n_heavy].T
    light = np.ones(gains.shape, dtype=np.bool_)
    np.put_along_axis(light, heavy.T, False, axis=0)
    patterns = np.arange(2**n_heavy)[:, None] >> np.arange(n_heavy) & 1
    return _cut_out(family, heavy, light, patterns, normals)


def _cut_out(
    family: SetFamily, heavy: IntArray, light: BoolArray, patterns: IntArray, further: FloatArray
) -> OuterPoints:
    n_free, n_targets, _ = family.information.shape
    factor = _whitening(family, light)
    white = np.linalg.solve(factor, family.information.transpose(1, 2, 0))  # (M, 3, F)
    normals = _directions(factor, further)
    heights = np.where(light.T[:, None, :], normals @ white, np.inf)
    heights.sort(axis=-1)
    sums = np.concatenate([np.zeros((*heights.shape[:2], 1)), np.cumsum(heights, axis=-1)], axis=-1)
    counts = family.size - patterns.sum(axis=1)
    feasible = (counts >= 0) & (counts <= n_free - heavy.shape[1])
    kept, counts = patterns[feasible], counts[feasible]
    picked = np.take_along_axis(white, heavy[:, None, :], axis=2)  # (M, 3, h)
    base = picked @ kept.T  # (M, 3, P)
    support = sums[:, :, counts] + normals @ base  # (M, D, P)
    widen = SAFETY * (1 + np.arange(normals.shape[1]) / normals.shape[1])
    support -= widen[None, :, None] * (1 + np.abs(support))
    n_patterns = len(kept)
    vertices, numbers = cut_polytopes(
        np.repeat(normals, n_patterns, axis=0),
        np.ascontiguousarray(support.transpose(0, 2, 1)).reshape(n_targets * n_patterns, -1),
        CAPACITY,
    )
    owner, slot = np.nonzero(np.arange(CAPACITY) < numbers[:, None])
    target = owner // n_patterns
    points = np.einsum("vst,vt->vs", factor[target], vertices[owner, slot])
    values = _point_values(family, target, points)
    sound = (numbers.reshape(n_targets, n_patterns) > 0).all(axis=1)
    sound[target[np.isneginf(values)]] = False
    used = sound[target]
    which = np.flatnonzero(feasible)[owner % n_patterns]
    return OuterPoints(target[used], which[used], points[used], values[used], sound, heavy, patterns)


def _whitening(family: SetFamily, light: BoolArray) -> FloatArray:
    """(M, 3, 3) lower-triangular factors of the spread of the light robots' information about each target."""
    share = light / light.sum(axis=0)
    centred = family.information - np.einsum("fm,fmt->mt", share, family.information)
    spread = np.einsum("fm,fms,fmt->mst", share, centred, centred)
    size = np.trace(spread, axis1=1, axis2=2) + 1e-12 * (family.start**2).sum(axis=1)
    return np.asarray(np.linalg.cholesky(spread + 1e-8 * size[:, None, None] * np.eye(3)))


def _directions(factor: FloatArray, further: FloatArray) -> FloatArray:
    """(M, D, 3) normals in whitened coordinates: a box, a sphere's points, rank-one directions, further ones."""
    index = np.arange(SPHERE_DIRECTIONS) + 0.5
    height, turn = 1 - 2 * index / SPHERE_DIRECTIONS, np.pi * (1 + 5**0.5) * index
    flat = np.sqrt(1 - height**2)
    sphere = np.stack([np.cos(turn) * flat, np.sin(turn) * flat, height], axis=-1)
    angle = (np.arange(RANK_ONE_DIRECTIONS) + 0.5) * np.pi / RANK_ONE_DIRECTIONS
    rank_one = np.stack([np.cos(angle) ** 2, np.sin(2 * angle), np.sin(angle) ** 2], axis=-1) @ factor
    rank_one /= np.linalg.norm(rank_one, axis=-1, keepdims=True)
    fixed = np.concatenate([np.eye(3), -np.eye(3), sphere])
    given = further @ factor
    given /= np.maximum(np.linalg.norm(given, axis=-1, keepdims=True), 1e-300)
    return np.concatenate([np.broadcast_to(fixed, (len(factor), *fixed.shape)), rank_one, given], axis=1)


def _point_values(family: SetFamily, target: IntArray, points: FloatArray) -> FloatArray:
    one = SetFamily(
        family.kind, family.weights[target], family.prior[target], family.start[target], family.information, family.size
    )
    return target_values(one, one.start + points)
