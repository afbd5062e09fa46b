"""Paired intervals as words: what pays, what costs, and what makes no visible difference."""

from enum import Enum

import numpy as np
from numpy.typing import ArrayLike

from ratt_opt.studies.statistics import Estimate, estimate

__all__ = ["Outcome", "outcome", "relative_change"]


class Outcome(Enum):
    """Verdict of a 95 % interval of a change, if less is better."""

    PAYS = "pays"
    COSTS = "costs"
    UNSEEN = "no difference seen"


def outcome(change: Estimate) -> Outcome:
    """Return on which side of zero the interval lies, if on one."""
    if change.high < 0:
        return Outcome.PAYS
    return Outcome.COSTS if change.low > 0 else Outcome.UNSEEN


def relative_change(left: ArrayLike, right: ArrayLike) -> Estimate:
    """Mean of ``left`` over that of ``right``, less one, of paired trials; the interval knows that both are estimates.

    The ratio estimator: around ``R = mean(left) / mean(right)`` its error is that of the mean of ``left - R right``
    over the mean of ``right``, to first order. Source: Cochran, Sampling Techniques (1977), section 6.3.
    """
    ours, theirs = np.asarray(left, dtype=np.float64), np.asarray(right, dtype=np.float64)
    ratio, scale = float(ours.mean() / theirs.mean()), float(theirs.mean())
    rest = estimate((ours - ratio * theirs) / scale)
    return Estimate(ratio - 1, ratio - 1 + rest.low, ratio - 1 + rest.high, rest.n)
