"""Sums of parts that are worth their best element: coverage and facility location.

For a part of utilities ``u_e >= 0`` and any level ``p >= 0``, ``max over T of u_e <= p + sum over T of (u_e - p)^+``.
At a fractional point the level that is best is the utility at which the shares of the better elements add up to 1: the
bound is then the concave envelope.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, check_nonnegative, readonly
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import are_exact, check_total, finite_values
from ratt_opt.setfunctions.decomposition import Overestimator, rounded_up
from ratt_opt.setfunctions.sums import SumFunction

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike

    from ratt_opt.setfunctions.decomposition import PartBounds

__all__ = ["BestElements", "Coverage", "FacilityLocation"]


class BestElements(SumFunction):
    """A weighted sum over parts of the best utility that any element of the set has for the part (0 without one).

    ``utility`` : (n, P) of each element for each part, at least 0
    """

    __slots__ = ("_touching", "utility")

    is_non_decreasing: ClassVar[bool] = True
    is_submodular: ClassVar[bool] = True

    def __init__(self, utility: FloatArray, weights: FloatArray | None = None) -> None:
        self.utility = utility
        super().__init__(len(utility), utility.shape[1], weights)
        with np.errstate(over="ignore"):
            check_total("utility", utility.max(axis=0, initial=0.0) * self.weights)
        self._touching: dict[int, IntArray] = {}

    def touching(self, part: int) -> IntArray:
        """(k,) elements with a utility for the part."""
        if part not in self._touching:
            self._touching[part] = readonly(np.flatnonzero(self.utility[:, part]))
        return self._touching[part]

    def _check_parts(self) -> None:
        """Look at nothing: both methods are the class's own."""

    def part_values(self, part: int, membership: BoolArray) -> FloatArray:
        """(K,) the best utility of each subset in the rows of ``membership`` (K, k)."""
        return np.asarray((membership * self._of_part(part)).max(axis=1, initial=0.0))

    def marginal_bounds(self, part: int) -> FloatArray:
        """(k,) the utilities."""
        return self._of_part(part)

    @property
    def has_exact_values(self) -> bool:
        """True if all summands are whole."""
        return are_exact(self.utility * self.weights, self.utility.shape[1]) and are_exact(self.utility, 1)

    @property
    def spacing(self) -> float:
        """The greatest common divisor of all summands, if they are whole."""
        summands = np.unique(self.utility * self.weights)
        whole = 2**40  # numbers below are divided and multiplied without rounding to another whole number
        if not self.has_exact_values or summands.max(initial=0.0) >= whole:
            return 0.0
        return float(np.gcd.reduce(summands.astype(np.int64), initial=0))

    def overestimator(  # its formula takes no effort
        self,
        part: int,
        share: FloatArray,
        effort: PartBounds | None = None,  # noqa: ARG002
    ) -> Overestimator:
        """The concave envelope at a fractional point (k,)."""
        u = self._of_part(part)
        order = np.argsort(-u, kind="stable")
        reached = np.cumsum(share[order]) >= 1.0
        level = float(u[order[int(reached.argmax())]]) if reached.any() else 0.0
        return Overestimator(level, rounded_up(u - level))

    def items(self) -> Iterator[tuple[BoolArray, float]]:
        """Items whose coverage the function is: the elements (n,) that cover one, and its weight.

        A part is an item for each step between its utilities, which the elements of at least that utility cover.
        """
        for own, weight in zip(self.utility.T, self.weights.tolist(), strict=True):
            levels = np.unique(own[own > 0]).tolist()
            for low, level in zip([0.0, *levels], levels, strict=False):
                yield own >= level, weight * (level - low)

    def _of_part(self, part: int) -> FloatArray:
        return np.asarray(self.utility[self.touching(part), part])


class Coverage(BestElements):
    """``f(S) =`` total weight of the items that some element of ``S`` covers.

    ``covers`` : (n, items) truth values; ``item_weights`` : (items,) non-negative. InputError : it is not so.
    """

    __slots__ = ("covers",)

    def __init__(self, covers: ArrayLike, item_weights: ArrayLike) -> None:
        self.covers: BoolArray = readonly(np.asarray(covers, dtype=np.bool_))
        weights = check_total("item_weights", check_nonnegative("item_weights", item_weights, ndim=1))
        if self.covers.ndim != 2 or self.covers.shape[1] != len(weights):
            raise InputError("covers", f"must have shape (n, {len(weights)})", f"shape {self.covers.shape}")
        super().__init__(readonly(self.covers.astype(np.float64)), weights)

    @property
    def item_weights(self) -> FloatArray:
        """(items,) weights."""
        return self.weights

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        return ((membership.astype(np.float64) @ self.utility) > 0) @ self.item_weights

    def extensions(self, base: IntArray, candidates: IntArray) -> FloatArray:
        """(C,) values ``f(base + {e})`` for each candidate ``e`` outside ``base``: items covered by either."""
        return (self.covers[base].any(axis=0) | self.covers[candidates]) @ self.item_weights


class FacilityLocation(BestElements):
    """``f(S) = sum over customers of the best utility any element of S has for it`` (0 without one).

    ``utility`` : (n, customers) non-negative. InputError : an entry is negative or not finite.
    """

    __slots__ = ()

    def __init__(self, utility: ArrayLike) -> None:
        super().__init__(check_nonnegative("utility", utility, ndim=2))

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        best = np.zeros((len(membership), self.utility.shape[1]))
        used = np.flatnonzero(membership.any(axis=0))
        if len(membership) < len(used):
            for row, one in zip(best, membership, strict=True):
                self.utility[one].max(axis=0, initial=0.0, out=row)
        else:
            for e in used:
                rows = membership[:, e]
                best[rows] = np.maximum(best[rows], self.utility[e])
        return np.asarray(best.sum(axis=1))

    def extensions(self, base: IntArray, candidates: IntArray) -> FloatArray:
        """(C,) values ``f(base + {e})`` for each candidate ``e`` outside ``base``: one maximum for each customer."""
        best = self.utility[base].max(axis=0, initial=0.0)
        return finite_values(np.asarray(np.maximum(best, self.utility[candidates]).sum(axis=1)))
