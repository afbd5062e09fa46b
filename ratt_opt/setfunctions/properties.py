"""Checks of properties of set functions: each returns a witness against the property, or says that none exists.

``None`` is a statement: every set was looked at (or theory decides). If the ground set is too large for a table, or
the time too short, the answer is a witness or :class:`NotFound`, which is false, counts its trials and claims nothing
more. An interrupt propagates.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_number
from ratt_opt.budget import Budget, OutOfBudget, Stop
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.base import checked_values, finite_values
from ratt_opt.setfunctions.evaluation_error import value_error
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.lattice import disjoint_slack, marginal_ends, overlapping_slack, second_differences
from ratt_opt.setfunctions.metered import table_within
from ratt_opt.setfunctions.property_params import DEFAULT, PropertyParams
from ratt_opt.setfunctions.sampling import INEQUALITIES, NotFound, Violation, sample, slack_of

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


@dataclass(frozen=True, slots=True)
class _Question:
    """Question whether ``f`` keeps a rule within a tolerance; ``trials``, ``seed`` : of the sampled search."""

    f: SetFunction
    rule: str
    tolerance: float
    trials: int
    seed: int
    budget: Budget
    params: PropertyParams

    def __post_init__(self) -> None:
        """InputError : the tolerance is not a number >= 0."""
        check_number("tolerance", self.tolerance, low=0)

    def table(self) -> FloatArray | None:
        """The table of ``f``; ``None`` if it is too large, or not complete in its share of the time."""
        if self.f.n > self.params.tabulated:
            return None
        try:
            return finite_values(table_within(self.f, self.budget.part(self.params.table_share)))
        except OutOfBudget as out:
            if out.stop is Stop.INTERRUPTED:
                raise
            return None

    def sampled(self) -> Violation | NotFound:
        """Search random sets for a violation."""
        return sample(
            self.f,
            self.rule,
            self.tolerance,
            rounding=self.rounding,
            trials=self.trials,
            seed=self.seed,
            budget=self.budget,
            params=self.params,
        )

    @property
    def rounding(self) -> float:
        """Bound on the error of a slack: one error for each value in it."""
        f, values = self.f, 1 if self.rule == "non-negative" else len(INEQUALITIES[self.rule].split("f(")) - 1
        if isinstance(f, InformationObjective):
            return values * value_error(f, list(np.arange(f.n)[:, None]), 0.0)
        return values * f.rounding

    def witness(self, masks: tuple[int, int], values: FloatArray) -> Violation | NotFound | None:
        """Return the pair of sets as a violation, its slack recomputed from the table.

        ``None`` if it is none within the tolerance; :class:`NotFound` if it is one, but no larger than rounding.
        """
        first, second = (np.array([mask]) for mask in masks)
        slack = float(slack_of(values.take, self.rule, first, second)[0])
        limit = self.tolerance * max(float(values.max()), -float(values.min()))
        if slack >= -limit:
            return None
        if slack >= -(rounding := self.rounding):
            stop, trials = Stop.EXHAUSTED, len(values)
            return NotFound(rule=self.rule, trials=trials, smallest_slack=slack, tolerance=rounding, stop=stop)
        a, b = (tuple(e for e in range(self.f.n) if mask >> e & 1) for mask in masks)
        return Violation(rule=self.rule, a=a, b=b, slack=slack, tolerance=limit)


def find_normalisation_violation(f: SetFunction, *, tolerance: float = 0.0) -> Violation | None:
    """Return the empty set as a witness if its value is not 0 (``tolerance`` is absolute: there is no scale to it)."""
    tolerance = check_number("tolerance", tolerance, low=0)
    value = float(checked_values(f, np.zeros((1, f.n), dtype=np.bool_))[0])
    if abs(value) <= tolerance:
        return None
    return Violation(rule="normalised", a=(), b=(), slack=-abs(value), tolerance=tolerance)


@Step("looking for a negative value")
def find_negativity(
    f: SetFunction,
    *,
    tolerance: float = DEFAULT.tolerance,
    trials: int = DEFAULT.trials,
    seed: int = 0,
    time_limit: float | None = DEFAULT.seconds,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: PropertyParams = DEFAULT,
) -> Violation | NotFound | None:
    """Return the set with the most negative value, if any; parameters as in :func:`find_monotonicity_violation`."""
    own = Budget.inside(budget, time_limit, max_evaluations=max_evaluations)
    asked = _Question(f, "non-negative", tolerance, trials=trials, seed=seed, budget=own, params=params)
    values = asked.table()
    return asked.sampled() if values is None else asked.witness((int(values.argmin()), 0), values)


@Step("looking for a falling value")
def find_monotonicity_violation(
    f: SetFunction,
    *,
    tolerance: float = DEFAULT.tolerance,
    trials: int = DEFAULT.trials,
    seed: int = 0,
    time_limit: float | None = DEFAULT.seconds,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: PropertyParams = DEFAULT,
) -> Violation | NotFound | None:
    """Find the set ``a`` and element ``b`` with the most negative marginal ``f(a | b) - f(a)``.

    ``tolerance`` : how negative counts, relative to the largest absolute value of the function; of criteria, at least
    what rounding may do: they are differences from a prior's, which may be large beside them
    ``trials``, ``seed`` : of the sampled search, if the ground set has more than 24 elements or time is short
    ``time_limit``, ``max_evaluations`` : seconds, a minute by default, and values of ``f``, unlimited by default
    ``budget`` : an outer search's budget: its seconds and interrupts count too
    ``params`` : which sets are looked at

    Returns the witness; ``None`` if there is none, by a look at every set (up to 24 elements) or by theory
    (information criteria: added information is positive semidefinite, up to the rounding their input rule admits);
    otherwise :class:`NotFound`, which is false and proves nothing: sampled, or a fall that may be rounding.

    Source: ratt.tex, Section III.
    """
    own = Budget.inside(budget, time_limit, max_evaluations=max_evaluations)
    asked = _Question(f, "non-decreasing", tolerance, trials=trials, seed=seed, budget=own, params=params)
    if f.is_non_decreasing and (f.n > params.tabulated or is_proved(f)):
        return None
    values = asked.table()
    if values is None:
        return asked.sampled()
    if f.n == 0:
        return None
    x = int(marginal_ends(values, f.n)[0].argmin())
    sets = values.reshape(-1, 2, 1 << x)
    base = mask_without(int((sets[:, 1] - sets[:, 0]).argmin()), x)
    return asked.witness((base, 1 << x), values)


@Step("looking for a violation of submodularity")
def find_submodularity_violation(
    f: SetFunction,
    *,
    tolerance: float = DEFAULT.tolerance,
    trials: int = DEFAULT.trials,
    seed: int = 0,
    time_limit: float | None = DEFAULT.seconds,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: PropertyParams = DEFAULT,
) -> Violation | NotFound | None:
    """Find sets ``a = S + x`` and ``b = S + y`` that break ``f(a) + f(b) >= f(a | b) + f(a & b)`` most.

    Parameters and result are those of :func:`find_monotonicity_violation`; theory decides for log-det.

    Source: the definition by second differences, equivalent to all pairs of sets.
    """
    own = Budget.inside(budget, time_limit, max_evaluations=max_evaluations)
    asked = _Question(f, "submodular", tolerance, trials=trials, seed=seed, budget=own, params=params)
    return None if f.is_submodular and (f.n > params.tabulated or is_proved(f)) else _second_order(asked)


def is_proved(f: SetFunction) -> bool:
    """Tell whether theory knows its properties: one of the library's criteria, whose formula is no user's own."""
    return isinstance(f, InformationObjective) and f.error_scale(np.ones(f.n_targets)) is not None


@Step("looking for a violation of modularity")
def find_modularity_violation(
    f: SetFunction,
    *,
    tolerance: float = DEFAULT.tolerance,
    trials: int = DEFAULT.trials,
    seed: int = 0,
    time_limit: float | None = DEFAULT.seconds,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: PropertyParams = DEFAULT,
) -> Violation | NotFound | None:
    """Find sets ``a = S + x`` and ``b = S + y`` with the largest ``|f(a) + f(b) - f(a | b) - f(a & b)|``.

    Parameters and result are those of :func:`find_monotonicity_violation`.
    """
    own = Budget.inside(budget, time_limit, max_evaluations=max_evaluations)
    return _second_order(_Question(f, "modular", tolerance, trials=trials, seed=seed, budget=own, params=params))


@Step("looking for a violation of subadditivity")
def find_subadditivity_violation(
    f: SetFunction,
    *,
    tolerance: float = DEFAULT.tolerance,
    trials: int = DEFAULT.trials,
    seed: int = 0,
    time_limit: float | None = DEFAULT.seconds,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: PropertyParams = DEFAULT,
) -> Violation | NotFound | None:
    """Find sets that break ``f(a) + f(b) >= f(a | b)`` most.

    A non-negative submodular function has none. A non-decreasing one has one only if a disjoint pair is one
    (``f(b - a) <= f(b)``): 3**n pairs, up to 18 elements. Other functions: all 4**n pairs, up to 12 elements, as no
    faster exact way is known. Beyond: sampled. Parameters and result are those of
    :func:`find_monotonicity_violation`.
    """
    own = Budget.inside(budget, time_limit, max_evaluations=max_evaluations)
    asked = _Question(f, "subadditive", tolerance, trials=trials, seed=seed, budget=own, params=params)
    values = asked.table()
    if values is None:
        return asked.sampled()
    try:
        return _subadditive(asked, values)
    except OutOfBudget as out:
        return NotFound(rule=asked.rule, trials=0, smallest_slack=np.inf, tolerance=0.0, stop=out.stop)


def _subadditive(asked: _Question, values: FloatArray) -> Violation | NotFound | None:
    n = asked.f.n
    # Theory needs the premises exactly.
    if values.min() >= 0 and (n < 2 or second_differences(values, n, asked.budget).min() >= 0):
        return None
    monotone = n <= asked.params.disjoint and (n == 0 or marginal_ends(values, n)[0].min() >= 0)
    if not monotone and n > asked.params.overlapping:
        return asked.sampled()
    _, a, b = (disjoint_slack if monotone else overlapping_slack)(values, asked.budget)
    return asked.witness((a, b), values)


def _second_order(asked: _Question) -> Violation | NotFound | None:
    values, n = asked.table(), asked.f.n
    if values is None:
        return asked.sampled()
    if n < 2:
        return None
    try:
        slack = second_differences(values, n, asked.budget)
        if asked.rule == "modular":
            slack = np.minimum(slack, second_differences(-values, n, asked.budget))
    except OutOfBudget as out:
        return NotFound(rule=asked.rule, trials=0, smallest_slack=np.inf, tolerance=0.0, stop=out.stop)
    i, j = (int(k) for k in np.unravel_index(int(slack.argmin()), slack.shape))
    if i == j:  # every slack of a pair is positive
        return None
    return asked.witness(_worst_pair(values, i, j, asked.rule), values)


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
