"""An affine minorant of the value of sets of robots of one size, from a linear program.

Target ``j``'s criterion is concave in its information matrix, and ``Lambda_j(R)`` lies in an outer polytope
(``outer_points.py``). An affine function of ``Lambda`` that is below the value ``phi_j`` at its vertices is below
it for every ``R``. The concavity of ``phi_j`` comes mostly from the few robots next to the target: these "heavy"
ones are enumerated and get scores of their own.

The best minorants at the weakest fractional set come from one linear program: its multipliers are the
minorant's slopes. Its columns (the vertices) are generated as they are needed. The minorant's constant is
recomputed here from all vertices, so nothing depends on the solver, nor on solving to the end.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.compact import TRACE
from ratt_opt.attackers.linear_program import EqualityProgram
from ratt_opt.attackers.outer_points import OuterPoints, SetFamily, outer_points, target_values

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["Minorant", "affine_minorant"]

FIRST_COLUMNS, NEW_COLUMNS = 5, 2
"""Vertices per polytope in the first linear program and added in each further round."""

CUTS = 12
"""Half-spaces per target that a node hands to its children."""

NEW_CUTS = 4
ROUNDS = 12
NEARLY_SOLVED = 0.02
"""Rounds end when the program's value exceeds the bound by this share of what the goal exceeds it."""

PENALTY = 4.0
"""Cost of violating a row, in the largest value of a target: keeps the restricted programs feasible."""


@dataclass(frozen=True, slots=True)
class Minorant:
    """``value(R) >= constant + sum of scores over R`` for every set of the family.

    ``scores`` : (F,); ``slopes`` : (M, 3) in the information; ``fraction`` : (F,) where the linear program puts
    the weakest set; ``tension`` : (F,) each robot's share of what concavity hides there; ``normals`` : (M, A, 3)
    half-spaces that would cut off the vertices that bind here (guides, not claims).
    """

    constant: float
    scores: FloatArray
    slopes: FloatArray
    fraction: FloatArray
    tension: FloatArray
    normals: FloatArray

    def bound(self, size: int) -> float:
        """No set of ``size`` robots is worth less."""
        return self.constant + float(np.partition(self.scores, size - 1)[:size].sum())

    def restricted(self, free: BoolArray, chosen: BoolArray) -> Minorant:
        """The minorant of the sets that hold the ``chosen`` robots and else only ``free`` ones (masks (F,))."""
        constant = self.constant + float(self.scores[chosen].sum())
        return replace(
            self,
            constant=constant,
            scores=self.scores[free],
            fraction=self.fraction[free],
            tension=self.tension[free],
        )


def affine_minorant(family: SetFamily, n_heavy: int, goal: float, parent: Minorant | None = None) -> Minorant:
    """Best found affine minorant; valid whatever the solver answers.

    Parameters
    ----------
    family : 0 < size < F
    goal : no better bound is needed
    parent : a minorant of a larger family, whose slopes and half-spaces are a good start
    """
    idle = np.zeros((len(family.weights), CUTS, 3))
    points = outer_points(family, n_heavy, idle if parent is None else parent.normals)
    fraction = np.full(len(family.information), family.size / len(family.information))
    mean = family.start + np.einsum("f,fmt->mt", fraction, family.information)
    slopes = _gradient(family, np.arange(len(mean)), mean) if parent is None else parent.slopes
    best = _recompute(family, points, slopes, np.zeros(points.heavy.shape), fraction)
    best = replace(best, normals=idle if parent is None else parent.normals)
    if best.bound(family.size) >= goal:
        return best
    return _generate(family, points, best, goal)


def _gradient(family: SetFamily, target: IntArray, matrices: FloatArray) -> FloatArray:
    """(V, 3) derivative of each target's value in (a, b, c) at information matrices (V, 3)."""
    a, b, c = np.moveaxis(matrices, -1, 0)
    determinant = a * c - b * b
    p, q, r = c / determinant, -b / determinant, a / determinant
    if family.kind == TRACE:
        p, q, r = p * p + q * q, q * (p + r), q * q + r * r
    return np.asarray(family.weights[target, None] * np.stack([p, 2 * q, r], axis=-1))


def _generate(family: SetFamily, points: OuterPoints, best: Minorant, goal: float) -> Minorant:
    """Solve the linear program by rounds of column generation and keep the best minorant met.

    minimise sum of values * share  over shares of the vertices and fractions x of the robots, where each
    target's shares sum to 1, reproduce ``sum_e x_e I_ej`` and, for heavy robots, their ``x_e``.
    """
    n_targets = len(family.weights)
    rows_each = 4 + points.heavy.shape[1]
    scale = np.maximum(np.abs(family.information).max(axis=(0, 2)), 1e-300)
    program = _program(family, points, scale)
    shares = np.concatenate(
        [points.sums / scale[points.target, None], np.ones((len(points.target), 1)), points.patterns[points.pattern]],
        axis=1,
    )
    used = np.zeros(len(points.target), dtype=np.bool_)
    rest = _rest(points, best.slopes, np.zeros(points.heavy.shape))
    fresh = _lowest(points, rest, FIRST_COLUMNS)
    for _ in range(ROUNDS):
        used[fresh] = True
        program.add(shares[fresh], points.target[fresh] * rows_each, points.values[fresh])
        fraction, duals, value = program.solve()
        slopes = duals[:-1].reshape(n_targets, rows_each) * points.sound[:, None]
        own = slopes[:, 4:]
        found = _recompute(family, points, slopes[:, :3] / scale[:, None], own, fraction)
        found = replace(found, normals=best.normals)
        if found.bound(family.size) >= best.bound(family.size):
            best = found
        bound = best.bound(family.size)
        rest = _rest(points, found.slopes, own)
        fresh = _lowest(points, np.where(used, np.inf, rest - slopes[points.target, 3]), NEW_COLUMNS, below=-1e-9)
        if bound >= goal or not len(fresh) or value - bound <= NEARLY_SOLVED * (goal - bound):
            break
    return replace(best, normals=_normals(family, points, found, rest))


