"""The part of a target's state that counts: ``C x`` with an output matrix ``C``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, check_finite, readonly
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["check_output"]


def check_output(output: ArrayLike | None, prior: ArrayLike) -> FloatArray:
    """(M, q, d) matrices of full row rank, from (q, d) for all targets or (M, q, d).

    InputError : another shape, or rows that depend on each other.
    """
    targets, d = check_finite("prior", prior, ndim=3).shape[:2]
    matrices = given = check_finite("output", output)
    if matrices.ndim == 2:
        matrices = np.broadcast_to(matrices, (targets, *matrices.shape))
    if matrices.ndim != 3 or matrices.shape[0] != targets or matrices.shape[2] != d or not 1 <= matrices.shape[1] <= d:
        raise InputError("output", f"must have shape (q, {d}) or ({targets}, q, {d}), 1 <= q <= {d}", given.shape)
    if (np.linalg.matrix_rank(matrices) < matrices.shape[1]).any():
        raise InputError("output", "must have independent rows", given.shape)
    return readonly(matrices)
