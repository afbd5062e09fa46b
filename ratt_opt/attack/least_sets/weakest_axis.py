"""The weakest set of one size under the max-eigenvalue criterion, in closed form up to one angle.

``max_j w_j lambda_max(Lambda_j^{-1})`` is large if some ``v' Lambda_j v / w_j`` is small over unit vectors ``v``.
For a fixed ``v`` the weakest set takes the robots with the smallest ``v' I_ej v``. With ``v`` at angle ``t / 2``,
``v' I v`` is linear in ``u(t) = (1, cos t, sin t)``, so the sum of the smallest, a minimum of linear functions,
is concave in ``u``. On an interval of half-width ``d`` around ``m``, ``u(t)`` lies in the triangle of the two end
points and of the crossing of their tangents, ``(1, cos m / cos d, sin m / cos d)``; a concave function is least at
a corner. Bisecting the intervals whose corner is below the best angle found closes quadratically.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.least_sets.sets_of_size import SetFamily

__all__ = ["WeakestAxis", "weakest_axis"]


@dataclass(frozen=True, slots=True)
class WeakestAxis:
    """No set of the family is worth less than ``bound``; ``chosen`` (size,) positions nearly attain it."""

    bound: float
    chosen: IntArray


def weakest_axis(family: SetFamily) -> WeakestAxis:
    """Bound the value of a family's sets, 0 <= size <= F, under a criterion that is decided by the worst axis."""
    team, size, params = family.team, family.size, family.team.params.axis
    linear, offset = _harmonics(family.information), _harmonics(family.start)

    def smallest(target: IntArray, u: FloatArray) -> FloatArray:
        heights = np.einsum("fvt,vt->vf", linear[:, target], u)
        least = np.partition(heights, size - 1, axis=1)[:, :size].sum(axis=1) if size else 0.0
        return np.asarray(((offset[target] * u).sum(axis=1) + least) / team.weights[target])

    n_targets = len(team.weights)
    target = np.repeat(np.arange(n_targets), params.intervals)
    middle = np.tile((np.arange(params.intervals) + 0.5) * 2 * np.pi / params.intervals, n_targets)
    half, best, where, decided = np.pi / params.intervals, np.inf, (0, 0.0), np.inf
    for _ in range(params.bisections):
        at_middle = smallest(target, _direction(middle, 1.0))
        k = int(at_middle.argmin())
        if at_middle[k] < best:
            best, where = float(at_middle[k]), (int(target[k]), float(middle[k]))
        ends = (-half, 1.0), (half, 1.0), (0.0, float(np.cos(half)))  # two on the circle, one outside: shift, cosine
        corners = np.stack([smallest(target, _direction(middle + s, c)) for s, c in ends]).min(axis=0)
        is_open = corners < best * (1 - params.closed)
        decided = min(decided, float(corners[~is_open].min(initial=np.inf)))
        if not is_open.any():
            break
        target, middle = np.repeat(target[is_open], 2), np.repeat(middle[is_open], 2)
        half /= 2
        middle += np.tile([-half, half], int(is_open.sum()))
    else:
        decided = min(decided, float(corners[is_open].min(initial=np.inf)))
    heights = linear[:, where[0]] @ _direction(np.array([where[1]]), 1.0)[0]
    chosen = np.argsort(heights, kind="stable")[:size]
    least = min(decided, best)  # of lambda_min / w; not positive where a corner left the cone
    return WeakestAxis(team.record.before_all - 1 / (least * (1 - params.closed)) if least > 0 else -np.inf, chosen)


def _harmonics(matrices: FloatArray) -> FloatArray:
    """``v' [[a, b], [b, c]] v`` at angle t / 2 as coefficients of (1, cos t, sin t): (..., 3) -> (..., 3)."""
    a, b, c = matrices[..., 0], matrices[..., 1], matrices[..., 2]
    return np.stack([(a + c) / 2, (a - c) / 2, b], axis=-1)


def _direction(angle: FloatArray, cosine: float) -> FloatArray:
    return np.stack([np.ones_like(angle), np.cos(angle) / cosine, np.sin(angle) / cosine], axis=-1)
