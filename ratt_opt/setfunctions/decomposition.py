"""One interface of set functions that are the weighted sum, or the least, of parts that few elements touch.

A search asks for parts by this interface and never which function they belong to: :class:`SumFunction` and the
reference functions made of maxima are sums, and so are the criteria of information matrices, target by target; the
max-eigenvalue is the least of its parts.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["DEFAULT", "Decomposition", "Overestimator", "PartBounds", "rounded_up"]


@dataclass(frozen=True, slots=True, eq=False)
class Overestimator:
    """``phi_j(T) <= constant + sum of gains over T`` for every set ``T`` of elements that touch part ``j``.

    ``gains`` : (k,) of these elements in ascending order, at least 0
    """

    constant: float
    gains: FloatArray

    def at(self, share: FloatArray) -> float:
        """The bound at a fractional point (k,)."""
        return self.constant + float(self.gains @ share)


@dataclass(frozen=True, slots=True, kw_only=True)
class PartBounds:
    """Effort for the bounds of one part.

    ``most_enumerated`` : elements of a part whose ``2**k`` sets are enumerated: exact bounds, for more work
    ``sets`` : sets added to a linear program at once, and ``rounds`` : times; ``tolerance`` : relative violation of one
    ``steps`` : exchanges of elements of a base set: lower bounds, for more values
    """

    most_enumerated: int = 12
    sets: int = 4
    rounds: int = 30
    tolerance: float = 1e-9
    steps: int = 4


DEFAULT = PartBounds()
"""Effort of bounds that are not told another one."""


class Decomposition(ABC):
    """Parts ``phi_j`` of a set function: ``f(S) = sum_j weights[j] phi_j(S)``, or the least ``phi_j(S)``.

    Part ``j`` depends only on the elements that touch it. A part need not be 0 at the empty set.
    """

    __slots__ = ()

    @property
    def is_sum(self) -> bool:
        """True if the function is the weighted sum of its parts; otherwise it is the least, and weights are ones."""
        return True

    @property
    @abstractmethod
    def n_parts(self) -> int:
        """Number of parts P."""

    @property
    @abstractmethod
    def weights(self) -> FloatArray:
        """(P,) non-negative weights of the parts."""

    @abstractmethod
    def touching(self, part: int) -> IntArray:
        """(k,) elements that touch a part, ascending."""

    @abstractmethod
    def part_values(self, part: int, membership: BoolArray) -> FloatArray:
        """(K,) unweighted values of a part for the subsets in the rows of ``membership`` (K, k) of its elements."""

    @abstractmethod
    def marginal_bounds(self, part: int) -> FloatArray:
        """(k,) no element adds more to a part, whatever set of others of them it is added to."""

    @abstractmethod
    def overestimator(self, part: int, share: FloatArray, effort: PartBounds | None = None) -> Overestimator:
        """Bound all sets of a part by a modular function that is small at a fractional point ``share`` (k,).

        ``effort`` : for it, if the part is not bounded by a formula
        """


def rounded_up(values: FloatArray) -> FloatArray:
    """Differences as computed, rounded up where they are not 0, as bounds need them; negative ones become 0."""
    return np.where(values > 0, np.nextafter(values, np.inf), 0.0)
