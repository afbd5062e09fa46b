"""Decomposable set functions: weighted sums of parts that few elements touch (Stobbe and Krause 2010)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_finite, check_integer, check_nonnegative, check_subset, readonly
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import SetFunction
from ratt_opt.setfunctions.decomposition import DEFAULT, Decomposition, Overestimator
from ratt_opt.setfunctions.part_bounds import PartBounder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import ArrayLike

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.decomposition import PartBounds

__all__ = ["Part", "SumFunction"]


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
    InputError : a part has an element that does not exist, or a weight is negative; at the first value, a method of a
        subclass does not answer as asked.
    """

    __slots__ = ("_bounds", "_is_checked", "_n", "_parts", "_weights")

    def __init__(self, n: int, parts: Sequence[Part] | int, weights: ArrayLike | None = None) -> None:
        self._n = check_integer("n", n, low=1)
        self._bounds, self._is_checked = PartBounder(self), False
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
        if not hasattr(self, "_n"):
            rule = "must call super().__init__(n, parts) first"
            raise InputError("objective", rule, type(self).__name__)
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
        self._check_parts()
        return self

    def _check_parts(self) -> None:
        """Refuse parts whose elements are not ascending indices, or whose values are not one number a set; once."""
        if self._is_checked:
            return
        for part in range(self.n_parts):
            touching = np.asarray(self.touching(part))
            ascends = touching.ndim == 1 and touching.dtype.kind in "iu" and bool((np.diff(touching) > 0).all())
            if not ascends or (len(touching) and not 0 <= touching[0] <= touching[-1] < self.n):
                rule = f"must be an array of ascending element indices in [0, {self.n - 1}], each once"
                shown = f"{touching.dtype} array of shape {touching.shape}"
                is_list = touching.ndim == 1 and touching.dtype.kind in "iu"
                raise InputError(f"touching({part})", rule, touching.tolist() if is_list else shown)
            sets = np.zeros((2, len(touching)), dtype=np.bool_)
            sets[1] = True
            values = self.part_values(part, sets)
            if np.shape(values) != (2,) or not isinstance(values, np.ndarray) or values.dtype.kind not in "fiub":
                kind = f"{values.dtype} array" if isinstance(values, np.ndarray) else type(values).__name__
                rule = "must be an array of one number for each of 2 sets"
                raise InputError(f"part_values({part}, membership)", rule, f"{kind} of shape {np.shape(values)}")
        self._is_checked = True

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        self._check_parts()
        total = np.zeros(len(membership))
        for part in range(self.n_parts):
            total += self.weights[part] * self.part_values(part, membership[:, self.touching(part)])
        return total

    def marginal_bounds(self, part: int) -> FloatArray:
        """(k,) exact if the part's sets are enumerated; else the value alone if it is submodular, or that of all."""
        return self._bounds.marginals(part)

    def overestimator(self, part: int, share: FloatArray, effort: PartBounds | None = None) -> Overestimator:
        """The envelope if the part's sets are enumerated; else a base set's bound, or monotonicity alone."""
        return self._bounds.overestimator(part, share, effort or DEFAULT)
