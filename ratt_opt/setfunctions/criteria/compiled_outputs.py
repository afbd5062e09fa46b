"""Outputs' covariances and their traces, compiled: searches ask for them by the hundred thousand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["output_covariances", "output_traces"]


def output_traces(matrices: FloatArray, output: FloatArray) -> FloatArray:
    """``tr(C_j L_j^{-1} C_j')`` of (..., M, d, d) positive definite matrices and outputs (M, q, d): (..., M)."""
    flat = np.ascontiguousarray(matrices).reshape(-1, *matrices.shape[-3:])
    return np.asarray(_traces(flat, np.ascontiguousarray(output)).reshape(matrices.shape[:-2]))


def output_covariances(matrices: FloatArray, output: FloatArray) -> FloatArray:
    """``C_j L_j^{-1} C_j'`` likewise: (..., M, q, q)."""
    flat = np.ascontiguousarray(matrices).reshape(-1, *matrices.shape[-3:])
    q = output.shape[-2]
    return np.asarray(_covariances(flat, np.ascontiguousarray(output)).reshape(*matrices.shape[:-2], q, q))


@numba.njit(cache=True)
def _factorise(matrix: Any, factor: Any) -> None:
    """Cholesky's ``matrix = factor factor'``."""
    for a in range(len(matrix)):
        for b in range(a + 1):
            left = matrix[a, b]
            for c in range(b):
                left -= factor[a, c] * factor[b, c]
            factor[a, b] = np.sqrt(left) if a == b else left / factor[b, b]


@numba.njit(cache=True)
def _solve(factor: Any, row: Any, solved: Any) -> None:
    """``factor solved = row``."""
    for a in range(len(row)):
        left = row[a]
        for c in range(a):
            left -= factor[a, c] * solved[c]
        solved[a] = left / factor[a, a]


@numba.njit(cache=True)
def _traces(matrices: Any, output: Any) -> Any:
    """With ``L = G G'``: the sum of squares of ``G^{-1} C'``. (K, M, d, d), (M, q, d) -> (K, M)."""
    count, targets, d = matrices.shape[:3]
    found = np.empty((count, targets))
    factor, solved = np.zeros((d, d)), np.zeros(d)
    for k in range(count):
        for j in range(targets):
            _factorise(matrices[k, j], factor)
            total = 0.0
            for row in range(output.shape[1]):
                _solve(factor, output[j, row], solved)
                for a in range(d):
                    total += solved[a] * solved[a]
            found[k, j] = total
    return found


@numba.njit(cache=True)
def _covariances(matrices: Any, output: Any) -> Any:
    """With ``L = G G'``: inner products of the columns of ``G^{-1} C'``. (K, M, d, d), (M, q, d) -> (K, M, q, q)."""
    count, targets, d = matrices.shape[:3]
    q = output.shape[1]
    found = np.empty((count, targets, q, q))
    factor, solved = np.zeros((d, d)), np.zeros((q, d))
    for k in range(count):
        for j in range(targets):
            _factorise(matrices[k, j], factor)
            for row in range(q):
                _solve(factor, output[j, row], solved[row])
                for other in range(row + 1):
                    total = 0.0
                    for a in range(d):
                        total += solved[row, a] * solved[other, a]
                    found[k, j, row, other] = found[k, j, other, row] = total
    return found
