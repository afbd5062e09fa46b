"""Information about targets with one or two coordinates, in the form whose smallest eigenvalue is explicit.

A symmetric matrix ``[[m + e, o], [o, m - e]]`` has the quadratic form ``m + e cos(a) + o sin(a)`` along the unit
vector at angle ``a / 2``, hence the smallest eigenvalue ``m - hypot(e, o)``, at ``a = atan2(-o, -e)``. Everything
here is divided by the target's weight: ``lambda_min(L_j) / w_j`` is called the *level* of target ``j``, and
the max-eigenvalue criterion is one over the smallest level.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["LARGEST_DIMENSION", "Options", "Planar", "along", "levels", "marginals"]

LARGEST_DIMENSION = 2


@dataclass(frozen=True, slots=True)
class Planar:
    """``parts`` (n, 3, M) of each element and ``prior`` (3, M): mean, even and odd part about each target.

    Both are divided by ``scale``, a power of two, so that squares neither overflow nor vanish.
    """

    parts: FloatArray
    prior: FloatArray
    scale: float

    @classmethod
    def of(cls, f: InformationObjective) -> Planar:
        """Return the parts of a criterion whose targets have at most two coordinates."""
        weights = f.weights[:, None, None]
        prior = _parts(f.prior_information / weights)
        scale = float(2.0 ** np.round(np.log2(prior[0].max())))
        return cls(_parts(f.information / weights) / scale, prior / scale, scale)


@dataclass(frozen=True, slots=True)
class Options:
    """What the robots other than one element's owner may do: K options of R robots, "none" being each one's first.

    ``elements`` : (K,), -1 for none; ``robot`` : (K,) 0..R-1; ``first`` : (R,) their "none"; ``parts`` : (K, 3, M).
    """

    elements: IntArray
    robot: IntArray
    first: IntArray
    parts: FloatArray

    @classmethod
    def beside(cls, planar: Planar, owners: IntArray, owner: int) -> Options:
        """Options of all robots but one."""
        robots = [np.flatnonzero(owners == i) for i in np.unique(owners) if i != owner]
        own = [np.concatenate([[-1], elements]) for elements in robots]
        elements = np.concatenate([*own, np.array([], dtype=np.int64)]).astype(np.int64)
        sizes = np.array([len(part) for part in own], dtype=np.int64)
        first = (np.cumsum(sizes) - sizes).astype(np.int64)
        parts = np.where((elements >= 0)[:, None, None], planar.parts[elements], 0.0)
        return cls(elements, np.repeat(np.arange(len(own)), sizes), first, parts)

    def context(self, picks: IntArray) -> tuple[int, ...]:
        """The elements of one option (position) a robot."""
        return tuple(sorted(int(e) for e in self.elements[picks] if e >= 0))


def levels(total: FloatArray) -> FloatArray:
    """Smallest eigenvalues: (..., 3, M) -> (..., M)."""
    return np.asarray(total[..., 0, :] - np.hypot(total[..., 1, :], total[..., 2, :]))


def along(angle: FloatArray | float) -> FloatArray:
    """Coefficients of the three parts in the quadratic form at an angle: (...) -> (..., 3)."""
    angle = np.asarray(angle)
    return np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=-1)


def marginals(total: FloatArray, added: FloatArray) -> FloatArray:
    """Marginal of an element with parts ``added`` (3, M) on top of ``total`` (..., 3, M): 1/P - 1/Q >= 0."""
    before, after = _smallest(total), _smallest(total + added)
    return np.asarray((after - before) / (before * after))


def _smallest(total: FloatArray) -> FloatArray:
    """As ``levels(total).min(axis=-1)``; several times as fast without ``hypot``."""
    even, odd = total[..., 1, :], total[..., 2, :]
    return np.asarray((total[..., 0, :] - np.sqrt(even * even + odd * odd)).min(axis=-1))


def _parts(matrices: FloatArray) -> FloatArray:
    """(..., M, d, d) -> (..., 3, M)."""
    if matrices.shape[-1] == 1:
        mean = matrices[..., 0, 0]
        return np.stack([mean, np.zeros_like(mean), np.zeros_like(mean)], axis=-2)
    first, last = matrices[..., 0, 0], matrices[..., 1, 1]
    return np.stack([(first + last) / 2, (first - last) / 2, matrices[..., 0, 1]], axis=-2)
