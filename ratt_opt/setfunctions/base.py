"""The interface of every set function, and the function that is given by all its values."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, check_finite, check_subset
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import ArrayLike

    from ratt_opt.setfunctions.decomposition import Decomposition

__all__ = [
    "IMPROVEMENT",
    "ImprovementParams",
    "SetFunction",
    "SizedFunction",
    "TableFunction",
    "are_exact",
    "check_table_size",
    "check_total",
    "checked_values",
    "finite_values",
]

LARGEST_TABLE = 26
"""Largest ground set that :meth:`SetFunction.table` accepts (512 MiB of float64)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueParams:
    """Sizes of values. Whole numbers have exact sums in float64 if ``terms * largest`` is at most 2**53.

    ``limit`` : no value is larger [1], so that sums of many do not overflow: more leaves room for fewer
    ``largest`` : size of a number [1]; ``terms`` : numbers in a sum [1]. More of one leaves less of the other.
    ``block`` : numbers looked at together [1]: more are less overhead, and leave the cache
    """

    limit: float = 1e300
    largest: float = 2.0**45
    terms: int = 256
    block: int = 2**16


VALUES = ValueParams()


def are_exact(numbers: FloatArray, terms: int) -> bool:
    """Tell whether all numbers are whole, and sums of that many ``terms`` are exact."""
    flat = numbers.ravel()
    for start in range(0, len(flat), VALUES.block):
        some = flat[start : start + VALUES.block]
        if np.abs(some).max() > VALUES.largest or (some != np.rint(some)).any():
            return False
    return terms <= VALUES.terms


def check_table_size(n: int) -> None:
    """Refuse a table of ``2**n`` values that is too large, saying the memory it would take."""
    if n > LARGEST_TABLE:
        need = f"{2.0 ** (n - 27):.3g} GiB" if n >= 27 else f"{2 ** (n - 17)} MiB"
        raise InputError("n", f"must be at most {LARGEST_TABLE} for a full table (2**n float64 values, here {need})", n)


def finite_values(values: FloatArray) -> FloatArray:
    """Return values of a set function, refused if one is NaN, infinite, or so large that sums of some overflow."""
    if not _are_usable(values):
        bad = values[~(np.abs(values) <= VALUES.limit)][0]
        raise InputError("f", _usable_rule(bad), f"{bad} among the {values.size} asked for")
    return values


def _are_usable(values: FloatArray) -> bool:
    return values.size == 0 or bool(values.max() <= VALUES.limit and values.min() >= -VALUES.limit)


def _usable_rule(bad: float) -> str:
    return f"must have values of size at most {VALUES.limit:g}" if np.isfinite(bad) else "must have finite values"


def checked_values(f: SetFunction, membership: BoolArray) -> FloatArray:
    """(K,) values of the subsets in the rows of ``membership`` (K, n), refused if one is no usable number."""
    with np.errstate(over="ignore"):  # what overflows is refused below
        values = np.asarray(f.evaluate(membership))
    if values.shape != (len(membership),) or values.dtype.kind not in "fiub":
        rule = f"must evaluate to one number for each of {len(membership)} sets"
        raise InputError("f", rule, f"{values.dtype} array of shape {values.shape}")
    values = values.astype(np.float64, copy=False)
    if not _are_usable(values):
        k = int(np.flatnonzero(~(np.abs(values) <= VALUES.limit))[0])
        shown = f"{values[k]} for the set {np.flatnonzero(membership[k]).tolist()}"
        raise InputError("f", _usable_rule(values[k]), shown)
    return values


def check_total(argument: str, terms: FloatArray) -> FloatArray:
    """Return what a set function adds up, refused if the sum of the sizes is too large for a value."""
    with np.errstate(over="ignore"):
        total = float(np.abs(terms).sum())
    if total > VALUES.limit:
        raise InputError(argument, f"must have sizes that add up to at most {VALUES.limit:g}", total)
    return terms


@dataclass(frozen=True, slots=True, kw_only=True)
class ImprovementParams:
    """Parameters of the comparison of two values.

    ``relative`` : share of a value [1] that an improvement must exceed: more ends exchanges sooner and a little
    worse, less lets them follow the rounding of long sums
    """

    relative: float = 1e-12


IMPROVEMENT = ImprovementParams()


