"""Any set function, given by all its values."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, check_finite
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import SetFunction, check_table_size

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["TableFunction"]


class TableFunction(SetFunction):
    """The set function with ``values[mask]`` at the subset whose elements are the set bits of ``mask``.

    Parameters
    ----------
    values : (2**n,) finite numbers; no other property is assumed

    Raises
    ------
    InputError : the length is not a power of two, or a value is not finite.
    """

    __slots__ = ("_n", "values")

    def __init__(self, values: ArrayLike) -> None:
        self.values: FloatArray = check_finite("values", values, ndim=1)
        length = len(self.values)
        if length == 0 or length & (length - 1):
            raise InputError("values", "must have a power of two as length", length)
        self._n = length.bit_length() - 1
        check_table_size(self._n)

    @property
    def n(self) -> int:
        """Size of the ground set."""
        return self._n

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        return self.values[membership @ (1 << np.arange(self._n, dtype=np.int64))]

    def table(self) -> FloatArray:
        """(2**n,) the values themselves, read-only."""
        return self.values
