"""Coverage and facility location as a trace criterion, so that the same certificates prove bounds for them.

An item of weight w that n chosen elements cover counts w if n > 0. Give it a state of one number with prior variance 1
and let each element that covers it have information q. The trace criterion then counts ``w (1 - 1 / (1 + q n))``: at
most w, and at least ``w q / (1 + q)`` if n > 0. So for every set of elements, with ``f`` the coverage and ``g`` the
criterion, ``g <= f <= g (1 + 1/q)``; hence the same for worst cases and for optima. A facility's customer is a tower of
items: one for each step between its utilities, which elements of at least that utility cover.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.scenario.information_input import InformationInput, nested

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.benchmark.instances.forms import SumInput

__all__ = ["INFORMATION", "as_information", "counts_whole", "value_at_least", "value_at_most"]

INFORMATION = 2.0**20
"""q: a power of two, so that 1/q is exact; with more the criterion comes closer to the coverage."""


def as_information(given: SumInput) -> InformationInput:
    """The trace criterion that bounds the sum from below, and from above up to the factor ``1 + 1/q``.

    Raises
    ------
    InputError : a utility is not whole: differences of others are rounded.
    """
    covers, weights = _items(given)
    information = INFORMATION * covers.astype(np.float64)
    return InformationInput(
        prior=nested(np.ones((len(weights), 1, 1))),
        information=nested(information[:, :, None, None]),
        robot=given.robot,
        alpha_s=given.alpha_s,
        alpha_c=given.alpha_c,
        weights=tuple(weights.tolist()),
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


def _items(given: SumInput) -> tuple[BoolArray, FloatArray]:
    """Truth values of elements covering items, and the items' weights; items that nobody covers are left out."""
    if given.kind == "coverage":
        covers, weights = np.zeros((len(given.robot), len(given.weights or ())), dtype=np.bool_), given.weights
        for row, items in zip(covers, given.covers or (), strict=True):
            row[list(items)] = True
        kept = covers.any(axis=0)
        return covers[:, kept], np.array(weights, dtype=np.float64)[kept]
    utility = np.array(given.utility, dtype=np.float64)
    if not counts_whole(given):
        raise InputError("utility", "must be whole numbers for a certificate", "a fraction")
    columns, weights_of = [], []
    for customer in utility.T:
        levels = np.unique(np.append(0.0, customer))
        for below, level in pairwise(levels):
            columns.append(customer >= level)
            weights_of.append(level - below)
    if not columns:
        raise InputError("utility", "must have an entry above 0 for a certificate", "zeros")
    return np.stack(columns, axis=1), np.array(weights_of)
