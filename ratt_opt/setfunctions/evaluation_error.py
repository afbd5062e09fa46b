"""Bounds on the difference between computed and exact values, for the matrices as they are given.

Notation, for one target: ``P`` is the prior, ``X`` the information of a set of elements, at most one of each robot,
``L = P^{-1} + X``; norms are spectral, or Frobenius' if that is simpler and larger; ``u = 2^-53``.

1. What is evaluated is not ``L`` but ``L + D``: the prior's inverse was computed, and sums were rounded. Each rounding
   moves a sum by at most ``u`` times the sizes of its terms.
2. ``tr C (L + D)^{-1} C'`` differs from ``tr C L^{-1} C'`` by at most ``r / (1 - r) |C|^2 q``, ``r = |D| q``, if
   ``L^{-1} <= q``. The same is true of the largest eigenvalue. Log-determinants differ by at most ``d r / (1 - r)``.
   If nothing is seen of a target, ``q = |P|``. Otherwise, let ``e`` be the largest element of the set: ``L`` is no
   smaller than ``P^{-1} + X_e``, whose inverse has a norm of at most ``q``, and ``|L| <= |P^{-1}| + N |X_e|``. So the
   bound is the largest over elements, and a diffuse prior does no harm if each sighting alone locates its target.
3. The formulas themselves have the error of a matrix moved by ``growth(d) u |L|``: Gauss' elimination with row
   exchanges, whose factors have entries of at most ``2^(k - 1)`` times the matrix's in step ``k``, and three
   triangular solutions (Higham, Accuracy and Stability of Numerical Algorithms, 2002, theorems 8.5, 9.3 and 14.1).

4. Information that is semidefinite up to rounding may take a little away: no sum of a plan's elements has an eigenvalue
   below ``-n``. Beside ``n I`` more, added information takes nothing away, and values differ by at most
   ``r / (1 - r) |C|^2 |P|`` with ``r = n |P|``. So if a set contains another, its value is less by no more.

If elements tell about some directions only, ``r`` grows with ``|P| |L|``. If the prior's own condition makes that
large, coordinates in which the prior is the identity have a smaller one: see ``ratt_opt/coordinates/unit_prior.py``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.rounding_errors import MORE, UNIT, largest_sizes, most_of_plans

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["evaluation_error", "largest_fall", "value_error"]

FEW_COORDINATES = {1: 1.0, 2: 1.0}
"""``growth`` of the closed formulas: ``det L = ac - b^2`` is off by at most ``2 u ac + u det L``, and ``ac / det L`` is
at most ``(k + 3) / 4`` for a matrix of condition ``k``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComputedParams:
    """Error of values whose formula is a user's own.

    ``share`` : of the largest number that they may be a difference of [1], hundreds of its last digits: more
    hides small violations, less takes rounding for one
    """

    share: float = 1e-13


COMPUTED = ComputedParams()


def evaluation_error(objective: InformationObjective, choices: Sequence[IntArray]) -> float:
    """No value of a set of elements, at most one of each robot, is computed further from the exact one.

    Searches rely on sets being worth no less than parts of them: by how much that may be wrong is added.

    0 for a criterion of one's own: nothing is known of its formula, so its values count as exact.
    """
    dimension, targets = objective.dimension, objective.n_targets
    prior = np.linalg.norm(objective.prior, axis=(-2, -1)) * MORE
    scale = objective.error_scale(prior)
    if scale is None:
        return 0.0
    inverse = np.linalg.norm(objective.prior_information, axis=(-2, -1)) * MORE
    sizes = largest_sizes(objective.information, choices)
    lowest = most_of_plans(objective.negative_parts, choices) * prior * MORE
    with np.errstate(divide="ignore"):
        largest = prior / np.maximum(1 - lowest, 0.0)
    formula = UNIT * _growth(objective)
    before = _share(prior * (objective.inverse_error + formula * inverse))
    after = _after(objective, largest, lowest / prior, inverse, len(choices))
    logarithms = np.abs(np.log(np.stack([prior, inverse, inverse + sizes]))).max(axis=0)
    own = 2 * UNIT * (4 * dimension + targets + 8) * (1 + logarithms)
    return float(objective.combine(scale * (before + own) + after) * MORE) + largest_fall(objective, choices)


def value_error(f: SetFunction, choices: Sequence[IntArray], largest: float) -> float:
    """Bound the error of values of sets with at most one element of each choice; ``largest`` : of their sizes.

    Proved for the library's criteria. Whole numbers are exact, tables are rounded once, and of other functions it is
    their word (:attr:`SetFunction.rounding`), but at least ``COMPUTED.share``.
    """
    if f.has_exact_values:
        return 0.0
    if isinstance(f, TableFunction):
        return UNIT * largest
    if not isinstance(f, InformationObjective):
        return max(f.rounding, COMPUTED.share * largest)
    if f.error_scale(np.ones(f.n_targets)) is None:
        return COMPUTED.share * (largest + f.prior_magnitude)
    return evaluation_error(f, choices) if choices else 0.0


def largest_fall(objective: InformationObjective, choices: Sequence[IntArray]) -> float:
    """No set of elements, at most one of each robot, is worth less than a part of it by more, in exact arithmetic.

    0 if all information is semidefinite, and for a criterion of one's own: it counts as non-decreasing.
    """
    negative = most_of_plans(objective.negative_parts, choices)
    if not negative.any():
        return 0.0
    prior = np.linalg.norm(objective.prior, axis=(-2, -1)) * MORE
    scale = objective.error_scale(prior)
    return 0.0 if scale is None else float(objective.combine(scale * _share(negative * prior)) * MORE)


def _after(
    objective: InformationObjective, largest: FloatArray, lowest: FloatArray, inverse: FloatArray, robots: int
) -> FloatArray:
    """(M,) errors of what is left once something was measured.

    ``largest`` : (M,) no covariance is larger; ``lowest`` : (M,) no sum of elements is further below zero
    ``inverse`` : (M,) size of the prior's inverse
    """
    own = np.linalg.norm(objective.information, axis=(-2, -1)) * MORE
    apart = np.linalg.eigvalsh(objective.prior_information + objective.information)[..., 0]
    apart -= lowest + objective.inverse_error + 16 * objective.dimension * UNIT * (inverse + own)
    with np.errstate(divide="ignore"):
        left = np.where(apart > 0, np.minimum(1 / np.maximum(apart, 0.0), largest), largest) * MORE
    sums = UNIT * (robots + 2 + _growth(objective))
    share = _share(left * (objective.inverse_error + sums * (inverse + robots * own)))
    scale = objective.error_scale(left)
    assert scale is not None
    return np.asarray(np.where(own > 0, scale * share, 0.0).max(axis=0))


def _share(moved: FloatArray) -> FloatArray:
    """``r / (1 - r)``, infinite from 1 on."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(moved < 1, moved * MORE / (1 - moved), np.inf)


def _growth(objective: InformationObjective) -> float:
    """Factor of ``u |L|`` by which the formulas may move a matrix ``L``."""
    dimension = objective.dimension
    if dimension in FEW_COORDINATES and getattr(objective, "output", None) is None:
        return FEW_COORDINATES[dimension]
    k = np.arange(1, dimension + 1)
    entries = np.sqrt(((2 * (dimension - k) + 1) * (2.0**k - 1) ** 2).sum())  # |L||U|, of factors L and U
    return float(3 * dimension * entries) + 2 * dimension
