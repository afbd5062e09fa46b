"""An affine underestimator of the value of sets of robots of one size, from outer polytopes.

Target ``j``'s criterion is concave in its information matrix, and ``Lambda_j(R)`` lies in an outer polytope
(``outer_polytopes.py``). An affine function of ``Lambda`` that is below the value ``phi_j`` at its vertices is below
it for every ``R``. The concavity of ``phi_j`` comes mostly from the few robots next to the target: these "heavy"
ones are enumerated and get scores of their own.

Slopes and scores are raised by a smoothed ascent (``smoothed_dual.py``). The underestimator's constant is recomputed
here from all vertices, less what rounding may lose, so nothing depends on the ascent, nor on its end.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.outer_polytopes import OuterPolytopes, outer_polytopes, target_values
from ratt_opt.attack.least_sets.smoothed_dual import DualProgram, Multipliers

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.least_sets.sets_of_size import SetFamily
    from ratt_opt.budget import Budget

__all__ = ["Underestimator", "affine_underestimator"]


@dataclass(frozen=True, slots=True)
class Underestimator:
    """``value(R) >= constant + sum of scores over R`` for every set of the family.

    ``scores`` : (F,); ``slopes`` : (M, 3) in the information; ``own`` : (M, h) scores of the ``heavy`` robots (M, h)
    of each target, -1 for those no longer there; ``fraction`` : (F,) where a relaxation puts the weakest set;
    ``tension`` : (F,) each robot's share of what concavity hides there; ``normals`` : (M, A, 3) half-spaces that
    bind here, and some that would cut off the vertices that do (single precision: guides, not claims).
    """

    constant: float
    scores: FloatArray
    slopes: FloatArray
    own: FloatArray
    heavy: IntArray
    fraction: FloatArray
    tension: FloatArray
    normals: FloatArray

    def bound(self, size: int) -> float:
        """No set of ``size`` robots is worth less."""
        return self.constant + float(np.partition(self.scores, size - 1)[:size].sum())

    def restricted(self, free: BoolArray, chosen: BoolArray) -> Underestimator:
        """The underestimator of the sets that hold the ``chosen`` robots and else only ``free`` ones (masks (F,))."""
        place = np.where(free, np.cumsum(free) - 1, -1)
        return replace(
            self,
            constant=self.constant + float(self.scores[chosen].sum()),
            scores=self.scores[free],
            heavy=np.where(self.heavy >= 0, place[self.heavy], -1),
            fraction=self.fraction[free],
            tension=self.tension[free],
        )


def affine_underestimator(
    family: SetFamily, n_heavy: int, goal: float, parent: Underestimator | None = None, budget: Budget | None = None
) -> Underestimator:
    """Best found affine underestimator; valid whatever the solver answers.

    ``family`` : 0 < size < F; ``goal`` : no better bound is needed; ``parent`` : an underestimator of a larger family,
    whose slopes and half-spaces are a good start; ``budget`` : what is found when it is over is taken
    """
    points = outer_polytopes(family, n_heavy, None if parent is None else parent.normals)
    program = _program(family, points)
    fraction = np.full(len(family.information), family.size / len(family.information))
    start = _start(family, points, fraction, parent)
    # No bound is better than a relaxation's value at any fractions.
    goal = min(goal, float(target_values(family, _mean(family, fraction)).sum()))
    unsound = float(target_values(family, family.start)[~points.sound].sum())
    better, fraction = program.ascend(start, goal - unsound, cold=parent is None, budget=budget)
    return _recompute(family, points, program, better, fraction)


def _mean(family: SetFamily, fraction: FloatArray) -> FloatArray:
    return np.asarray(family.start + np.einsum("f,fmt->mt", fraction, family.information))


def _start(
    family: SetFamily, points: OuterPolytopes, fraction: FloatArray, parent: Underestimator | None
) -> Multipliers:
    """The parent's multipliers, or the gradient if every robot has the same share."""
    n_targets = len(family.team.weights)
    slopes = _gradient(family, np.arange(n_targets), _mean(family, fraction)) if parent is None else parent.slopes
    shares = np.einsum("fmt,mt->mf", family.information, slopes)
    if parent is not None:
        target, place = np.nonzero(parent.heavy >= 0)
        shares[target, parent.heavy[target, place]] = parent.own[target, place]
    own = np.take_along_axis(shares, points.heavy, axis=1)
    return Multipliers(slopes * points.sound[:, None], own * points.sound[:, None])


