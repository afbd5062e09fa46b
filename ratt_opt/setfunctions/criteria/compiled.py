"""The criteria of planar targets, compiled as ``two_by_two.py`` has them; imported only where such loops are used.

``code`` is a criterion's ``compiled_code``; matrices are ``(a, b, c)`` triples of ``[[a, b], [b, c]]``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.compiling import numba
from ratt_opt.setfunctions.criteria import two_by_two
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective

__all__ = ["matrix_of_gradient", "target_gradient", "target_value", "team_criterion"]

TRACE, LOG_DET = TraceObjective.compiled_code, LogDetObjective.compiled_code

_determinant = numba.njit(two_by_two.determinant)
_trace_of_inverse = numba.njit(two_by_two.trace_of_inverse)
_largest_of_inverse = numba.njit(two_by_two.largest_of_inverse)
_trace_gradient = numba.njit(two_by_two.trace_gradient)
_logdet_gradient = numba.njit(two_by_two.logdet_gradient)
_of_trace_gradient = numba.njit(two_by_two.matrix_of_trace_gradient)
_of_logdet_gradient = numba.njit(two_by_two.matrix_of_logdet_gradient)


@numba.njit(cache=True)
def team_criterion(code: int, weights: Any, matrices: Any) -> float:
    """Weighted criterion over all targets, lower is better: (M,), (M, 3) -> scalar."""
    total, product = 0.0, 1.0
    for j in range(matrices.shape[0]):
        a, b, c = matrices[j, 0], matrices[j, 1], matrices[j, 2]
        if code == TRACE:
            total += weights[j] * _trace_of_inverse(a, b, c)
        elif code == LOG_DET and weights[j] == weights[0]:
            product *= _determinant(a, b, c)  # one logarithm for many targets
            if product > 1e150 or product < 1e-150:
                total -= weights[0] * np.log(product)
                product = 1.0
        elif code == LOG_DET:
            total -= weights[j] * np.log(_determinant(a, b, c))
        else:
            total = max(total, weights[j] * _largest_of_inverse(a, b, c))
    return total if code != LOG_DET else total - weights[0] * np.log(product)


@numba.njit(cache=True)
def target_value(code: int, weight: float, prior: Any, matrix: Any) -> float:
    """One target's value, trace or log-det, of a triple; minus infinity where it is not positive definite."""
    a, b, c = matrix
    determinant = _determinant(a, b, c)
    if not (determinant > 1e-12 * (a + c) ** 2 and a + c > 0):
        return -np.inf
    if code == TRACE:
        return float(weight * (_trace_of_inverse(prior[0], prior[1], prior[2]) - _trace_of_inverse(a, b, c)))
    return float(weight * np.log(determinant / _determinant(prior[0], prior[1], prior[2])))


@numba.njit(cache=True)
def target_gradient(code: int, weight: float, matrix: Any) -> Any:
    """Slopes in (a, b, c) of one target's value, trace or log-det, at a triple."""
    a, b, c = matrix
    x, y, z = _trace_gradient(a, b, c) if code == TRACE else _logdet_gradient(a, b, c)
    return weight * x, weight * y, weight * z


@numba.njit(cache=True)
def matrix_of_gradient(code: int, weight: float, gradient: Any) -> Any:
    """The triple at which one target's value has a positive definite gradient, given as a triple of a matrix."""
    a, b, c = gradient[0] / weight, gradient[1] / weight, gradient[2] / weight
    return _of_trace_gradient(a, b, c) if code == TRACE else _of_logdet_gradient(a, b, c)
