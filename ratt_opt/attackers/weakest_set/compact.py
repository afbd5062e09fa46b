"""A plan against targets with two-dimensional states, as arrays for the compiled loops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["LOG_DET", "MAX_EIGENVALUE", "TRACE", "CompactTeam", "triples"]

TRACE, LOG_DET, MAX_EIGENVALUE = 0, 1, 2

KINDS: dict[type, int] = {TraceObjective: TRACE, LogDetObjective: LOG_DET, MaxEigenvalueObjective: MAX_EIGENVALUE}


@dataclass(frozen=True, slots=True)
class CompactTeam:
    """Information as ``(a, b, c)`` triples of ``[[a, b], [b, c]]``.

    ``kind`` : TRACE, LOG_DET or MAX_EIGENVALUE; ``weights`` : (M,); ``prior`` : (M, 3) prior information;
    ``information`` : (N, M, 3) of each robot's chosen element; ``single`` : (N,) individual values
    """

    kind: int
    weights: FloatArray
    prior: FloatArray
    information: FloatArray
    single: FloatArray

    @classmethod
    def of(cls, objective: SetFunction, plan: IntArray) -> CompactTeam | None:
        """The compact form, or ``None`` where the objective is of another class or dimension."""
        kind = KINDS.get(type(objective))
        if kind is None or not isinstance(objective, InformationObjective) or objective.dimension != 2:
            return None
        weights, prior = np.array(objective.weights), triples(objective.prior_information)
        information = triples(objective.information[plan])
        single = _criterion(kind, weights, prior) - _criterion(kind, weights, prior + information)
        return cls(kind, weights, prior, information, single)

    def sums(self, robots: Iterable[int]) -> FloatArray:
        """(M, 3) posterior information of a set of robots."""
        return np.asarray(self.prior + self.information[sorted(robots)].sum(axis=0))

    def values(self, sums: FloatArray) -> FloatArray:
        """Values of posterior information: (..., M, 3) -> (...)."""
        return np.asarray(_criterion(self.kind, self.weights, self.prior) - _criterion(self.kind, self.weights, sums))

    def value(self, robots: Iterable[int]) -> float:
        """Value of one set of robots."""
        return float(self.values(self.sums(robots)))


def triples(matrices: FloatArray) -> FloatArray:
    """(..., 2, 2) symmetric matrices as (..., 3)."""
    return np.ascontiguousarray(np.stack([matrices[..., 0, 0], matrices[..., 0, 1], matrices[..., 1, 1]], axis=-1))


def _criterion(kind: int, weights: FloatArray, sums: FloatArray) -> FloatArray:
    a, b, c = sums[..., 0], sums[..., 1], sums[..., 2]
    determinant = a * c - b * b
    if kind == TRACE:
        return np.asarray((weights * (a + c) / determinant).sum(axis=-1))
    if kind == LOG_DET:
        return np.asarray(-(weights * np.log(determinant)).sum(axis=-1))
    half = (a - c) / 2
    return np.asarray((weights * ((a + c) / 2 + np.sqrt(half * half + b * b)) / determinant).max(axis=-1))
