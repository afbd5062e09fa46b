"""Checks shared by every public entry point; each raises :class:`InputError`."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "BoolArray",
    "FloatArray",
    "IntArray",
    "check_distinct",
    "check_finite",
    "check_integer",
    "check_link",
    "check_nonnegative",
    "check_number",
    "check_subset",
    "integer_array",
    "readonly",
    "whole",
]

T = TypeVar("T")

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def readonly(array: NDArray[Any]) -> NDArray[Any]:
    """Return a read-only view or copy of ``array`` that the caller's later writes cannot reach."""
    array = np.array(array)
    array.setflags(write=False)
    return array


def check_integer(argument: str, value: object, *, low: int, high: int | None = None) -> int:
    """Return ``value`` as an ``int`` in ``[low, high]``; 2.0 counts as 2, booleans and fractions are refused."""
    rule = f"must be an integer in [{low}, {high}]" if high is not None else f"must be an integer >= {low}"
    if isinstance(value, (bool, np.bool_)):
        raise InputError(argument, rule, value)
    try:
        number = operator.index(whole(value))  # type: ignore[arg-type]
    except TypeError:
        raise InputError(argument, rule, value) from None
    if number < low or (high is not None and number > high):
        raise InputError(argument, rule, value)
    return number


def whole(value: object) -> object:
    """A float that is exactly an integer, as that ``int``; anything else, also what may be rounded, as it is."""
    if isinstance(value, (float, np.floating)):
        number = float(value)
        if abs(number) <= 2**53 and number.is_integer():  # larger integers are rounded
            return int(number)
    return value


def integer_array(value: ArrayLike) -> NDArray[Any]:
    """Return ``value`` as an array, of objects if an entry is no integer: NumPy reads ``[True, 2]`` as ``[1, 2]``.

    2.0 counts as 2.
    Rows of different shapes give an array without entries.
    """
    if isinstance(value, np.ndarray) and value.dtype.kind in "iu":
        return value
    try:
        entries = np.asarray(value, dtype=object)
    except ValueError:
        return np.empty(0, dtype=object)
    numbers = np.empty(entries.shape, dtype=object)
    numbers.reshape(-1)[:] = [whole(x) for x in entries.flat]
    exact = all(isinstance(x, (int, np.integer)) and not isinstance(x, bool) for x in numbers.flat)
    return np.array(numbers.tolist()) if exact else entries


def check_link(argument: str, link: Any) -> tuple[int, int]:
    """Return a pair of robots as ``int``; a negative number, boolean, fraction or anything but a pair is refused."""
    try:
        i, j = link
    except (TypeError, ValueError):
        raise InputError(argument, "must be a pair of robots", link) from None
    if type(i) is int and type(j) is int and i >= 0 and j >= 0:  # as nearly always, and there may be thousands
        return i, j
    return check_integer(argument, i, low=0), check_integer(argument, j, low=0)


def check_distinct(argument: str, items: Iterable[T]) -> frozenset[T]:
    """Return the items as a set; one that is given twice is refused."""
    listed = list(items)
    found = frozenset(listed)
    if len(found) < len(listed):
        raise InputError(argument, "must not be repeated", next(x for k, x in enumerate(listed) if x in listed[:k]))
    return found


def check_number(argument: str, value: object, *, low: float = -np.inf) -> float:
    """Return ``value`` as a finite ``float`` that is at least ``low``; booleans and text are refused."""
    rule = "must be a finite number" if low == -np.inf else f"must be a finite number >= {low:g}"
    if isinstance(value, (bool, np.bool_, str, bytes)):
        raise InputError(argument, rule, value)
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise InputError(argument, rule, value) from None
    if not low <= number < np.inf:
        raise InputError(argument, rule, value)
    return number


def check_finite(argument: str, value: object, *, ndim: int | None = None) -> FloatArray:
    """Return ``value`` as a read-only float64 array without NaN or infinities."""
    try:
        given = np.asarray(value)
        # Text and complex numbers would be converted in silence; the word is no number either.
        array = np.array(given if given.dtype.kind in "biufO" else "no numbers", dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(argument, "must be an array of numbers", type(value).__name__) from None
    if ndim is not None and array.ndim != ndim:
        raise InputError(argument, f"must have {ndim} dimension(s)", f"shape {array.shape}")
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise InputError(argument, "must be finite", f"{array[where]} at index {where}")
    array.setflags(write=False)
    return array


def check_nonnegative(argument: str, value: object, *, ndim: int) -> FloatArray:
    """Return ``value`` as a read-only float64 array of finite numbers that are at least 0."""
    array = check_finite(argument, value, ndim=ndim)
    if (array < 0).any():
        raise InputError(argument, "must not be negative", float(array.min()))
    return array


def check_subset(argument: str, subset: Iterable[int], size: int) -> IntArray:
    """Return the sorted indices of ``subset``, each in ``[0, size)`` and given once."""
    if isinstance(subset, np.ndarray) and subset.dtype.kind == "b":
        raise InputError(argument, "must hold element indices, not a mask", f"boolean array of shape {subset.shape}")
    if not isinstance(subset, Iterable):
        raise InputError(argument, "must hold element indices", subset)
    indices = sorted(check_integer(f"{argument} index", item, low=0, high=size - 1) for item in subset)
    for first, second in pairwise(indices):
        if first == second:
            raise InputError(argument, "must not repeat an index", first)
    return np.array(indices, dtype=np.int64)
