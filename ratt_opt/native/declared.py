"""Types of C as annotations, and the records and functions that are made from them; ``loops.py`` declares all."""

import inspect
from ctypes import POINTER, Structure, byref, c_char_p, c_double, c_int, c_int32, c_int64, c_uint64, c_void_p
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, dataclass_transform

import numpy as np

from ratt_opt.native.library import Address, library

if TYPE_CHECKING:
    from _ctypes import _CArgObject as Reference
else:
    Reference = type(byref(c_int()))

__all__ = [
    "Anything",
    "Bytes",
    "Double",
    "Doubles",
    "Int",
    "Int8s",
    "Int32",
    "Int32s",
    "Int64",
    "Int64s",
    "Loader",
    "Pointer",
    "Text",
    "UInt16s",
    "UInt32s",
    "UInt64",
    "UInt64s",
    "record",
]

Pointed = TypeVar("Pointed")
Fields = TypeVar("Fields", bound=Structure)

Int = Annotated[int, c_int]
Int32 = Annotated[int, c_int32]
Int64 = Annotated[int, c_int64]
UInt64 = Annotated[int, c_uint64]
Double = Annotated[float, c_double]
Text = Annotated[bytes, c_char_p]
Pointer = Annotated[Address[Pointed] | Reference | None, c_void_p]
"""An address of numbers or records, ``byref`` of one number, or NULL."""
Doubles = Pointer[np.float64]
Bytes = Pointer[np.uint8 | np.bool_]
Int8s = Pointer[np.int8]
Int32s = Pointer[np.int32]
Int64s = Pointer[np.int64]
UInt16s = Pointer[np.uint16]
UInt32s = Pointer[np.uint32]
UInt64s = Pointer[np.uint64]
Anything = Annotated[int | Reference | None, c_void_p]


@dataclass_transform(kw_only_default=True)
def record(cls: type[Fields]) -> type[Fields]:
    """Give a class the fields of a record of C, which are its annotations in their order.

    It is made with all of them by name.
    """
    cls._fields_ = [(name, _in_record(hint)) for name, hint in inspect.get_annotations(cls).items()]
    return cls


def _in_record(hint: Any) -> Any:
    return hint if isinstance(hint, type) else hint.__metadata__[0]


def _in_function(hint: Any) -> Any:
    """Return the type of an argument or a result: a record is passed by its address."""
    if hint is None:
        return None
    return POINTER(hint) if isinstance(hint, type) else hint.__metadata__[0]


class Loader:
    """Functions of the library with the types of a protocol's methods, each bound when it is first used.

    The interpreter is not held while one runs.
    """

    def __init__(self, protocol: type) -> None:
        self._protocol = protocol

    def __getattr__(self, name: str) -> Any:
        """Bind a function.

        Raises ``AttributeError`` : none has this name.
        """
        *arguments, (_, result) = inspect.get_annotations(getattr(self._protocol, name)).items()
        found = getattr(library(), name)
        found.restype = _in_function(result)
        found.argtypes = [_in_function(hint) for _, hint in arguments]
        setattr(self, name, found)
        return found