def _program(family: SetFamily, points: OuterPolytopes) -> DualProgram:
    information = family.information * points.sound[:, None]
    np.put_along_axis(information.transpose(1, 0, 2), points.heavy[..., None], 0.0, axis=1)
    patterns, heavy = np.array(points.patterns, dtype=np.float64, order="C"), np.ascontiguousarray(points.heavy)
    vertices = points.first, points.pattern, points.values, points.light
    return DualProgram(
        *vertices, patterns, heavy, np.ascontiguousarray(information), family.size, family.team.params.ascent
    )


def _gradient(family: SetFamily, target: IntArray, matrices: FloatArray) -> FloatArray:
    """(V, 3) derivative of each target's value in (a, b, c) at information matrices (V, 3)."""
    team = family.team
    gradient = team.objective.planar_gradient(matrices[:, 0], matrices[:, 1], matrices[:, 2])
    return np.asarray(team.weights[target, None] * gradient)


def _normals(
    family: SetFamily, points: OuterPolytopes, slopes: FloatArray, rest: FloatArray, constants: FloatArray
) -> FloatArray:
    """(M, kept + new, 3) normals of the half-spaces that bind here, and of new ones.

    ``constants`` : (M,) the least ``rest`` of each target
    """
    params, counts = family.team.params.underestimator, np.diff(points.first)
    width = np.maximum(params.binding * np.abs(constants), 1e-300)
    closeness = 1 - (rest - np.repeat(constants, counts)) / np.repeat(width, counts)
    weights, near = np.zeros((len(points.heavy), points.normals.shape[1])), np.flatnonzero(closeness > 0)
    facets = points.rows[near, None] >> np.arange(weights.shape[1], dtype=np.uint64) & np.uint64(1)
    target = np.repeat(np.arange(len(counts)), counts)
    np.add.at(weights, target[near], facets * closeness[near, None])
    weights[:, 6 : 6 + family.team.params.polytopes.sight] = 0.0  # those are there anyway
    order = np.argsort(-weights, axis=1, kind="stable")[:, : params.kept, None]
    kept = np.take_along_axis(points.normals, order, axis=1)
    kept *= np.take_along_axis(weights[..., None], order, axis=1) > 0
    return np.concatenate([kept, _new_normals(family, points, slopes, closeness)], axis=1)


def _new_normals(family: SetFamily, points: OuterPolytopes, slopes: FloatArray, closeness: FloatArray) -> FloatArray:
    """Separate: at vertices that bind, return the direction in which value minus underestimator grows.

    A normal in this direction cuts off points that are no sets.
    """
    new = family.team.params.underestimator.new
    target = np.repeat(np.arange(len(points.heavy)), np.diff(points.first))
    close = np.flatnonzero(closeness > 0)
    order = close[np.lexsort((-closeness[close], target[close]))]
    target = target[order]
    starts = np.flatnonzero(np.diff(target, prepend=-1))
    rank = np.arange(len(order)) - np.repeat(starts, np.diff(np.append(starts, len(order))))
    order, target, rank = order[rank < new], target[rank < new], rank[rank < new]
    fresh = np.zeros((len(family.team.weights), new, 3))
    matrices = family.start[target] + points.base[target, points.pattern[order]] + points.light[order]
    fresh[target, rank] = _gradient(family, target, matrices) - slopes[target]
    return fresh


def _recompute(
    family: SetFamily, points: OuterPolytopes, program: DualProgram, multipliers: Multipliers, fraction: FloatArray
) -> Underestimator:
    """The underestimator with these multipliers: its constant from the vertices; targets without any get none."""
    slopes, own = multipliers.slopes * points.sound[:, None], multipliers.own * points.sound[:, None]
    shares = np.einsum("fmt,mt->mf", program.information, slopes)
    np.put_along_axis(shares, points.heavy, own, axis=1)
    without = target_values(family, family.start)  # without a sound polytope: what is chosen already
    rest = program.rest(multipliers)
    constants = np.where(points.sound, program.least(rest), without)
    mean = _mean(family, fraction)
    hidden = np.maximum(target_values(family, mean) - constants - shares @ fraction, 0.0)
    trace = family.information[..., 0] + family.information[..., 2]
    share = np.minimum(trace / np.maximum((mean[:, 0] + mean[:, 2])[None], 1e-300), 1.0)  # of a target's information
    return Underestimator(
        constant=float(constants.sum()) - program.rounding(multipliers),
        scores=shares.sum(axis=0),
        slopes=slopes,
        own=own,
        heavy=points.heavy,
        fraction=fraction,
        tension=np.asarray(share @ np.where(np.isfinite(hidden), hidden, 0.0)),
        normals=_normals(family, points, slopes, rest, constants).astype(np.float32),
    )
