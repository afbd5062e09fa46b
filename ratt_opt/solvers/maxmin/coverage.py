"""Coverage as a trace: sums of best elements that the search for information criteria solves.

An item of weight ``w`` becomes a target of prior variance 1 and weight ``w``, of which each element that covers it has
the information ``I``. Unseen it is worth 0, else ``w (1 - 1 / (1 + n I))`` for some ``n >= 1``. So the trace is at most
the coverage, and the coverage at most ``1 + 1 / I`` times the trace, for every set; both ends carry over. If all
weights are whole, so is every value: ends move inward to multiples of the weights' greatest common divisor. A part that
is worth its best element is a sum of items, one for each step between its utilities: an element covers the steps up to
its own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.best_elements import BestElements
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.maxmin.params import or_default

if TYPE_CHECKING:
    from typing import Self

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.params import CoverageParams
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["CoverageTrace"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CoverageTrace:
    """``problem`` : that of the trace, on the same elements; no set covers more than ``factor`` times its value."""

    problem: Problem
    factor: float
    rounding: float
    """Factor by which the computed weights may be off."""
    unit: float
    """All values are multiples of it, unless it is 0."""

    @classmethod
    def of(cls, problem: Problem, params: CoverageParams | None = None) -> Self | None:
        """The trace of a sum of best elements; ``None`` for other functions, and if it would be too large."""
        f, params = problem.objective, or_default(None).coverage if params is None else params
        if not isinstance(f, BestElements):
            return None
        covers, weights = _items(f, params.most_entries)
        if not len(weights) or covers.size > params.most_entries:
            return None
        information = params.information * covers[..., None, None].astype(np.float64)
        trace = TraceObjective(np.ones((len(weights), 1, 1)), information, weights)
        rounding = float(1 + 16 * len(weights) * np.finfo(np.float64).eps)
        factor = (1 + 1 / params.information) * rounding
        return cls(problem=replace(problem, objective=trace), factor=factor, rounding=rounding, unit=f.spacing)

    def gap(self, gap: float) -> float:
        """Return the gap to search the trace to, for a gap of the sum: no less than what lies between the two."""
        return max(gap, 2 * (self.factor - 1))

    def carried_over(self, found: MaxMinResult) -> MaxMinResult:
        """The result for the sum of best elements; it has no proof in the form of certificates."""
        lower, upper = found.lower / self.rounding, found.upper * self.factor
        if self.unit > 0:
            lower, upper = (self.unit * float(end) for end in (np.ceil(lower / self.unit), np.floor(upper / self.unit)))
        return replace(
            found, lower=lower, upper=upper, proof=None, worst_case=None, posterior_gap=None, unattacked=None
        )


def _items(f: BestElements, most: int) -> tuple[BoolArray, FloatArray]:
    """Items (n, M) that elements cover, and their weights (M,); equal items are one. Ends early beyond ``most``."""
    merged: dict[bytes, float] = {}
    for covering, weight in f.items():
        key = covering.tobytes()
        merged[key] = merged.get(key, 0.0) + weight
        if len(merged) * f.n > most:
            break
    kept = {key: weight for key, weight in merged.items() if weight > 0}
    covers = np.array([np.frombuffer(key, dtype=np.bool_) for key in kept]).reshape(len(kept), f.n)
    return covers.T, np.array(list(kept.values()))