class SetFunction(ABC):
    """A real function of the subsets of ``0..n-1``; immutable.

    A subclass gives ``n`` and :meth:`evaluate`; the other methods have correct,
    slower defaults that a subclass may override with the same meaning.
    Two functions are equal only if they are the same object: a comparison of tables of 2**26 values would take long.
    """

    __slots__ = ()

    is_non_decreasing: ClassVar[bool] = False
    """Non-decreasing for all data, by theory."""
    is_submodular: ClassVar[bool] = False
    """Submodular for all data, by theory."""

    @property
    @abstractmethod
    def n(self) -> int:
        """Size of the ground set."""

    @property
    def rounding(self) -> float:
        """Values that differ by no more may be equal up to rounding; 0 if nothing is known of that."""
        return 0.0

    def least_improvement(self, value: float, *, terms: int = 1) -> float:
        """Smallest improvement of a value that is more than rounding: every loop of exchanges asks for it.

        A loop that takes less goes on in a circle: where values are small beside what they were subtracted from, their
        rounding is larger than any share of them.

        ``terms`` : values of sets that ``value`` is made of; 2 for a marginal
        """
        share = IMPROVEMENT.relative * abs(value) if isfinite(value) else 0.0  # anything is better than nothing known
        return max(share, terms * self.rounding)

    @property
    def has_exact_values(self) -> bool:
        """True if values are whole numbers that floats hold, so that their differences are exact."""
        return False

    @property
    def most_total_curvature(self) -> float:
        """Upper bound on the total curvature over all elements, from theory; 1 if there is none.

        A function of your own may override it: guarantees for plans under attack then have a bound to start from.
        """
        return 1.0

    @property
    def spacing(self) -> float:
        """Number of which all values are whole multiples, exactly; 0 if none is known."""
        return 0.0

    def are_alike(self, elements: IntArray) -> bool:  # noqa: ARG002  (nothing is known of them)
        """Return whether theory says that the value of a set of these elements depends on its number alone."""
        return False

    def decomposition(self) -> Decomposition | None:
        """The parts of which the function is the weighted sum, or the least one; ``None`` if none are known."""
        return None

    @abstractmethod
    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of many subsets; ``membership`` (K, n) is True if the element belongs to the subset."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}(n={self.n})"

    def __setstate__(self, state: Any) -> None:
        """Restore a copy; its arrays, which come back writeable, are made read-only again."""
        for fields in state if isinstance(state, tuple) else (state,):
            for name, value in (fields or {}).items():
                if isinstance(value, np.ndarray):
                    value.setflags(write=False)
                object.__setattr__(self, name, value)

    def __call__(self, subset: Iterable[int]) -> float:
        """Value of the subset with the given element indices, in any order.

        InputError : an index is outside ``[0, n)`` or given twice.
        """
        membership = np.zeros((1, self.n), dtype=np.bool_)
        membership[0, check_subset("subset", subset, self.n)] = True
        return float(checked_values(self, membership)[0])

    def values_of(self, sets: Sequence[Iterable[int]]) -> FloatArray:
        """(K,) values of many subsets, each given by its element indices, in one batch. Indices are not checked."""
        membership = np.zeros((len(sets), self.n), dtype=np.bool_)
        for row, elements in zip(membership, sets, strict=True):
            row[list(elements)] = True
        return checked_values(self, membership)

    def extensions(self, base: IntArray, candidates: IntArray) -> FloatArray:
        """(C,) values ``f(base + {e})`` for each candidate ``e``.

        ``base`` : (B,) distinct element indices; ``candidates`` : (C,) others, outside ``base``. Neither is checked.
        """
        membership = np.zeros((len(candidates), self.n), dtype=np.bool_)
        membership[:, base] = True
        membership[np.arange(len(candidates)), candidates] = True
        return checked_values(self, membership)

    def singletons(self) -> FloatArray:
        """(n,) values of the one-element sets."""
        return self.extensions(np.array([], dtype=np.int64), np.arange(self.n))

    def table(self) -> FloatArray:
        """(2**n,) values of all subsets; the subset of index ``mask`` holds the elements whose bit is set.

        InputError : the table cannot fit in memory (the text says how much it would need).
        """
        check_table_size(self.n)
        values, done = np.empty(2**self.n), 0
        for block in self.table_blocks():
            values[done : done + len(block)] = block
            done += len(block)
        return values

    def table_blocks(self) -> Iterator[FloatArray]:
        """The table, block by block."""
        bits, size = np.arange(self.n), 2 ** min(self.n, 14)
        for start in range(0, 2**self.n, size):
            masks = np.arange(start, start + size)
            yield checked_values(self, (masks[:, None] >> bits & 1).astype(np.bool_))


class SizedFunction(SetFunction):
    """A set function whose data say how large its ground set is."""

    __slots__ = ("_n",)

    _n: int

    @property
    def n(self) -> int:
        """Size of the ground set."""
        return self._n


class TableFunction(SizedFunction):
    """The set function with ``values[mask]`` at the subset whose elements are the set bits of ``mask``.

    ``values`` : (2**n,). InputError : the length is not a power of two, or a value is not finite, or beyond 1e300.
    """

    __slots__ = ("values",)

    def __init__(self, values: ArrayLike) -> None:
        self.values: FloatArray = check_finite("values", values, ndim=1)
        length = len(self.values)
        if length == 0 or length & (length - 1):
            raise InputError("values", "must have a power of two as length", length)
        self._n = length.bit_length() - 1
        check_table_size(self._n)
        if not _are_usable(self.values):
            raise InputError("values", f"must be of size at most {VALUES.limit:g}", float(np.abs(self.values).max()))

    @property
    def has_exact_values(self) -> bool:
        """True if all values are whole numbers below 2**53."""
        return are_exact(self.values, self.n)

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        return self.values[membership @ (1 << np.arange(self._n, dtype=np.int64))]

    def table(self) -> FloatArray:
        """(2**n,) the values themselves, read-only."""
        return self.values
