"""Symmetric matrices as their lower triangles: the form in which certificates state them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["packed", "packed_inverse"]


def packed(matrices: FloatArray) -> list[Any]:
    """Lower triangles, row by row: (..., d, d) -> nested lists of shape (..., d (d + 1) / 2)."""
    rows, columns = np.tril_indices(matrices.shape[-1])
    triangles: list[Any] = matrices[..., rows, columns].tolist()
    return triangles


def packed_inverse(matrices: FloatArray) -> list[Any]:
    """:func:`packed` symmetric inverses."""
    inverse = np.linalg.inv(matrices)
    return packed((inverse + np.swapaxes(inverse, -1, -2)) / 2)
