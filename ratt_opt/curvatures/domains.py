"""Over which sets the marginals of a curvature range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import IntArray, check_subset
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import finite_values
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.table import TableFunction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["LARGEST_ENUMERATION", "Domain", "domain_of"]

LARGEST_ENUMERATION = 2**24
"""Most sets of a domain that are enumerated (128 MiB of values)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Domain:
    """``restricted`` is the function on the elements that take part; a set holds at most one of each owner's.

    ``owners`` : owner of each of its elements, 0.. without gaps. ``names`` : their indices in the original function.
    ``rounding`` : error that a marginal may have; 0 where the values are given and not computed.
    """

    name: str
    restricted: SetFunction
    owners: IntArray
    names: IntArray
    rounding: float

    @property
    def count(self) -> float:
        """Number of sets in the domain."""
        return float(np.prod(np.bincount(self.owners) + 1.0))

    def element(self, x: int | np.int64) -> int:
        """The original index of one element."""
        return int(self.names[x])

    def named(self, context: tuple[int, ...]) -> tuple[int, ...]:
        """The original indices of a set."""
        return tuple(sorted(int(self.names[e]) for e in context))


def domain_of(f: SetFunction, owners: ArrayLike | None, plan: ArrayLike | None) -> Domain:
    """Return the domain that the arguments of a curvature describe.

    Raises
    ------
    InputError : owners of the wrong shape, or a plan that repeats or exceeds the elements.
    """
    error = _rounding(f)
    if plan is not None:
        chosen = check_subset("plan", np.asarray(plan).tolist(), f.n)
        alone = np.arange(len(chosen))
        return Domain(
            name="robots", restricted=_restriction(f, chosen), owners=alone, names=chosen, rounding=_rounding(f)
        )
    everything = np.arange(f.n)
    if owners is None:
        return Domain(name="elements", restricted=f, owners=everything, names=everything, rounding=error)
    given = np.asarray(owners)
    if given.shape != (f.n,) or given.dtype.kind not in "iu":
        raise InputError("owners", f"must hold {f.n} integers, one per element", f"shape {given.shape}, {given.dtype}")
    _, compact = np.unique(given, return_inverse=True)
    return Domain(
        name="feasible", restricted=f, owners=compact.astype(np.int64), names=everything, rounding=_rounding(f)
    )


def _restriction(f: SetFunction, chosen: IntArray) -> SetFunction:
    if isinstance(f, InformationObjective):
        return type(f)(f.prior, f.information[chosen], f.weights)
    masks = np.arange(2 ** len(chosen))
    membership = np.zeros((len(masks), f.n), dtype=np.bool_)
    membership[:, chosen] = masks[:, None] >> np.arange(len(chosen)) & 1
    return TableFunction(f.evaluate(membership))


def _rounding(f: SetFunction) -> float:
    """Several hundred units in the last place of the numbers that a marginal is the difference of."""
    if isinstance(f, TableFunction):
        return 0.0
    size = abs(float(finite_values(np.array([f(range(f.n))]))[0]))
    if isinstance(f, InformationObjective):
        size += float(np.abs(f.criterion(f.prior_information)).sum())
    return 1e-13 * size
