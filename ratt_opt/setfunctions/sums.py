"""Decomposable set functions: weighted sums of parts that few elements touch (Stobbe and Krause 2010).

**Modular bounds of one part.** For a submodular, non-decreasing part and any set ``S``,
``phi(T) <= phi(S) + sum of phi(S + e) - phi(S) over e in T - S`` (Nemhauser, Wolsey and Fisher 1978). If a part is the
best of its elements, the sets ``S`` of all elements below a level give its concave envelope. A part with few elements
has all its sets enumerated: multipliers of a small linear program over them, which a solver suggests, give the
envelope at a point, and the constant is computed again as the largest difference over all sets.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_finite, check_integer, check_nonnegative, check_subset, readonly
from ratt_opt.errors import InputError
from ratt_opt.highs import LinearProgram, Rows
from ratt_opt.setfunctions.base import SetFunction
from ratt_opt.setfunctions.decomposition import Decomposition, Overestimator, rounded_up

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import ArrayLike

    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["Part", "PartBounds", "SumFunction"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PartBounds:
    """Effort for the bounds of one part.

    ``most_enumerated`` : elements of a part whose ``2**k`` sets are enumerated: exact bounds, for more work
    """

    most_enumerated: int = 8


class Part:
    """One part of a sum: a function of few elements.

    Parameters
    ----------
    elements : the k elements that touch the part
    values : (2**k,) table by bit masks over ``elements`` in ascending order, or a function that maps ``membership``
        (K, k), over the elements in ascending order, to (K,) values
    weight : at least 0

    Raises
    ------
    InputError : an element is given twice, the table has another length, or the weight is negative.
    """

    __slots__ = ("elements", "values", "weight")

    def __init__(
        self, elements: Iterable[int], values: ArrayLike | Callable[[BoolArray], FloatArray], weight: float = 1.0
    ) -> None:
        listed = list(elements)
        size = max(map(int, listed), default=0) + 1
        self.elements: IntArray = readonly(check_subset("elements", listed, size))
        self.values: FloatArray | Callable[[BoolArray], FloatArray]
        if callable(values):
            self.values = values
        else:
            self.values = check_finite("values", values, ndim=1)
            if len(self.values) != 2 ** len(self.elements):
                raise InputError("values", f"must have 2**{len(self.elements)} entries", len(self.values))
        self.weight = float(check_nonnegative("weight", [weight], ndim=1)[0])

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) unweighted values of the subsets in the rows of ``membership`` (K, k)."""
        if callable(self.values):
            return self.values(membership)
        return self.values[membership @ (1 << np.arange(len(self.elements), dtype=np.int64))]


class SumFunction(SetFunction, Decomposition):
    """``f(S) = sum_j weights[j] phi_j(S)``: each part ``phi_j`` depends on the elements that touch it.

    Give the parts, or write a subclass that defines :meth:`touching` and :meth:`part_values` and says how many parts
    there are. Searches rely on non-decreasing parts. A subclass whose parts are all submodular says so by
    ``is_submodular = True``: searches rely on that for every part, and their bounds are then much better.

    Parameters
    ----------
    n : size of the ground set
    parts : the parts, or (a subclass) their number
    weights : (P,) non-negative weights, if the number of parts is given; ones by default

    Raises
    ------
    InputError : a part has an element that does not exist, or a weight is negative.
    """

    __slots__ = ("_bounds", "_n", "_parts", "_weights")

    def __init__(self, n: int, parts: Sequence[Part] | int, weights: ArrayLike | None = None) -> None:
        self._n = check_integer("n", n, low=1)
        self._bounds = _Bounds(PartBounds())
        self._parts: tuple[Part, ...] = ()
        if isinstance(parts, (int, np.integer)):
            count = check_integer("parts", parts, low=0)
            self._weights = np.ones(count) if weights is None else check_nonnegative("weights", weights, ndim=1)
        else:
            self._parts, count = tuple(parts), len(parts)
            for part in self._parts:
                check_subset("elements", part.elements.tolist(), self._n)
            if weights is not None:
                raise InputError("weights", "must not be given beside parts, which have their own", weights)
            self._weights = np.array([part.weight for part in self._parts])
        if self._weights.shape != (count,):
            raise InputError("weights", f"must have shape ({count},)", f"shape {self._weights.shape}")
        self._weights = readonly(self._weights)

    @property
    def n(self) -> int:
        """Size of the ground set."""
        return self._n

    @property
    def n_parts(self) -> int:
        """Number of parts P."""
        return len(self._weights)

    @property
    def weights(self) -> FloatArray:
        """(P,) weights of the parts."""
        return self._weights

    def touching(self, part: int) -> IntArray:
        """(k,) elements that touch a part, ascending; a subclass defines it."""
        if not self._parts:
            raise InputError("objective", "must define touching(part), the elements of a part", type(self).__name__)
        return self._parts[part].elements

    def part_values(self, part: int, membership: BoolArray) -> FloatArray:
        """(K,) values of a part for subsets (K, k) of the elements that touch it; a subclass defines it."""
        if not self._parts:
            rule = "must define part_values(part, membership), the values of a part"
            raise InputError("objective", rule, type(self).__name__)
        return self._parts[part].evaluate(membership)

    def decomposition(self) -> Decomposition:
        """The function itself: it knows its parts."""
        return self

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        total = np.zeros(len(membership))
        for part in range(self.n_parts):
            total += self.weights[part] * self.part_values(part, membership[:, self.touching(part)])
        return total

    def marginal_bounds(self, part: int) -> FloatArray:
        """(k,) exact if the part's sets are enumerated; else the value alone if it is submodular, or that of all."""
        return self._bounds.marginals(self, part)

    def overestimator(self, part: int, share: FloatArray) -> Overestimator:
        """The envelope if the part's sets are enumerated; else the best of the level sets, or monotonicity alone."""
        return self._bounds.overestimator(self, part, share)


