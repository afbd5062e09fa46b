"""Means of paired trials with their uncertainty, and verdicts on claims."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from numpy.typing import ArrayLike

    from ratt_opt._validation import FloatArray

__all__ = ["Estimate", "Mean", "Verdict", "column", "estimate", "headed", "judge", "players", "select"]

LEVEL = 0.95
"""Confidence of every interval."""
UNITS = {"trace": "m²", "mse": "m²", "rmse": "m", "final": "m", "largest": "m", "optimum/trace_bound": "m²"}
"""Units of metrics; values have that of their criterion,"""
VALUES = ("value", "proved", "optimum/lower", "optimum/upper")
"""and these are values."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean over ``n`` trials with its 95 % confidence interval (Student's t; infinite for one trial)."""

    mean: float
    low: float
    high: float
    n: int

    def among(self, m: int) -> Estimate:
        """Return the wider interval that holds together with those of ``m - 1`` others (Bonferroni)."""
        from scipy.stats import t

        if self.n < 2 or m < 2:
            return self
        wider = (self.high - self.mean) * float(t.ppf(1 - (1 - LEVEL) / (2 * m), self.n - 1)) / _quantile(self.n)
        return Estimate(self.mean, self.mean - wider, self.mean + wider, self.n)

    def at_least(self, least: float) -> Estimate:
        """Return the interval cut off at ``least``, below which the true mean cannot be: it holds as often."""
        return Estimate(self.mean, max(self.low, least), max(self.high, least), self.n)

    def text(self) -> str:
        """Return ``mean [low, high]`` to four digits; the mean alone of a single trial."""
        mean, low, high = (f"{number + 0.0:.4g}" for number in (self.mean, self.low, self.high))
        return mean if self.n < 2 else f"{mean} [{low}, {high}]"

    def show(self, scale: float = 1.0) -> str:
        """Return ``mean [low, high]``, times ``scale``, to three digits and no more than twelve decimals."""
        mean, low, high = (round(scale * number, 12) + 0.0 for number in (self.mean, self.low, self.high))
        return f"{mean:+.3g} [{low:+.3g}, {high:+.3g}]"


@dataclass(frozen=True, slots=True, kw_only=True)
class Mean:
    """A metric's mean over the trials of a case, with its 95 % interval.

    ``planner``, ``attacker`` : empty for what a study measures once a trial.
    ``minus`` : the planner whose metric is taken off, trial by trial, or empty.
    """

    case: str
    planner: str
    attacker: str
    metric: str
    estimate: Estimate
    minus: str = ""


class Verdict(Enum):
    """Verdict of the intervals of all cases of a claim together."""

    CONFIRMED = "confirmed"
    """Every case's interval is on the claimed side (an intersection-union test: no correction is needed)."""
    ON_AVERAGE = "confirmed on average"
    """The interval of the mean over cases is on the claimed side, and no case contradicts."""
    NOT_CONFIRMED = "not confirmed"
    """Neither."""
    CONTRADICTED = "contradicted"
    """Some case's interval lies wholly on the other side, also when corrected for the number of cases."""


def estimate(values: ArrayLike) -> Estimate:
    """Mean of independent trials, with its interval; for a paired difference pass the differences."""
    array = np.asarray(values, dtype=np.float64)
    mean, n = float(array.mean()), len(array)
    if n < 2:
        return Estimate(mean, -np.inf, np.inf, n)
    half = _quantile(n) * float(array.std(ddof=1)) / n**0.5
    return Estimate(mean, mean - half, mean + half, n)


def _quantile(n: int) -> float:
    from scipy.stats import t

    return float(t.ppf((1 + LEVEL) / 2, n - 1))


def judge(cases: Collection[Estimate], average: Estimate, *, below: float = 0.0) -> Verdict:
    """Judge the claim that the mean of every case is below ``below``; ``average`` is of the mean over cases."""
    if all(e.high < below for e in cases):
        return Verdict.CONFIRMED
    if any(e.among(len(cases)).low > below for e in cases):
        return Verdict.CONTRADICTED
    return Verdict.ON_AVERAGE if average.high < below else Verdict.NOT_CONFIRMED


def select(rows: Iterable[Mapping[str, str]], **factors: object) -> list[Mapping[str, str]]:
    """Rows whose factors have the given values, in the order of the table (case, then trial)."""
    return [row for row in rows if all(row[name] == str(value) for name, value in factors.items())]


def column(rows: Sequence[Mapping[str, str]], name: str) -> FloatArray:
    """(T,) one column as numbers."""
    return np.array([float(row[name]) for row in rows])


def players(rows: Sequence[Mapping[str, str]], metric: str) -> dict[str, tuple[str, ...]]:
    """The planners that meet each attacker in the columns ``planner/attacker/metric``, in their order."""
    found: dict[str, list[str]] = {}
    for name in rows[0]:
        planner, attacker, of, *rest = (*name.split("/"), "", "")
        if of == metric and not any(rest):
            found.setdefault(attacker, []).append(planner)
    return {attacker: tuple(planners) for attacker, planners in found.items()}


def headed(metric: str, unit: str = "", minus: str = "") -> str:
    """A metric with its unit, and the planner whose is taken off.

    ``unit`` : of values, which have that of their criterion; empty if it is not known
    """
    own = unit if metric in VALUES else UNITS.get(metric, "")
    what = f"{metric}, difference from {minus}" if minus else metric
    return f"{what} [{own}]" if own else what
