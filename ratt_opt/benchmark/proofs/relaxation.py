"""Coverage and facility location as a trace criterion, so that the same certificates prove bounds for them.

The criterion is that of ``solvers/maxmin/coverage.py``, with a state for each item (equal ones are not merged): for
every set of elements, with ``f`` the coverage, ``g`` the criterion and q the information, ``g <= f <= g (1 + 1/q)``;
hence the same for worst cases and for optima.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.scenario.information_input import InformationInput, nested

if TYPE_CHECKING:
    from ratt_opt.benchmark.instances.forms import SumInput

__all__ = ["INFORMATION", "as_information", "counts_whole", "value_at_least", "value_at_most"]

INFORMATION = 2.0**20
"""q: a power of two, so that 1/q is exact; with more the criterion comes closer to the coverage."""


def as_information(given: SumInput) -> InformationInput:
    """The trace criterion that bounds the sum from below, and from above up to the factor ``1 + 1/q``.

    Raises
    ------
    InputError : a utility is not whole: differences of others are rounded; or no element is worth anything.
    """
    if given.kind != "coverage" and not counts_whole(given):
        raise InputError("utility", "must be whole numbers for a certificate", "a fraction")
    items = list(given.function.items())
    if not items:
        raise InputError("utility", "must have an entry above 0 for a certificate", "zeros")
    covers, weights = np.stack([one for one, _ in items], axis=1), [weight for _, weight in items]
    information = INFORMATION * covers.astype(np.float64)
    return InformationInput(
        prior=nested(np.ones((len(weights), 1, 1))),
        information=nested(information[:, :, None, None]),
        robot=given.robot,
        alpha_s=given.alpha_s,
        alpha_c=given.alpha_c,
        weights=tuple(weights),
        links=given.links,
        protected_robots=given.protected_robots,
        protected_links=given.protected_links,
    )


def counts_whole(given: SumInput) -> bool:
    """Tell whether all values of the sum are whole numbers, so that bounds can be rounded to such."""
    numbers = given.weights if given.kind == "coverage" else [u for row in given.utility or () for u in row]
    return all(float(number).is_integer() for number in numbers or ())


def value_at_most(given: SumInput, bound: float) -> float:
    """Upper bound on the sum's optimum from one on the criterion's."""
    highest = float(np.nextafter(bound * (1.0 + 1.0 / INFORMATION), np.inf))
    return float(np.floor(highest)) if counts_whole(given) else highest


def value_at_least(given: SumInput, bound: float) -> float:
    """Lower bound on the sum from one on the criterion."""
    return float(np.ceil(bound)) if counts_whole(given) else bound
