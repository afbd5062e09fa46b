"""Set functions of textbook families, a class each; ``zoo.py`` states the properties that theory knows of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt._validation import (
    BoolArray,
    FloatArray,
    IntArray,
    check_finite,
    check_integer,
    check_nonnegative,
    readonly,
)
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import SizedFunction, are_exact, check_total

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

__all__ = ["ConcaveOfModular", "Cut", "Modular", "PartitionMatroidRank"]


class Modular(SizedFunction):
    """``f(S) = sum of weights[e]``, ``weights`` (n,) of any sign; InputError : one is not finite."""

    __slots__ = ("weights",)

    is_submodular: ClassVar[bool] = True

    def __init__(self, weights: ArrayLike) -> None:
        self.weights: FloatArray = check_total("weights", check_finite("weights", weights, ndim=1))
        self._n = len(self.weights)

    @property
    def has_exact_values(self) -> bool:
        """True if all summands are whole."""
        return are_exact(self.weights, self.n)

    def are_alike(self, elements: IntArray) -> bool:
        """Return whether their weights are equal."""
        return bool(np.ptp(self.weights[elements]) == 0)

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        return membership @ self.weights


class PartitionMatroidRank(SizedFunction):
    """Weighted rank: the heaviest part of ``S`` with at most ``capacity[b]`` elements of each block ``b``.

    ``weights`` : (n,) non-negative; ``block`` : (n,) of each element; ``capacity`` : (blocks,) at least 0.
    InputError : it is not so.
    """

    __slots__ = ("_order", "block", "capacity", "weights")

    is_non_decreasing: ClassVar[bool] = True
    is_submodular: ClassVar[bool] = True

    def __init__(self, weights: ArrayLike, block: ArrayLike, capacity: ArrayLike) -> None:
        self.weights: FloatArray = check_total("weights", check_nonnegative("weights", weights, ndim=1))
        self.capacity: IntArray = readonly(np.asarray(capacity, dtype=np.int64))
        self.block: IntArray = readonly(np.asarray(block, dtype=np.int64))
        if self.block.shape != self.weights.shape:
            raise InputError("block", f"must have shape {self.weights.shape}", f"shape {self.block.shape}")
        for b in self.block.tolist():
            check_integer("block", b, low=0, high=len(self.capacity) - 1)
        if (self.capacity < 0).any():
            raise InputError("capacity", "must not be negative", int(self.capacity.min()))
        self._n, self._order = len(self.weights), np.argsort(-self.weights, kind="stable")

    @property
    def has_exact_values(self) -> bool:
        """True if all summands are whole."""
        return are_exact(self.weights, self.n)

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values: the greedy algorithm, heaviest first, which is exact for a matroid."""
        value = np.zeros(len(membership))
        left = np.tile(self.capacity, (len(membership), 1))
        for e in self._order:
            takes = membership[:, e] & (left[:, self.block[e]] > 0)
            value[takes] += self.weights[e]
            left[takes, self.block[e]] -= 1
        return value


class Cut(SizedFunction):
    """``f(S) =`` weight of the edges between ``S`` and the rest: submodular, symmetric, not monotone.

    ``weights`` : (n, n), the diagonal does not count. InputError : not square, not symmetric, or negative.
    """

    __slots__ = ("weights",)

    def __init__(self, weights: ArrayLike) -> None:
        self.weights: FloatArray = check_total("weights", check_nonnegative("weights", weights, ndim=2))
        if self.weights.shape[0] != self.weights.shape[1]:
            raise InputError("weights", "must be square", f"shape {self.weights.shape}")
        if (self.weights != self.weights.T).any():
            raise InputError("weights", "must be symmetric", "an asymmetric matrix")
        self._n = len(self.weights)

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        inside = membership.astype(np.float64)
        return np.asarray(((inside @ self.weights) * (1 - inside)).sum(axis=1))


class ConcaveOfModular(SizedFunction):
    """``f(S) = shape(total weight of S) - shape(0)`` for a concave ``shape``: submodular.

    Nothing checks that ``shape`` (maps (K,) totals to (K,) values) is concave: with a convex one the function is
    supermodular. ``weights`` : (n,). InputError : one is negative or not finite.
    """

    __slots__ = ("shape", "weights")

    def __init__(self, weights: ArrayLike, shape: Callable[[FloatArray], FloatArray] = np.sqrt) -> None:
        self.weights: FloatArray = check_total("weights", check_nonnegative("weights", weights, ndim=1))
        self.shape, self._n = shape, len(self.weights)

    def are_alike(self, elements: IntArray) -> bool:
        """Return whether their weights are equal."""
        return bool(np.ptp(self.weights[elements]) == 0)

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        return self.shape(membership @ self.weights) - self.shape(np.zeros(1))
