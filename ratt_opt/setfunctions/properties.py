"""What a set function is: each check returns a witness against the property, or says that there is none.

``None`` is a statement: every set was looked at (or theory decides). Where the ground set is too large for a table,
the answer is a witness or :class:`NotFound`, which is false, counts its trials and claims nothing more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_number
from ratt_opt.progress import Step
from ratt_opt.setfunctions.base import finite_values
from ratt_opt.setfunctions.sampling import TRIALS, NotFound, Violation, sample, slack_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = [
    "NotFound",
    "Violation",
    "find_modularity_violation",
    "find_monotonicity_violation",
    "find_negativity",
    "find_normalisation_violation",
    "find_subadditivity_violation",
    "find_submodularity_violation",
    "mask_without",
]

LARGEST_EXACT = 24
"""Largest ground set whose table is checked exhaustively (128 MiB of float64)."""
LARGEST_DISJOINT = 18
"""Largest ground set whose 3**n disjoint pairs are looked at (under a second)."""
LARGEST_OVERLAPPING = 12
"""Largest ground set whose 4**n pairs are looked at."""
TOLERANCE = 1e-9
"""Default tolerance: a violation must exceed it times the largest absolute value of the function."""


def find_normalisation_violation(f: SetFunction, *, tolerance: float = 0.0) -> Violation | None:
    """Return the empty set as a witness if its value is not 0 (``tolerance`` is absolute: there is no scale to it)."""
    tolerance = check_number("tolerance", tolerance, low=0)
    value = float(finite_values(np.array([f([])]))[0])
    if abs(value) <= tolerance:
        return None
    return Violation(rule="normalised", a=(), b=(), slack=-abs(value), tolerance=tolerance)


@Step("looking for a negative value")
def find_negativity(
    f: SetFunction, *, tolerance: float = TOLERANCE, trials: int = TRIALS, seed: int = 0
) -> Violation | NotFound | None:
    """Return the set with the most negative value, if any; parameters as in :func:`find_monotonicity_violation`."""
    tolerance = check_number("tolerance", tolerance, low=0)
    if f.n > LARGEST_EXACT:
        return sample(f, "non-negative", tolerance, trials=trials, seed=seed)
    values = finite_values(f.table())
    return _witness(f, "non-negative", (int(values.argmin()), 0), values, tolerance)


@Step("looking for a falling value")
def find_monotonicity_violation(
    f: SetFunction, *, tolerance: float = TOLERANCE, trials: int = TRIALS, seed: int = 0
) -> Violation | NotFound | None:
    """Find the set ``a`` and element ``b`` with the most negative marginal ``f(a | b) - f(a)``.

    ``tolerance`` : how negative counts, relative to the largest absolute value of the function
    ``trials``, ``seed`` : of the sampled search, where the ground set has more than 24 elements

    Returns the witness; ``None`` where there is none, by a look at every set (up to 24 elements) or by theory
    (information criteria: added information is positive semidefinite, up to the rounding their input rule admits);
    otherwise :class:`NotFound`, which is false and proves nothing.

    Source: ratt.tex, Section III.
    """
    rule = "non-decreasing"
    tolerance = check_number("tolerance", tolerance, low=0)
    if f.n > LARGEST_EXACT:
        return None if f.is_non_decreasing else sample(f, rule, tolerance, trials=trials, seed=seed)
    from ratt_opt.setfunctions.lattice import marginal_ends

    values = finite_values(f.table())
    if f.n == 0:
        return None
    x = int(marginal_ends(values, f.n)[0].argmin())
    sets = values.reshape(-1, 2, 1 << x)
    base = mask_without(int((sets[:, 1] - sets[:, 0]).argmin()), x)
    return _witness(f, rule, (base, 1 << x), values, tolerance)


@Step("looking for a violation of submodularity")
def find_submodularity_violation(
    f: SetFunction, *, tolerance: float = TOLERANCE, trials: int = TRIALS, seed: int = 0
) -> Violation | NotFound | None:
    """Find sets ``a = S + x`` and ``b = S + y`` that break ``f(a) + f(b) >= f(a | b) + f(a & b)`` most.

    Parameters and result are those of :func:`find_monotonicity_violation`; theory decides for log-det.

    Source: the definition by second differences, equivalent to all pairs of sets.
    """
    if f.n > LARGEST_EXACT and f.is_submodular:
        return None
    return _second_order(f, "submodular", tolerance, trials, seed)


@Step("looking for a violation of modularity")
def find_modularity_violation(
    f: SetFunction, *, tolerance: float = TOLERANCE, trials: int = TRIALS, seed: int = 0
) -> Violation | NotFound | None:
    """Find sets ``a = S + x`` and ``b = S + y`` with the largest ``|f(a) + f(b) - f(a | b) - f(a & b)|``.

    Parameters and result are those of :func:`find_monotonicity_violation`.
    """
    return _second_order(f, "modular", tolerance, trials, seed)


@Step("looking for a violation of subadditivity")
def find_subadditivity_violation(
    f: SetFunction, *, tolerance: float = TOLERANCE, trials: int = TRIALS, seed: int = 0
) -> Violation | NotFound | None:
    """Find sets that break ``f(a) + f(b) >= f(a | b)`` most.

    A non-negative submodular function has none. A non-decreasing one has one only if a disjoint pair is one
    (``f(b - a) <= f(b)``): 3**n pairs, up to 18 elements. Other functions: all 4**n pairs, up to 12 elements, as no
    faster exact way is known. Beyond: sampled. Parameters and result are those of
    :func:`find_monotonicity_violation`.
    """
    rule = "subadditive"
    tolerance = check_number("tolerance", tolerance, low=0)
    if f.n <= LARGEST_EXACT:
        values = finite_values(f.table())
        limit = 0.0  # theory needs the premises exactly
        if values.min() >= 0 and _second_order(f, "submodular", limit, trials, seed) is None:
            return None
        monotone = f.n <= LARGEST_DISJOINT and find_monotonicity_violation(f, tolerance=limit) is None
        if monotone or f.n <= LARGEST_OVERLAPPING:
            from ratt_opt.setfunctions.lattice import disjoint_slack, overlapping_slack

            _, a, b = (disjoint_slack if monotone else overlapping_slack)(values)
            return _witness(f, rule, (int(a), int(b)), values, tolerance)
    return sample(f, rule, tolerance, trials=trials, seed=seed)


def _second_order(f: SetFunction, rule: str, tolerance: float, trials: int, seed: int) -> Violation | NotFound | None:
    tolerance = check_number("tolerance", tolerance, low=0)
    if f.n > LARGEST_EXACT:
        return sample(f, rule, tolerance, trials=trials, seed=seed)
    if f.n < 2:
        return None
    from ratt_opt.setfunctions.lattice import second_differences

    values = finite_values(f.table())
    slack = second_differences(values, f.n)
    if rule == "modular":
        slack = np.minimum(slack, second_differences(-values, f.n))
    i, j = (int(k) for k in np.unravel_index(int(slack.argmin()), slack.shape))
    if i == j:  # every slack of a pair is positive
        return None
    return _witness(f, rule, _worst_pair(values, i, j, rule), values, tolerance)


def _worst_pair(values: FloatArray, i: int, j: int, rule: str) -> tuple[int, int]:
    """Masks ``S + i`` and ``S + j`` with the smallest slack over ``S``."""
    v = values.reshape(-1, 2, 1 << (j - i - 1), 2, 1 << i)
    slack = (v[:, 0, :, 1] - v[:, 0, :, 0]) - (v[:, 1, :, 1] - v[:, 1, :, 0])
    where = int((-np.abs(slack) if rule == "modular" else slack).argmin())
    base = mask_without(mask_without(where, i), j)
    return base | 1 << i, base | 1 << j


def mask_without(position: int, bit: int) -> int:
    """The ``position``-th mask among those without one bit."""
    low = position & ((1 << bit) - 1)
    return (position ^ low) << 1 | low


def _witness(
    f: SetFunction, rule: str, masks: tuple[int, int], values: FloatArray, tolerance: float
) -> Violation | None:
    """Return the pair of sets as a violation, its slack recomputed from the table."""
    first, second = (np.array([mask]) for mask in masks)
    slack = float(slack_of(values.take, rule, first, second)[0])
    limit = tolerance * max(float(values.max()), -float(values.min()))
    if slack >= -limit:
        return None
    members = [tuple(e for e in range(f.n) if mask >> e & 1) for mask in masks]
    return Violation(rule=rule, a=members[0], b=members[1], slack=slack, tolerance=limit)
