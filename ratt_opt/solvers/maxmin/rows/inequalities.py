"""Inequalities of single targets: ``phi_j(T) <= constant + sum of scores[e] over e in T`` for every plan's set ``T``.

Tangents are Fenchel forms that hold for any slope, so an inexact point costs strength only. What rounding moves is
added to constants and scores: ``size`` bounds the sums of the sizes that a product with the slope adds up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.proof import TargetLemma

__all__ = ["Inequalities", "TargetInequality", "tangents"]

UNITS = 8 * np.finfo(np.float64).eps
"""Relative error of a product of ``n`` terms and of what the slope was computed from, for each of the ``n + d + 2``."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TargetInequality:
    """Derivation of one inequality.

    ``point`` : (M, d, d) posterior information where the tangent of this target touches; ``lemma`` : what else it is
    """

    target: int
    point: FloatArray | None = None
    lemma: TargetLemma | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inequalities:
    """Some inequalities: ``targets`` (K,), ``constants`` (K,), ``scores`` (E, K) and their ``origins``."""

    targets: IntArray
    constants: FloatArray
    scores: FloatArray
    origins: tuple[TargetInequality, ...]


def tangents(objective: InformationObjective, point: FloatArray, targets: IntArray) -> Inequalities:
    """The tangents of some targets' concave values at the posterior information ``point`` (M, d, d)."""
    found = objective.target_tangents(point)
    slope, size = found.slope[targets], found.size[targets]
    d = objective.dimension
    unit = UNITS * (d * d + d + 2)
    prior, information = objective.prior_information[targets], objective.information[:, targets]
    scores = np.einsum("ejkl,jkl->ej", information, slope) + unit * np.einsum("ejkl,jkl->ej", abs(information), size)
    offset = found.offset[targets]
    constants = offset + np.einsum("jkl,jkl->j", slope, prior)
    constants += unit * (found.scale[targets] + np.einsum("jkl,jkl->j", size, abs(prior)))
    origins = tuple(TargetInequality(target=j, point=point) for j in targets.tolist())
    return Inequalities(targets=targets, constants=constants, scores=scores, origins=origins)
