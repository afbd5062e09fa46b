"""The library of compiled loops, and the checks between Python and C."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.errors import InputError, printable
from ratt_opt.native.sources import LIBRARY, RECORD, SOURCES, fault_of, fingerprint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import DTypeLike, NDArray

__all__ = ["address", "check_numbers", "checked", "function"]

ANYTHING = ctypes.c_char * 0
REMEDY = "install the package with pip, or, in a checkout, run python hatch_build.py"


@cache
def _library() -> ctypes.CDLL:
    """Raises ``ImportError`` : it was never compiled, from other sources, or is not what was compiled."""
    if fault := fault_of(LIBRARY, RECORD):
        raise ImportError(f"the loops of ratt_opt {fault}: {REMEDY}")
    try:
        library = ctypes.CDLL(str(LIBRARY))
    except OSError as error:  # of another system, or a C library that is too old
        raise ImportError(f"the loops of ratt_opt cannot be loaded here ({printable(str(error))}): {REMEDY}") from None
    library.sources.restype = ctypes.c_char_p
    if SOURCES.is_dir() and library.sources().decode() != _present():
        raise ImportError(f"the loops of ratt_opt were compiled from other sources: {REMEDY}")
    return library


def _present() -> str:
    try:
        return fingerprint()
    except OSError:
        return "a source is missing"


@cache
def function(name: str, result: Any, *arguments: Any) -> Any:
    """A function of the library with its types; the interpreter is not held while it runs."""
    found = getattr(_library(), name)
    found.restype, found.argtypes = result, arguments
    return found


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


def address(array: Any) -> int:
    """Return the memory address of a checked array; it must be kept alive while C uses it."""
    if array.flags.writeable:  # in a quarter of the time
        return ctypes.addressof(ANYTHING.from_buffer(array))
    return int(array.ctypes.data)
