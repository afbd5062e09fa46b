"""The library of compiled loops, and the checks between Python and C."""

from __future__ import annotations

import ctypes
import sys
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

import numpy as np

from ratt_opt.errors import InputError, printable
from ratt_opt.native.sources import LIBRARY, RECORD, SOURCES, fault_of, fingerprint

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import DTypeLike, NDArray

__all__ = ["Address", "Answered", "address", "address_of", "check_numbers", "checked", "library"]


class Answered(IntEnum):
    """Reason why a call of a compiled search came back."""

    FINISHED = 0
    PAUSED = 1
    FOUND = 2


Number = TypeVar("Number", bound=np.generic)
Fields = TypeVar("Fields", bound=ctypes.Structure)
Pointed_co = TypeVar("Pointed_co", covariant=True)

ANYTHING: Any = ctypes.c_char * 0
REMEDY = "install the package with pip, or, in a checkout, run python hatch_build.py"


@cache
def library() -> ctypes.CDLL:
    """Load the compiled library.

    Raises ``ImportError`` : it was never compiled, from other sources, or is not what was compiled.
    """
    compiled, record = _compiled()
    if fault := fault_of(compiled, record):
        raise ImportError(f"the loops of ratt_opt {fault}: {REMEDY}")
    try:
        loaded = ctypes.CDLL(str(compiled))
    except OSError as error:  # of another system, or a C library that is too old
        raise ImportError(f"the loops of ratt_opt cannot be loaded here ({printable(str(error))}): {REMEDY}") from None
    loaded.sources.restype = ctypes.c_char_p
    if SOURCES.is_dir() and loaded.sources().decode() != _present():
        raise ImportError(f"the loops of ratt_opt were compiled from other sources: {REMEDY}")
    return loaded


def _compiled() -> tuple[Path, Path]:
    """The library and its record: beside this file, or, if a checkout without one hides an installation, that one's."""
    for folder in () if LIBRARY.exists() else sys.path:
        installed = Path(folder, __package__.replace(".", "/"))
        if (installed / LIBRARY.name).exists():
            return installed / LIBRARY.name, installed / RECORD.name
    return LIBRARY, RECORD


def _present() -> str:
    try:
        return fingerprint()
    except OSError:
        return "a source is missing"


def checked(argument: str, array: Any, kind: DTypeLike, shape: Sequence[int], *, written: bool = False) -> NDArray[Any]:
    """The array if C may read it: its type, its shape, contiguous, and writable where it is ``written``.

    Raises ``InputError`` : it may not.
    """
    kind = np.dtype(kind)
    if not isinstance(array, np.ndarray) or array.dtype != kind:
        raise InputError(argument, f"must be an array of {kind}", getattr(array, "dtype", type(array).__name__))
    if array.shape != tuple(shape):
        raise InputError(argument, f"must have shape {tuple(shape)}", array.shape)
    if not array.flags.c_contiguous or (written and not array.flags.writeable):
        raise InputError(argument, f"must be contiguous{' and writable' if written else ''}", "another layout")
    return array


def check_numbers(argument: str, numbers: NDArray[Any], least: int, count: int) -> None:
    """Check that an array holds numbers from ``least`` to ``count - 1``.

    Raises ``InputError`` : it does not.
    """
    if np.any((numbers < least) | (numbers >= count)):
        raise InputError(argument, f"must be in [{least}, {count - 1}]", numbers)


class Address(int, Generic[Pointed_co]):
    """Address of numbers or records of one type; an ``int``, whose type only mypy sees."""

    if TYPE_CHECKING:

        def __add__(self, offset: int) -> Address[Pointed_co]: ...


_addressof: Callable[[Any], Address[Any]] = cast("Any", ctypes.addressof)


def address(array: NDArray[Number]) -> Address[Number]:
    """Return the memory address of a checked array; it must be kept alive while C uses it."""
    if array.flags.writeable:  # in a quarter of the time
        return _addressof(ANYTHING.from_buffer(array))
    return cast("Address[Number]", array.ctypes.data)


def address_of(record: Fields) -> Address[Fields]:
    """Return the memory address of a record; it must be kept alive while C uses it."""
    return _addressof(record)
