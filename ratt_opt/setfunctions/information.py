"""Common part of all criteria of the posterior information matrices.

For a set ``S`` of elements, target ``j``'s posterior information is
``Lambda_j(S) = prior[j]^{-1} + sum_{e in S} information[e, j]``. Every criterion
is normalised, non-decreasing in ``S`` and concave in ``Lambda``; each has a file under ``criteria/``.
"""

from __future__ import annotations

from copy import copy
from math import isqrt
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, readonly
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.checked_matrices import check_information, check_output, check_prior, check_weights
from ratt_opt.setfunctions.criterion_parts import CriterionParts
from ratt_opt.setfunctions.rounding_errors import inverse_error, negative_parts
from ratt_opt.setfunctions.target_parts import TargetParts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike

    from ratt_opt.setfunctions.decomposition import Decomposition

__all__ = ["InformationObjective", "from_triangles", "packed", "symmetric_inverse", "triangles"]


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
    output : the part of the state that counts, (q, d) or (M, q, d) of full row rank, for criteria that support it;
        ``None`` for all of it

    Raises
    ------
    InputError : a shape, symmetry, definiteness or sign rule is broken, or rows of ``output`` depend on each other.

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
        "output",
        "prior",
        "prior_information",
        "repaired",
        "weights",
    )

    is_non_decreasing: ClassVar[bool] = True
    """Added information is positive semidefinite, up to the rounding that the input rule admits."""

    supports_output: ClassVar[bool] = False
    """True if the criterion's formulas hold for a part of the state, ``output``."""

    def __init__(
        self,
        prior: ArrayLike,
        information: ArrayLike,
        weights: ArrayLike | None = None,
        *,
        output: ArrayLike | None = None,
    ) -> None:
        if output is not None and not self.supports_output:
            raise InputError("output", "must be None for a criterion of whole states", type(self).__name__)
        self.prior: FloatArray = readonly(check_prior(prior))
        checked, self.repaired = check_information(information, self.prior)
        self.information: FloatArray = readonly(checked)
        self.weights: FloatArray = readonly(check_weights(weights, self.n_targets))
        self.output: FloatArray | None = None if output is None else readonly(check_output(output, self.prior))
        self.prior_information: FloatArray = readonly(symmetric_inverse(self.prior))
        # The baseline is computed by the same formula as the posterior, so that f(empty set) is exactly 0.
        is_own_value = self.overrides("value") and not self.overrides("criterion")
        baseline = np.zeros(self.n_targets) if is_own_value else self.criterion(self.prior_information)
        self._baseline: FloatArray = readonly(baseline)
        self.condition: FloatArray = readonly(self._condition())
        self._singletons: FloatArray | None = None
        self._inverse_error: FloatArray | None = None
        self._negative_parts: FloatArray | None = None
        self.check_formula()

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
        one.output = None if self.output is None else readonly(self.output[own])
        one._singletons = one._inverse_error = None
        return one

    def with_information(self, information: ArrayLike) -> Self:
        """Replace the elements: information (E, M, d, d), checked."""
        other = copy(self)
        checked, other.repaired = check_information(information, self.prior)
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

    @property
    def compiled_code(self) -> int | None:
        """Number of the criterion in the compiled code, if that has it; it knows criteria of whole states only."""
        return self.native_kernel if self.output is None else None

    @property
    def stated(self) -> dict[str, Any]:
        """The output matrices, row by row."""
        return {} if self.output is None else {"output": self.output.reshape(self.n_targets, -1).tolist()}

    def counted(self, covariance: FloatArray) -> FloatArray:
        """Covariances of the part of the state that counts: (..., M, d, d) -> (..., M, q, q)."""
        if self.output is None:
            return covariance
        return np.asarray(self.output @ covariance @ np.swapaxes(self.output, -1, -2))

    def counted_size(self, size: FloatArray) -> FloatArray:
        """(..., M) no less than the weighted trace of what counts of such a covariance: ``w_j |C_j|^2 size_j``."""
        squares = float(self.dimension) if self.output is None else np.square(self.output).sum(axis=(-2, -1))
        return np.asarray(self.weights * squares * size)

    def criterion_of_one(self, matrices: FloatArray, target: int) -> FloatArray:
        """(K,) weighted criterion of one target for its posterior information (K, d, d), by the formula for one target.

        For criteria without data of targets beside the weights and ``output``.
        """
        one, only = copy(self), slice(target, target + 1)
        one.weights = self.weights[only]
        one.output = None if self.output is None else self.output[only]
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