class _Bounds:
    """Bounds of parts by their values; those of level sets are kept."""

    def __init__(self, params: PartBounds) -> None:
        self._params = params
        self._tables: dict[int, FloatArray] = {}
        self._levels: dict[int, FloatArray] = {}
        self._cuts: dict[tuple[int, float], Overestimator] = {}

    def marginals(self, f: SumFunction, part: int) -> FloatArray:
        k = len(f.touching(part))
        if k <= self._params.most_enumerated:
            table = self._table(f, part)
            steps = [table.reshape(-1, 2, 1 << e) for e in range(k)]
            return rounded_up(np.array([float((step[:, 1] - step[:, 0]).max()) for step in steps]))
        if f.is_submodular:
            return rounded_up(self._gains(f, part, np.zeros(k, dtype=np.bool_))[1])
        ends = f.part_values(part, np.array([np.zeros(k), np.ones(k)], dtype=np.bool_))
        return rounded_up(np.full(k, float(ends[1] - ends[0])))

    def overestimator(self, f: SumFunction, part: int, share: FloatArray) -> Overestimator:
        k = len(share)
        if k <= self._params.most_enumerated:
            return _envelope(self._table(f, part), share)
        if f.is_submodular:
            return self._best_level(f, part, share)
        ends = f.part_values(part, np.array([np.zeros(k), np.ones(k)], dtype=np.bool_))
        known = [Overestimator(float(ends[0]), self.marginals(f, part)), Overestimator(float(ends[1]), np.zeros(k))]
        return min(known, key=lambda bound: bound.at(share))

    def _best_level(self, f: SumFunction, part: int, share: FloatArray) -> Overestimator:
        """Search the levels by thirds: the bound is convex in the level if the part is the best of its elements."""
        if part not in self._levels:
            alone = self._gains(f, part, np.zeros(len(share), dtype=np.bool_))[1]
            self._levels[part] = np.append(-1.0, np.unique(alone))
        low, high = 0, len(self._levels[part]) - 1
        while high - low > 2:
            third = (high - low) // 3
            left, right = (self._at_level(f, part, k).at(share) for k in (low + third, high - third))
            low, high = (low, high - third) if left <= right else (low + third, high)
        return min((self._at_level(f, part, k) for k in range(low, high + 1)), key=lambda bound: bound.at(share))

    def _at_level(self, f: SumFunction, part: int, position: int) -> Overestimator:
        """Nemhauser and Wolsey's bound for the set of all elements whose value alone is at most a level."""
        level = float(self._levels[part][position])
        if (part, level) not in self._cuts:
            alone = self.marginals_alone(f, part)
            value, gains = self._gains(f, part, alone <= level)
            self._cuts[part, level] = Overestimator(value, rounded_up(gains))
        return self._cuts[part, level]

    def marginals_alone(self, f: SumFunction, part: int) -> FloatArray:
        """(k,) what each element adds to nothing."""
        return self._gains(f, part, np.zeros(len(f.touching(part)), dtype=np.bool_))[1]

    @staticmethod
    def _gains(f: SumFunction, part: int, base: BoolArray) -> tuple[float, FloatArray]:
        """Value of a set, and what each element adds to it; 0 inside the set."""
        outside = np.flatnonzero(~base)
        sets = np.tile(base, (len(outside) + 1, 1))
        sets[np.arange(len(outside)), outside] = True
        values, gains = f.part_values(part, sets), np.zeros(len(base))
        gains[outside] = values[:-1] - values[-1]
        return float(values[-1]), gains

    def _table(self, f: SumFunction, part: int) -> FloatArray:
        if part not in self._tables:
            k = len(f.touching(part))
            sets = (np.arange(2**k)[:, None] >> np.arange(k) & 1).astype(np.bool_)
            self._tables[part] = np.asarray(f.part_values(part, sets), dtype=np.float64)
        return self._tables[part]


def _envelope(table: FloatArray, share: FloatArray) -> Overestimator:
    """The concave envelope of a table (2**k,) at a point (k,): a linear program suggests, all sets prove."""
    k, sets = len(share), len(table)
    members = (np.arange(sets)[:, None] >> np.arange(k) & 1).astype(np.float64)
    entries = np.column_stack([np.ones(sets), members])
    columns = np.tile(np.arange(k + 1), sets)
    rows = Rows(table, np.full(sets, np.inf), np.arange(sets + 1) * (k + 1), columns, entries.ravel())
    found = LinearProgram(np.append(1.0, share), np.append(-np.inf, np.zeros(k)), rows=rows).solve()
    gains = np.maximum(found.x[1:], 0.0) if len(found.x) == k + 1 else np.zeros(k)
    # The sum of k gains and its difference from a value round k + 1 times.
    sums = members @ gains
    slack = (k + 1) * np.finfo(np.float64).eps * (sums.max() + np.abs(table).max())
    return Overestimator(float((table - sums).max() + slack), gains)