def _normals(family: SetFamily, points: OuterPoints, found: Minorant, rest: FloatArray) -> FloatArray:
    """At the vertices that bind, the direction in which value minus minorant grows: it cuts off what is not a set."""
    binding = points.values - rest  # the minorant without its constant
    constants = np.full(len(family.weights), np.inf)
    np.minimum.at(constants, points.target, rest)
    close = np.where(rest <= constants[points.target] + 1e-6, -binding, np.inf)
    order = np.lexsort((close, points.target))
    order = order[np.isfinite(close[order])]
    target = points.target[order]
    starts = np.flatnonzero(np.diff(target, prepend=-1))
    rank = np.arange(len(order)) - np.repeat(starts, np.diff(np.append(starts, len(order))))
    order, rank = order[rank < NEW_CUTS], rank[rank < NEW_CUTS]
    target = points.target[order]
    fresh = np.zeros((len(family.weights), NEW_CUTS, 3))
    matrices = family.start[target] + points.sums[order]
    fresh[target, rank] = _gradient(family, target, matrices) - found.slopes[target]
    return np.concatenate([fresh, found.normals], axis=1)[:, :CUTS]


def _program(family: SetFamily, points: OuterPoints, scale: FloatArray) -> EqualityProgram:
    n_free, n_targets, _ = family.information.shape
    rows_each = 4 + points.heavy.shape[1]
    block = np.zeros((n_targets, rows_each, n_free))
    block[:, :3] = -(family.information / scale[:, None]).transpose(1, 2, 0)
    j, q = np.indices(points.heavy.shape)
    block[j, 4 + q, points.heavy] = -1.0
    block[~points.sound] = 0.0
    robots = np.vstack([block.reshape(-1, n_free), np.ones((1, n_free))])
    right = np.zeros(n_targets * rows_each + 1)
    right[3:-1:rows_each] = points.sound
    right[-1] = family.size
    highest = np.zeros(n_targets)
    np.maximum.at(highest, points.target, points.values)
    penalties = np.repeat(PENALTY * highest + 1e-6, rows_each).reshape(n_targets, rows_each)
    penalties[:, 3] = np.inf
    return EqualityProgram(robots, right, np.append(penalties.ravel(), np.inf))


def _rest(points: OuterPoints, slopes: FloatArray, own: FloatArray) -> FloatArray:
    """(V,) value of each vertex minus what slopes (M, 3) and the heavy robots' own scores (M, h) say."""
    rest = points.values - (points.sums * slopes[points.target]).sum(axis=1)
    return np.asarray(rest - (points.patterns[points.pattern] * own[points.target]).sum(axis=1))


def _lowest(points: OuterPoints, rest: FloatArray, count: int, below: float = np.inf) -> IntArray:
    """The ``count`` vertices of each polytope with the lowest ``rest``, as far as that is less than ``below``."""
    polytope = points.target * len(points.patterns) + points.pattern
    order = np.lexsort((rest, polytope))
    starts = np.flatnonzero(np.diff(polytope[order], prepend=-1))
    rank = np.arange(len(order)) - np.repeat(starts, np.diff(np.append(starts, len(order))))
    return np.sort(order[(rank < count) & (rest[order] < below)])


def _recompute(
    family: SetFamily, points: OuterPoints, slopes: FloatArray, own: FloatArray, fraction: FloatArray
) -> Minorant:
    """The minorant with these slopes (M, 3) and heavy robots' own scores (M, h): its constant from the vertices."""
    slopes = slopes * points.sound[:, None]
    scores = np.einsum("fmt,mt->f", family.information, slopes)
    np.add.at(scores, points.heavy.ravel(), own.ravel())
    constants = target_values(family, family.start)  # without a sound polytope: what is chosen already
    for_sound = np.full(len(constants), np.inf)
    np.minimum.at(for_sound, points.target, _rest(points, slopes, own))
    constants = np.where(points.sound, for_sound, constants)
    mean = family.start + np.einsum("f,fmt->mt", fraction, family.information)
    envelope = constants + np.einsum("f,fmt,mt->m", fraction, family.information, slopes)
    envelope += (own * fraction[points.heavy]).sum(axis=1)
    hidden = np.maximum(target_values(family, mean) - envelope, 0.0)
    no_cuts = np.zeros((len(mean), 0, 3))
    return Minorant(float(constants.sum()), scores, slopes, fraction, _tension(family, mean, hidden), no_cuts)


def _tension(family: SetFamily, mean: FloatArray, hidden: FloatArray) -> FloatArray:
    """(F,) sum over targets of the hidden value times the robot's share of the target's information."""
    trace = family.information[..., 0] + family.information[..., 2]
    share = trace / np.maximum((mean[:, 0] + mean[:, 2])[None], 1e-300)
    return np.asarray(np.minimum(share, 1.0) @ np.where(np.isfinite(hidden), hidden, 0.0))
