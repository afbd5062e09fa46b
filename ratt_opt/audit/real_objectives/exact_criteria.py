"""Trace and log-det criteria of the stored data, free of rounding: rationals, and balls for the logarithm."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import flint

from ratt_opt.errors import InputError
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["ExactCriterion"]


class ExactCriterion:
    """Values of one objective by the definition, on its float64 data read as exact rationals.

    The trace criterion comes out as ``fmpq``; log-det as an ``arb`` ball that contains the true value
    (a comparison of balls is true only when it is certain). Equal values are the same object.

    Raises
    ------
    InputError : the objective is neither criterion.
    """

    def __init__(self, objective: SetFunction) -> None:
        if not isinstance(objective, TraceObjective | LogDetObjective):
            raise InputError("objective", "must be the trace or the log-det criterion", type(objective).__name__)
        self._trace = isinstance(objective, TraceObjective)
        self._priors = [_rational(prior) for prior in objective.prior]
        self._inverses = [prior.inv() for prior in self._priors]
        self._weights = [flint.fmpq(*float(w).as_integer_ratio()) for w in objective.weights]
        self._information = objective.information
        self._known: dict[frozenset[int], Any] = {}
        self._logarithms: dict[tuple[flint.fmpq, ...], flint.arb] = {}

    def __call__(self, elements: Iterable[int]) -> Any:
        """Value of a set of elements."""
        key = frozenset(elements)
        if key not in self._known:
            self._known[key] = self._trace_value(key) if self._trace else self._logdet_value(key)
        return self._known[key]

    def _posterior(self, j: int, elements: frozenset[int]) -> flint.fmpq_mat:
        posterior = self._inverses[j]
        for e in sorted(elements):
            posterior = posterior + _rational(self._information[e, j])
        return posterior

    def _trace_value(self, elements: frozenset[int]) -> flint.fmpq:
        gains = (
            weight * (_trace(prior) - _trace(self._posterior(j, elements).inv()))
            for j, (weight, prior) in enumerate(zip(self._weights, self._priors, strict=True))
        )
        return sum(gains, flint.fmpq(0))

    def _logdet_value(self, elements: frozenset[int]) -> flint.arb:
        ratios = tuple(self._posterior(j, elements).det() * prior.det() for j, prior in enumerate(self._priors))
        if ratios not in self._logarithms:
            logs = (weight * flint.arb(r).log() for weight, r in zip(self._weights, ratios, strict=True))
            self._logarithms[ratios] = sum(logs, flint.arb(0))
        return self._logarithms[ratios]


def _rational(matrix: FloatArray) -> flint.fmpq_mat:
    return flint.fmpq_mat([[flint.fmpq(*float(value).as_integer_ratio()) for value in row] for row in matrix])


def _trace(matrix: flint.fmpq_mat) -> Any:
    return sum((matrix[i, i] for i in range(matrix.nrows())), flint.fmpq(0))
