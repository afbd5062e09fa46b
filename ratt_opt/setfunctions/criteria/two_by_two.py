"""Criteria of symmetric matrices ``[[a, b], [b, c]]`` in closed form, from arrays of their entries."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = [
    "congruent",
    "determinant",
    "eigenvalues",
    "largest_of_inverse",
    "logdet_gradient",
    "trace_gradient",
    "trace_of_inverse",
    "triples",
]


def determinant(a: Any, b: Any, c: Any) -> Any:
    """``det L``."""
    return a * c - b * b


def congruent(r: Any, a: Any, b: Any, c: Any) -> Any:
    """Entries of ``R L R``, ``R`` symmetric of entries ``r`` = three arrays."""
    p, q, s = r
    first, second, third, fourth = p * a + q * b, p * b + q * c, q * a + s * b, q * b + s * c
    return first * p + second * q, first * q + second * s, third * q + fourth * s


def eigenvalues(a: Any, b: Any, c: Any) -> Any:
    """The smaller and the larger eigenvalue of ``L``."""
    mean, radius = (a + c) / 2, np.hypot((a - c) / 2, b)
    return mean - radius, mean + radius


def trace_of_inverse(a: Any, b: Any, c: Any) -> Any:
    """``tr(L^{-1}) = tr(L) / det(L)``."""
    return (a + c) / (a * c - b * b)


def largest_of_inverse(a: Any, b: Any, c: Any) -> Any:
    """``lambda_max(L^{-1}) = lambda_max(L) / det(L)``, free of cancellation in the numerator."""
    half = (a - c) / 2
    return ((a + c) / 2 + np.sqrt(half * half + b * b)) / (a * c - b * b)


def logdet_gradient(a: Any, b: Any, c: Any) -> Any:
    """Derivatives of ``log det L`` in ``a``, ``b`` and ``c``: the inverse, its off-diagonal entry twice."""
    det = a * c - b * b
    return c / det, -2 * b / det, a / det


def trace_gradient(a: Any, b: Any, c: Any) -> Any:
    """Derivatives of ``-tr(L^{-1})`` in ``a``, ``b`` and ``c``: ``L^{-2}``, its off-diagonal entry twice."""
    det = a * c - b * b
    p, q, r = c / det, -b / det, a / det
    return p * p + q * q, 2 * (q * (p + r)), q * q + r * r


def triples(matrices: Any) -> Any:
    """(..., 2, 2) symmetric matrices as (..., 3)."""
    return np.ascontiguousarray(np.stack([matrices[..., 0, 0], matrices[..., 0, 1], matrices[..., 1, 1]], axis=-1))
