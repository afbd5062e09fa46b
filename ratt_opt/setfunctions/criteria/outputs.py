"""The part of a target's state that counts: ``C x`` with an output matrix ``C``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from ratt_opt._validation import FloatArray, check_finite, readonly
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.information import LARGEST, InformationObjective

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["StateCriterion"]

LARGEST_OUTPUT = LARGEST**0.5
"""Largest entry of an output, and inverse of the least: squares have the size that entries of a prior may have."""


class StateCriterion(InformationObjective):
    """A criterion of targets' whole states or, with ``output``, of a part of them.

    The latter has formulas of its own: a class that is made if ``output`` is given.
    """

    __slots__ = ("output",)

    output: FloatArray | None
    of_part: ClassVar[type[StateCriterion]]
    """Class for a part of the state; a subclass of the one for whole states."""

    def __new__(cls, *_: Any, output: ArrayLike | None = None, **__: Any) -> Self:
        """An instance of the class that has the formulas."""
        kind = cls.of_part if output is not None and cls.of_part.__mro__[1] is cls else cls
        made: Self = object.__new__(kind)  # type: ignore[assignment]
        return made

    def __init__(
        self,
        prior: ArrayLike,
        information: ArrayLike,
        weights: ArrayLike | None = None,
        *,
        output: ArrayLike | None = None,
    ) -> None:
        is_of_part = isinstance(self, self.of_part)
        if output is not None and not is_of_part:
            known = self.of_part.__mro__[1].__name__
            raise InputError("output", f"must be None for a criterion other than {known}", type(self).__name__)
        self.output = _check_output(output, prior) if is_of_part else None
        super().__init__(prior, information, weights)

    def of_target(self, target: int) -> Self:
        """Return the criterion of one target alone."""
        one = super().of_target(target)
        one.output = None if self.output is None else readonly(self.output[target : target + 1])
        return one

    def error_scale(self, size: FloatArray) -> FloatArray:
        """(..., M) no less than the weighted trace of what counts of such a covariance: ``w_j |C_j|^2 size_j``."""
        squares = float(self.dimension) if self.output is None else np.square(self.output).sum(axis=(-2, -1))
        return np.asarray(self.weights * squares * size)

    @property
    def stated(self) -> dict[str, Any]:
        """The output matrices, row by row."""
        return {} if self.output is None else {"output": self.output.reshape(self.n_targets, -1).tolist()}


def _check_output(output: ArrayLike | None, prior: ArrayLike) -> FloatArray:
    """(M, q, d) matrices of full row rank, from (q, d) for all targets or (M, q, d).

    InputError : another shape, an entry whose square is no float, or rows that depend on each other.
    """
    targets, d = check_finite("prior", prior, ndim=3).shape[:2]
    matrices = given = check_finite("output", output)
    if matrices.ndim == 2:
        matrices = np.broadcast_to(matrices, (targets, *matrices.shape))
    if matrices.ndim != 3 or matrices.shape[0] != targets or matrices.shape[2] != d or not 1 <= matrices.shape[1] <= d:
        raise InputError("output", f"must have shape (q, {d}) or ({targets}, q, {d}), 1 <= q <= {d}", given.shape)
    sizes = np.abs(matrices).max(axis=-1)
    if sizes.max() > LARGEST_OUTPUT or sizes.min() < 1 / LARGEST_OUTPUT:
        rule = f"must have rows whose largest entry has a size in [{1 / LARGEST_OUTPUT:g}, {LARGEST_OUTPUT:g}]"
        raise InputError("output", rule, float(sizes.max() if sizes.max() > LARGEST_OUTPUT else sizes.min()))
    if (np.linalg.matrix_rank(matrices) < matrices.shape[1]).any():
        raise InputError("output", "must have independent rows", given.shape)
    return readonly(matrices)
