"""Traces of outputs' covariances, compiled: searches ask for them by the hundred thousand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.compiling import numba

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["output_traces"]


def output_traces(matrices: FloatArray, output: FloatArray) -> FloatArray:
    """``tr(C_j L_j^{-1} C_j')`` of (..., M, d, d) positive definite matrices and outputs (M, q, d): (..., M)."""
    flat = np.ascontiguousarray(matrices).reshape(-1, *matrices.shape[-3:])
    return np.asarray(_traces(flat, np.ascontiguousarray(output)).reshape(matrices.shape[:-2]))


@numba.njit(cache=True)
def _traces(matrices: Any, output: Any) -> Any:
    """By Cholesky's factor ``L = G G'``: the sum of squares of ``G^{-1} C'``. (K, M, d, d), (M, q, d) -> (K, M)."""
    count, targets, d = matrices.shape[:3]
    q = output.shape[1]
    found = np.empty((count, targets))
    factor, solved = np.zeros((d, d)), np.zeros(d)
    for k in range(count):
        for j in range(targets):
            for a in range(d):
                for b in range(a + 1):
                    left = matrices[k, j, a, b]
                    for c in range(b):
                        left -= factor[a, c] * factor[b, c]
                    factor[a, b] = np.sqrt(left) if a == b else left / factor[b, b]
            total = 0.0
            for row in range(q):
                for a in range(d):
                    left = output[j, row, a]
                    for c in range(a):
                        left -= factor[a, c] * solved[c]
                    solved[a] = left / factor[a, a]
                    total += solved[a] * solved[a]
            found[k, j] = total
    return found
