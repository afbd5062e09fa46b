"""What all criteria of the posterior information matrices have in common.

For a set ``S`` of elements, target ``j``'s posterior information is
``Lambda_j(S) = prior[j]^{-1} + sum_{e in S} information[e, j]``. Every criterion
is normalised, non-decreasing in ``S`` and concave in ``Lambda``; each has a file under ``criteria/``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, check_finite, readonly
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import SetFunction, check_table_size

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

__all__ = ["InformationObjective", "Tangent"]

SYMMETRY_TOLERANCE = 1e-9
"""Largest accepted asymmetry, and most negative accepted eigenvalue, relative to the matrix (rounding)."""


def _check_symmetric(argument: str, matrices: FloatArray) -> FloatArray:
    """Return the symmetric part of matrices that are symmetric up to rounding."""
    transposed = np.swapaxes(matrices, -1, -2)
    defect = np.abs(matrices - transposed).max(axis=(-1, -2))
    scale = np.abs(matrices).max(axis=(-1, -2))
    bad = np.argwhere(defect > SYMMETRY_TOLERANCE * scale)
    if len(bad):
        where = tuple(int(i) for i in bad[0])
        name = f"{argument}[{', '.join(map(str, where))}]"
        raise InputError(name, "must be symmetric", matrices[where].tolist())
    return (matrices + transposed) / 2


def _check_prior(value: ArrayLike) -> FloatArray:
    prior = check_finite("prior", value, ndim=3)
    if prior.shape[0] < 1:
        raise InputError("prior", "must hold at least one target", f"shape {prior.shape}")
    if prior.shape[1] != prior.shape[2] or prior.shape[1] < 1:
        raise InputError("prior", "must have shape (M, d, d)", f"shape {prior.shape}")
    prior = _check_symmetric("prior", prior)
    for j, eigenvalues in enumerate(np.linalg.eigvalsh(prior)):
        if eigenvalues[0] <= np.finfo(np.float64).eps * abs(eigenvalues[-1]):
            raise InputError(f"prior[{j}]", "must be positive definite", f"smallest eigenvalue {eigenvalues[0]:.6g}")
    return prior


def _check_information(value: ArrayLike, targets: int, dimension: int) -> FloatArray:
    information = check_finite("information", value, ndim=4)
    if information.shape[0] < 1:
        raise InputError("information", "must hold at least one element", f"shape {information.shape}")
    if information.shape[1:] != (targets, dimension, dimension):
        rule = f"must have shape (E, {targets}, {dimension}, {dimension}) to match prior"
        raise InputError("information", rule, f"shape {information.shape}")
    information = _check_symmetric("information", information)
    eigenvalues = np.linalg.eigvalsh(information)
    bad = np.argwhere(eigenvalues[..., 0] < -SYMMETRY_TOLERANCE * np.abs(eigenvalues[..., -1]))
    if len(bad):
        e, j = (int(i) for i in bad[0])
        shown = f"eigenvalues from {eigenvalues[e, j, 0]:.6g} to {eigenvalues[e, j, -1]:.6g}"
        raise InputError(f"information[{e}, {j}]", "must be positive semidefinite", shown)
    return information


def _check_weights(value: ArrayLike | None, targets: int) -> FloatArray:
    if value is None:
        return np.ones(targets)
    weights = check_finite("weights", value, ndim=1)
    if weights.shape != (targets,):
        raise InputError("weights", f"must have shape ({targets},) to match prior", f"shape {weights.shape}")
    if (weights <= 0).any():
        raise InputError("weights", "must be positive", float(weights.min()))
    return weights


@dataclass(frozen=True, slots=True)
class Tangent:
    """``value(L) <= offset + sum_j <slope_j, L_j>`` for every positive definite ``L``; ``slope`` (M, d, d)."""

    slope: FloatArray
    offset: float


OPTIONAL_PARTS = (
    "cut_values",
    "combine",
    "compiled_code",
    "is_submodular",
    "name",
    "planar_criterion",
    "prior_criterion",
    "tangent",
    "tangent_targets",
    "unit",
)
"""Parts of a criterion that hold for its own formula only: a subclass with another formula does not inherit them."""


class InformationObjective(SetFunction):
    """A criterion of the posterior information matrices.

    A criterion of your own subclasses this with :meth:`criterion` (or :meth:`value`, 0 at the prior information) and
    :meth:`gradient`; it must be concave in the information and non-decreasing (relied on, not checked). The
    rest is optional: what a criterion does not state is done by generic bounds, or refused by the name of that part.

    Parameters
    ----------
    prior : (M, d, d) predicted covariances, symmetric positive definite
    information : (E, M, d, d) information of element ``e`` about target ``j``, symmetric
        positive semidefinite; smallest eigenvalue at least ``-1e-9`` times the largest
    weights : (M,) positive importance of each target; ones by default

    Raises
    ------
    InputError : a shape, symmetry, definiteness or sign rule is broken.

    Source: ratt.tex, Section II-A e) and the objective of Section VI.
    """

    __slots__ = ("_baseline", "information", "prior", "prior_information", "weights")

    name: ClassVar[str] = ""
    """What files, tables and the command line call it; empty for a criterion that is not registered."""
    unit: ClassVar[str] = ""
    is_submodular: ClassVar[bool] = False
    """Whether theory proves it submodular for all data."""
    compiled_code: ClassVar[int | None] = None
    """Its number in the compiled loops for planar targets (``criteria/compiled.py``), if it is there."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if {"criterion", "value", "gradient"} & set(vars(cls)):
            for part in set(OPTIONAL_PARTS) - set(vars(cls)):
                setattr(cls, part, vars(InformationObjective)[part])

    def __init__(self, prior: ArrayLike, information: ArrayLike, weights: ArrayLike | None = None) -> None:
        checked = _check_prior(prior)
        targets, dimension, _ = checked.shape
        self.prior: FloatArray = readonly(checked)
        self.information: FloatArray = readonly(_check_information(information, targets, dimension))
        self.weights: FloatArray = readonly(_check_weights(weights, targets))
        inverse = np.linalg.inv(checked)
        self.prior_information: FloatArray = readonly((inverse + np.swapaxes(inverse, -1, -2)) / 2)
        # The baseline is computed by the same formula as the posterior, so that f(empty set) is exactly 0.
        own = type(self)
        if own.criterion is not InformationObjective.criterion:
            self._baseline: FloatArray = readonly(self.criterion(self.prior_information))
        elif own.value is InformationObjective.value:
            raise self._without("criterion", "weighted criterion per target")

    @property
    def n(self) -> int:
        """Number of elements E."""
        return int(self.information.shape[0])

    @property
    def n_targets(self) -> int:
        """Number of targets M."""
        return int(self.prior.shape[0])

    @property
    def dimension(self) -> int:
        """Dimension d of a target's state."""
        return int(self.prior.shape[1])

    def criterion(self, posterior_information: FloatArray) -> FloatArray:  # noqa: ARG002
        """Weighted criterion per target, lower is better: (..., M, d, d) -> (..., M)."""
        raise self._without("criterion", "weighted criterion per target")

    def gradient(self, posterior_information: FloatArray) -> FloatArray:  # noqa: ARG002
        """A supergradient of the value with respect to ``Lambda``: (..., M, d, d), positive semidefinite.

        For every ``L'``: ``value(L') <= value(L) + sum_j <gradient_j, L'_j - L_j>`` (concavity).
        """
        raise self._without("gradient", "supergradient of its value")

    def _without(self, part: str, what: str) -> InputError:
        return InputError("objective", f"must define {part}(posterior_information), the {what}", type(self).__name__)

    def combine(self, per_target: FloatArray) -> FloatArray:
        """The criterion of the team from that of each target: (..., M) -> (...); a sum."""
        return np.asarray(per_target.sum(axis=-1))

    def value(self, posterior_information: FloatArray) -> FloatArray:
        """Value as a concave function of the posterior information: (..., M, d, d) -> (...); a sum over targets."""
        return np.asarray((self._baseline - self.criterion(posterior_information)).sum(axis=-1))

    @property
    def prior_criterion(self) -> float | None:
        """The criterion before any measurement, where it is a size (trace, max-eigenvalue) and not a logarithm."""
        return None

    def planar_criterion(self, a: Any, b: Any, c: Any) -> FloatArray:
        """:meth:`criterion` of planar targets from the entries of ``[[a, b], [b, c]]``: three (..., M) -> (..., M)."""
        rows = np.stack([np.stack([a, b], axis=-1), np.stack([b, c], axis=-1)], axis=-2)
        return self.criterion(rows)

    def tangent_targets(self, point: FloatArray, level: float, most: int) -> list[int | None]:  # noqa: ARG002
        """Targets to take tangents for at ``point`` (M, d, d), at most ``most``; ``None`` is all of them together.

        ``level`` : tangents that do not cut this value off are of no use.
        """
        return [None]

    def tangent(self, point: FloatArray, target: int | None) -> Tangent:  # noqa: ARG002
        """Bound the value of all information by the tangent at ``point`` (M, d, d), for one of its targets.

        Relies on :meth:`gradient` and :meth:`value` being exact at ``point`` up to rounding.
        """
        slope = self.gradient(point)
        return Tangent(slope, float(self.value(point)) - float(np.einsum("jkl,jkl->", slope, point)))

    def cut_values(self, points: FloatArray, targets: Sequence[int | None]) -> FloatArray:  # noqa: ARG002
        """What tangents for these ``targets`` bound, up to a constant: (K, ..., M, d, d) -> (K, ...)."""
        return self.value(points)

    def posterior_information(self, subset: IntArray) -> FloatArray:
        """(M, d, d) ``Lambda(S)`` of the given distinct elements, added in ascending order."""
        stacked = np.concatenate([self.prior_information[None], self.information[np.sort(subset)]])
        return np.asarray(np.add.reduce(stacked, axis=0))

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        flat = self.information.reshape(self.n, -1)
        shape = (len(membership), *self.prior.shape)
        if len(membership) == 1:
            return self.value(self.posterior_information(np.flatnonzero(membership[0]))[None])
        # Elements are added one by one so that every batch size rounds alike.
        total = np.broadcast_to(self.prior_information.reshape(1, -1), (len(membership), flat.shape[1])).copy()
        for e in np.flatnonzero(membership.any(axis=0)):
            rows = membership[:, e]
            total[rows] += flat[e]
        return self.value(total.reshape(shape))

    def extensions(self, base: IntArray, candidates: IntArray) -> FloatArray:
        """(C,) values ``f(base + {e})`` for each candidate ``e`` outside ``base``."""
        return self.value(self.posterior_information(base) + self.information[candidates])

    def table(self) -> FloatArray:
        """(2**n,) values of all subsets, target by target, each by doubling over the elements."""
        check_table_size(self.n)
        chunk = min(self.n, 16)  # 2**16 matrices at a time stay in cache
        values = np.empty(2**self.n)
        low = self._lattice(self.prior_information, self.information[:chunk])
        high = self._lattice(np.zeros_like(self.prior_information), self.information[chunk:])
        for block, offset in enumerate(high):
            start = block << chunk
            values[start : start + len(low)] = self.value(low + offset)
        return values

    @staticmethod
    def _lattice(start: FloatArray, steps: FloatArray) -> FloatArray:
        """(2**k, M, d, d) sums of all subsets of the k ``steps``, added to ``start``."""
        sums = np.empty((2 ** len(steps), *start.shape))
        sums[0] = start
        for i, step in enumerate(steps):
            sums[1 << i : 2 << i] = sums[: 1 << i] + step
        return sums
