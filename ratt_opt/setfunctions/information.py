"""Common part of all criteria of the posterior information matrices.

For a set ``S`` of elements, target ``j``'s posterior information is
``Lambda_j(S) = prior[j]^{-1} + sum_{e in S} information[e, j]``. Every criterion
is normalised, non-decreasing in ``S`` and concave in ``Lambda``; each has a file under ``criteria/``.
"""

from __future__ import annotations

import warnings
from copy import copy
from dataclasses import dataclass
from math import isqrt
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, check_finite, readonly
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.criterion_parts import CriterionParts
from ratt_opt.setfunctions.rounding_errors import inverse_error, is_definite, negative_parts, shrunk_to_semidefinite
from ratt_opt.setfunctions.target_parts import TargetParts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike

    from ratt_opt.setfunctions.decomposition import Decomposition

__all__ = ["InformationObjective", "from_triangles", "packed", "positive_parts", "symmetric_inverse", "triangles"]

SYMMETRY_TOLERANCE = 1e-9
"""Largest accepted asymmetry, and most negative accepted eigenvalue, relative to the matrix (rounding)."""
SINGLE_TOLERANCE = 1e-6
"""Largest accepted asymmetry of float32 matrices: eight of their roundings."""
LARGEST = 1e100
"""Entries and weights beyond this, priors and weights below its inverse are refused: products of two stay finite."""
WIDEST = 2e14
"""Largest eigenvalue of an element's information times that of the prior. Sums of both hold sixteen digits, of which
searches that exchange elements lose a few: beyond this nothing would be left of the prior."""
DEEPEST = 0.01
"""Largest size of a negative eigenvalue of the information times the prior's: some robots' must not outweigh it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SignParams:
    """Limits from which a small eigenvalue counts as negative, or as positive.

    Negative ones within ``rounded`` or ``slight`` stay as they are, and every published end accounts for them; those
    beyond both are set to 0. Larger limits change fewer of the given matrices, and leave ends further apart.

    ``rounded`` : share of the largest eigenvalue [1]; ``slight`` : share of the prior's inverse [1]
    ``clear`` : share of the largest from which a prior's eigenvalue is positive [1]; below, exact arithmetic decides
    """

    rounded: float = 1e-13
    slight: float = 1e-9
    clear: float = 1e-12


SIGN = SignParams()


class InformationObjective(CriterionParts):
    """A criterion of the posterior information matrices.

    A criterion of your own subclasses this with :meth:`criterion` (or :meth:`value`, 0 at the prior information) and
    :meth:`gradient`; it must be concave in the information and non-decreasing (relied on, not checked). The
    rest is optional: what a criterion does not state is done by generic bounds, or refused by the name of that part.

    Parameters
    ----------
    prior : (M, d, d) predicted covariances, symmetric (float32: up to its rounding) positive definite
    information : (E, M, d, d) information of element ``e`` about target ``j``, symmetric positive semidefinite up to
        rounding: smallest eigenvalue at least ``-1e-9`` times the largest, and -0.01 times the prior's inverse
        (float32: ``-1e-6`` times the largest). Those that are beyond ``-1e-13`` times the largest and ``-1e-9`` times
        the prior's inverse would take information away, and are set to 0, with a ``UserWarning``
    weights : (M,) positive importance of each target; ones by default

    Raises
    ------
    InputError : a shape, symmetry, definiteness or sign rule is broken.

    Notes
    -----
    All values, brackets and certificates are those of the matrices in the attributes ``prior`` and ``information``:
    symmetric parts of the given ones, ``repaired`` of them (a number) without their negative eigenvalues. If rounding
    made a matrix of two coordinates indefinite, its entry off the diagonal is smaller by some last digits.

    Source: ratt.tex, Section II-A e) and the objective of Section VI.
    """

    __slots__ = (
        "__weakref__",
        "_baseline",
        "_inverse_error",
        "_negative_parts",
        "_singletons",
        "condition",
        "information",
        "prior",
        "prior_information",
        "repaired",
        "weights",
    )

    is_non_decreasing: ClassVar[bool] = True
    """Added information is positive semidefinite, up to the rounding that the input rule admits."""

    def __init__(self, prior: ArrayLike, information: ArrayLike, weights: ArrayLike | None = None) -> None:
        self.prior: FloatArray = readonly(_check_prior(prior))
        checked, self.repaired = _check_information(information, self.prior)
        self.information: FloatArray = readonly(checked)
        self.weights: FloatArray = readonly(_check_weights(weights, self.n_targets))
        self.prior_information: FloatArray = readonly(symmetric_inverse(self.prior))
        # The baseline is computed by the same formula as the posterior, so that f(empty set) is exactly 0.
        is_own_value = self.overrides("value") and not self.overrides("criterion")
        baseline = np.zeros(self.n_targets) if is_own_value else self.criterion(self.prior_information)
        self._baseline: FloatArray = readonly(baseline)
        self.condition: FloatArray = readonly(self._condition())
        self._singletons: FloatArray | None = None
        self._inverse_error: FloatArray | None = None
        self._negative_parts: FloatArray | None = None

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.n} elements, {self.n_targets} targets, d = {self.dimension})"

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

    def _condition(self) -> FloatArray:
        """(M,) no information matrix of a target has a larger condition: most information over least."""
        largest = np.linalg.eigvalsh(self.prior_information + self.information.sum(axis=0))[:, -1]
        return np.asarray(largest * np.linalg.eigvalsh(self.prior)[:, -1])

    @property
    def inverse_error(self) -> FloatArray:
        """(M,) bounds of the norms by which :attr:`prior_information` differs from the exact inverses."""
        if self._inverse_error is None:
            self._inverse_error = readonly(inverse_error(self.prior, self.prior_information))
        return self._inverse_error

    @property
    def negative_parts(self) -> FloatArray:
        """(E, M) no eigenvalue of :attr:`information` is further below 0; 0 if it is shown to be semidefinite."""
        if self._negative_parts is None:
            self._negative_parts = readonly(negative_parts(self.information))
        return self._negative_parts

    def restricted_to(self, elements: IntArray) -> Self:
        """Restrict the criterion to some of the elements, in the given order."""
        restricted = copy(self)
        restricted.information = readonly(self.information[elements])
        restricted._singletons = restricted._negative_parts = None
        return restricted

    def of_target(self, target: int) -> Self:
        """Return the criterion of one target alone."""
        own, one = slice(target, target + 1), copy(self)
        one.prior, one.prior_information = readonly(self.prior[own]), readonly(self.prior_information[own])
        one.information, one.weights = readonly(self.information[:, own]), readonly(self.weights[own])
        one._baseline, one.condition = readonly(self._baseline[own]), readonly(self.condition[own])
        one._singletons = one._inverse_error = None
        return one

    def with_information(self, information: ArrayLike) -> Self:
        """Replace the elements: information (E, M, d, d), checked."""
        other = copy(self)
        checked, other.repaired = _check_information(information, self.prior)
        other.information = readonly(checked)
        other.condition = readonly(other._condition())
        other._singletons = other._negative_parts = None
        return other

    def are_alike(self, elements: IntArray) -> bool:
        """Return whether they tell the same about every target."""
        return bool((self.information[elements] == self.information[elements[:1]]).all())

    def decomposition(self) -> Decomposition | None:
        """The targets; ``None`` if the criterion states another value than the sum or the least over targets."""
        if self.is_least_of_targets:
            return TargetParts(self, top=np.full(self.n_targets, self._baseline.max()), is_sum=False)
        if self.overrides("value") or self.overrides("combine"):
            return None
        return TargetParts(self, top=self._baseline, is_sum=True)

    def criterion_of_one(self, matrices: FloatArray, target: int) -> FloatArray:
        """(K,) weighted criterion of one target for its posterior information (K, d, d), by the formula for one target.

        For criteria without data of targets beside the weights and ``output``.
        """
        one, only = copy(self), slice(target, target + 1)
        one.weights = self.weights[only]
        if (output := getattr(self, "output", None)) is not None:
            one.output = output[only]  # type: ignore[attr-defined]
        return one.criterion(matrices[:, None])[:, 0]

    def posterior_information(self, subset: IntArray) -> FloatArray:
        """(M, d, d) ``Lambda(S)`` of the given distinct elements, added in ascending order."""
        stacked = np.concatenate([self.prior_information[None], self.information[np.sort(subset)]])
        return np.asarray(np.add.reduce(stacked, axis=0))

    def posterior_mixture(self, share: FloatArray) -> FloatArray:
        """(M, d, d) posterior information of fractional elements, ``share`` (n,)."""
        chosen = np.flatnonzero(share)
        return np.asarray(self.prior_information + np.tensordot(share[chosen], self.information[chosen], axes=1))

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        if len(membership) == 1:
            return self.value(self.posterior_information(np.flatnonzero(membership[0]))[None])
        # Elements are added one by one so that every batch size rounds alike.
        flat = self.information.reshape(self.n, self.prior.size)
        total = np.broadcast_to(self.prior_information.reshape(1, -1), (len(membership), flat.shape[1])).copy()
        for e in np.flatnonzero(membership.any(axis=0)):
            total[membership[:, e]] += flat[e]
        return self.value(total.reshape(len(membership), *self.prior.shape))

    def extensions(self, base: IntArray, candidates: IntArray) -> FloatArray:
        """(C,) values ``f(base + {e})`` for each candidate ``e`` outside ``base``."""
        return self.value(self.posterior_information(base) + self.information[candidates])

    def singletons(self) -> FloatArray:
        """(E,) values of the elements alone; kept, as every search begins with them: half a second of 1,000 robots."""
        if self._singletons is None:
            self._singletons = super().singletons()
        return self._singletons.copy()

    def table_blocks(self) -> Iterator[FloatArray]:
        """The table, block by block: sums over the first elements, and those over the others, by doubling."""
        chunk = min(self.n, 16)  # 2**16 matrices at a time stay in cache
        low = self._lattice(self.prior_information, self.information[:chunk])
        for offset in self._lattice(np.zeros_like(self.prior_information), self.information[chunk:]):
            yield self.value(low + offset)

    @staticmethod
    def _lattice(start: FloatArray, steps: FloatArray) -> FloatArray:
        """(2**k, M, d, d) sums of all subsets of the k ``steps``, added to ``start``."""
        sums = np.empty((2 ** len(steps), *start.shape))
        sums[0] = start
        for i, step in enumerate(steps):
            sums[1 << i : 2 << i] = sums[: 1 << i] + step
        return sums


def symmetric_inverse(matrices: FloatArray) -> FloatArray:
    """Inverses, symmetric to the last digit."""
    inverse = np.linalg.inv(matrices)
    return np.asarray((inverse + np.swapaxes(inverse, -1, -2)) / 2)


def packed(matrices: FloatArray) -> list[Any]:
    """Lower triangles by rows, the form in certificates: (..., d, d) -> nested lists (..., d (d + 1) / 2)."""
    entries: list[Any] = triangles(matrices).tolist()
    return entries


def triangles(matrices: FloatArray) -> FloatArray:
    """Lower triangles by rows, the form in compiled loops: (..., d, d) -> (..., d (d + 1) / 2)."""
    rows, columns = np.tril_indices(matrices.shape[-1])
    return np.ascontiguousarray(matrices[..., rows, columns])


def from_triangles(entries: FloatArray) -> FloatArray:
    """The symmetric matrices again."""
    d = (isqrt(8 * entries.shape[-1] + 1) - 1) // 2
    place = np.zeros((d, d), dtype=np.int64)
    rows, columns = np.tril_indices(d)
    place[rows, columns] = place[columns, rows] = np.arange(len(rows))
    return np.ascontiguousarray(entries[..., place])


def _check_symmetric(argument: str, matrices: FloatArray, *, single: bool) -> FloatArray:
    """Return the symmetric part of matrices that are symmetric up to rounding, to float32 if they are ``single``."""
    tolerance = SINGLE_TOLERANCE if single else SYMMETRY_TOLERANCE
    if np.abs(matrices).max() > LARGEST:
        raise InputError(argument, f"must have entries of size at most {LARGEST:g}", float(np.abs(matrices).max()))
    transposed = np.swapaxes(matrices, -1, -2)
    defect = np.abs(matrices - transposed).max(axis=(-1, -2))
    bad = np.argwhere(defect > tolerance * np.abs(matrices).max(axis=(-1, -2)))
    if len(bad):
        where = tuple(bad[0].tolist())
        raise InputError(f"{argument}[{', '.join(map(str, where))}]", "must be symmetric", matrices[where].tolist())
    return (matrices + transposed) / 2


def _is_single(value: ArrayLike) -> bool:
    return bool(np.asarray(value).dtype == np.float32)


def _check_prior(value: ArrayLike) -> FloatArray:
    """Return (M, d, d) symmetric positive definite matrices."""
    prior = check_finite("prior", value, ndim=3)
    if prior.shape[0] < 1:
        raise InputError("prior", "must hold at least one target", f"shape {prior.shape}")
    if prior.shape[1] != prior.shape[2] or prior.shape[1] < 1:
        raise InputError("prior", "must have shape (M, d, d)", f"shape {prior.shape}")
    prior = _check_symmetric("prior", prior, single=_is_single(value))
    for j, eigenvalues in enumerate(np.linalg.eigvalsh(prior)):
        if eigenvalues[0] <= np.finfo(np.float64).eps * abs(eigenvalues[-1]):
            if np.linalg.eigvalsh(_unit_diagonal(prior[j]))[0] > np.finfo(np.float64).eps:
                rule = "must have a condition below 4.5e15: rescale the states, for instance seconds to nanoseconds"
                shown = f"eigenvalues from {eigenvalues[0]:.6g} to {eigenvalues[-1]:.6g}"
                raise InputError(f"prior[{j}]", rule, shown)
            raise InputError(f"prior[{j}]", "must be positive definite", f"smallest eigenvalue {eigenvalues[0]:.6g}")
        if eigenvalues[0] < SIGN.clear * eigenvalues[-1] and not is_definite(prior[j]):
            shown = f"a negative eigenvalue; the smallest is computed as {eigenvalues[0]:.6g}"
            raise InputError(f"prior[{j}]", "must be positive definite", shown)
        if eigenvalues[0] < 1 / LARGEST:
            rule = f"must have eigenvalues of at least {1 / LARGEST:g}"
            raise InputError(f"prior[{j}]", rule, f"smallest eigenvalue {eigenvalues[0]:.6g}")
    return prior


def _unit_diagonal(matrix: FloatArray) -> FloatArray:
    """The matrix in units in which its diagonal is one: definite as before; as it is if an entry is not positive."""
    diagonal = np.diagonal(matrix)
    if diagonal.min() <= 0:
        return matrix
    scale = 1 / np.sqrt(diagonal)
    return np.asarray(matrix * scale[:, None] * scale)


def _check_information(value: ArrayLike, prior: FloatArray) -> tuple[FloatArray, int]:
    """Return (E, M, d, d) matrices, semidefinite up to rounding, that leave the prior its digits, and how many were
    repaired.
    """
    targets, dimension = prior.shape[:2]
    information = check_finite("information", value, ndim=4)
    if information.shape[0] < 1:
        raise InputError("information", "must hold at least one element", f"shape {information.shape}")
    if information.shape[1:] != (targets, dimension, dimension):
        rule = f"must have shape (E, {targets}, {dimension}, {dimension}) to match prior"
        raise InputError("information", rule, f"shape {information.shape}")
    single = _is_single(value)
    information = _check_symmetric("information", information, single=single)
    eigenvalues: FloatArray = np.asarray(np.linalg.eigvalsh(information))
    tolerance = SINGLE_TOLERANCE if single else SYMMETRY_TOLERANCE
    bad = np.argwhere(eigenvalues[..., 0] < -tolerance * np.abs(eigenvalues[..., -1]))
    if len(bad):
        e, j = bad[0].tolist()
        shown = f"eigenvalues from {eigenvalues[e, j, 0]:.6g} to {eigenvalues[e, j, -1]:.6g}"
        raise InputError(f"information[{e}, {j}]", "must be positive semidefinite", shown)
    largest = np.asarray(np.linalg.eigvalsh(prior)[:, -1])
    wrong = is_negative(eigenvalues, SYMMETRY_TOLERANCE) if single else np.zeros(eigenvalues.shape[:2], dtype=np.bool_)
    _check_spread(np.where(wrong[..., None], np.maximum(eigenvalues, 0.0), eigenvalues), largest)
    wrong |= is_negative(eigenvalues) & (-eigenvalues[..., 0] * largest > SIGN.slight)
    if wrong.any():
        _warn_of_repair(eigenvalues[wrong], single=single)
        information = positive_parts(information, wrong)
    return shrunk_to_semidefinite(information), int(wrong.sum())


def is_negative(eigenvalues: FloatArray, share: float = SIGN.rounded) -> BoolArray:
    """Tell whether the smallest of (..., d) ascending eigenvalues is below 0 by more than a share of the largest."""
    return np.asarray(eigenvalues[..., 0] < -share * np.abs(eigenvalues[..., -1]))


def positive_parts(matrices: FloatArray, wrong: BoolArray | None = None) -> FloatArray:
    """Symmetric (..., d, d) matrices, the nearest semidefinite ones instead of those that are ``wrong``.

    By default those with a negative eigenvalue that is more than rounding.
    """
    wrong = is_negative(np.asarray(np.linalg.eigvalsh(matrices))) if wrong is None else wrong
    if not wrong.any():
        return matrices
    values, vectors = np.linalg.eigh(matrices[wrong])
    positive = (vectors * np.maximum(values, 0)[:, None, :]) @ np.swapaxes(vectors, -1, -2)
    repaired = matrices.copy()
    repaired[wrong] = (positive + np.swapaxes(positive, -1, -2)) / 2
    return repaired


def _warn_of_repair(eigenvalues: FloatArray, *, single: bool) -> None:
    share = float((eigenvalues[:, 0] / np.abs(eigenvalues[:, -1])).min())
    kind = "float32 rounding repaired" if single else "negative eigenvalues set to 0"
    text = f"information: {kind} in {len(eigenvalues)} matrices (down to {share:.3g} of the largest eigenvalue)"
    warnings.warn(f"{text}; all values are those of the repaired matrices", UserWarning, stacklevel=4)


def _check_spread(eigenvalues: FloatArray, largest: FloatArray) -> None:
    """Refuse information, of (E, M, d) ``eigenvalues``, beside which a prior of (M,) ``largest`` variance is lost."""
    high, low = eigenvalues[..., -1] * largest, -eigenvalues[..., 0] * largest
    rules = (
        (high, WIDEST, "must be at most {} times the inverse of prior[{}], which would lose its digits beside it"),
        (low, DEEPEST, "must not be negative anywhere by more than {} times the inverse of prior[{}]"),
    )
    for sizes, limit, rule in rules:
        bad = np.argwhere(sizes > limit)
        if len(bad):
            e, j = bad[0].tolist()
            raise InputError(f"information[{e}, {j}]", rule.format(f"{limit:g}", j), f"{sizes[e, j]:.3g} times")


def _check_weights(value: ArrayLike | None, targets: int) -> FloatArray:
    """Return (M,) positive numbers; ones by default."""
    if value is None:
        return np.ones(targets)
    weights = check_finite("weights", value, ndim=1)
    if weights.shape != (targets,):
        raise InputError("weights", f"must have shape ({targets},) to match prior", f"shape {weights.shape}")
    if (weights <= 0).any():
        raise InputError("weights", "must be positive", float(weights.min()))
    if weights.min() < 1 / LARGEST or weights.max() > LARGEST:
        shown = f"{weights.min():.6g} to {weights.max():.6g}"
        raise InputError("weights", f"must be in [{1 / LARGEST:g}, {LARGEST:g}]", shown)
    return weights
