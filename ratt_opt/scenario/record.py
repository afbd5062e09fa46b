"""The base of every record that is also a file's content: frozen, strict, with one-line errors."""

from __future__ import annotations

from inspect import signature
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, Union, get_args, get_origin

import numpy as np
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from ratt_opt._validation import whole
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

__all__ = ["NonNegative", "Number", "Positive", "Record", "Text", "Whole", "first_fault", "plain", "without_defaults"]

LARGEST = 1e12
"""Physical quantities beyond this, or positive ones below its inverse, are refused: squares and
products of a few of them stay far from overflow and underflow, so no later step can meet infinity."""


def plain(value: object) -> object:
    """A NumPy number or boolean as Python's own: the first counts as a number, the second does not."""
    return value.item() if isinstance(value, (np.number, np.bool_)) else value


Number = Annotated[float, Field(strict=True, ge=-LARGEST, le=LARGEST), BeforeValidator(plain)]
"""A number: no text, no boolean."""
Positive = Annotated[float, Field(strict=True, ge=1 / LARGEST, le=LARGEST), BeforeValidator(plain)]
NonNegative = Annotated[float, Field(strict=True, ge=0, le=LARGEST), BeforeValidator(plain)]
Whole = Annotated[int, Field(strict=True, ge=0), BeforeValidator(whole), BeforeValidator(plain)]
"""An integer; 2.0, as some languages write it, counts as 2."""


def _printable(text: str) -> str:
    if not text.isprintable():
        raise InputError("", "must be one line of printable text", ascii(text))
    return text


Text = Annotated[str, AfterValidator(_printable)]
"""Text that can be shown in a table or on a terminal as it is: no line breaks, no escapes."""

_RULES = {
    "missing": "is missing",
    "extra_forbidden": "is not a field of this format",
    "finite_number": "must be finite",
    "too_short": "must not be empty",
    "float_type": "must be a number",
    "int_type": "must be an integer",
    "string_type": "must be text",
    "model_type": "must be an object",
    "tuple_type": "must be a list",
}

_BOUNDS = {
    "greater_than": "must be > {gt:g}",
    "greater_than_equal": "must be >= {ge:g}",
    "less_than_equal": "must be <= {le:g}",
    "too_long": "must have at most {max_length} entries",
}


class _Words(str):
    """An annotation that is shown as it is."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def _words(annotation: Any) -> str:
    """An annotation for people: without what pydantic checks."""
    if isinstance(annotation, str):
        return annotation
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _words(arguments[0])
    if origin in {Union, UnionType}:
        return " | ".join(map(_words, arguments))
    if annotation in {None, type(None)}:
        return "None"
    if origin is Literal:
        return " | ".join(map(repr, arguments))
    name = getattr(origin or annotation, "__name__", str(annotation))
    inside = ", ".join("..." if one is ... else _words(one) for one in arguments)
    return f"{name}[{inside}]" if inside else name


class Record(BaseModel):
    """A frozen record; unknown fields, NaN and infinities are refused with an :class:`InputError`."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise first_fault(error) from None

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Give ``help`` a signature without the validators."""
        super().__pydantic_init_subclass__(**kwargs)
        given = signature(cls)
        plain = [one.replace(annotation=_Words(_words(one.annotation))) for one in given.parameters.values()]
        cls.__signature__ = given.replace(parameters=plain)

    def __eq__(self, other: object) -> bool:
        # Fields only: what a record has computed and kept is not part of what it is.
        return type(self) is type(other) and self._fields() == other._fields()

    def __hash__(self) -> int:
        return hash(tuple(self._fields().values()))

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some fields changed, as in ``scenario.replace(alpha_s=2)``; every rule is checked again.

        Raises
        ------
        InputError : a field is unknown or breaks its rule.
        """
        return type(self)(**(self._fields() | changes))

    def _fields(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in type(self).model_fields}


def without_defaults(record: Record, document: dict[str, Any], later: tuple[str, ...]) -> dict[str, Any]:
    """A record's document without those ``later`` fields that say nothing: older files and digests stay the same."""
    silent = {name for name in later if getattr(record, name) == type(record).model_fields[name].default}
    return {name: value for name, value in document.items() if name not in silent}


def first_fault(error: ValidationError) -> InputError:
    """Return the first fault of a validation as one line: field path, rule, value."""
    fault = error.errors(include_url=False)[0]
    inner = fault.get("ctx", {}).get("error")
    path = _path(fault)
    if isinstance(inner, InputError):
        return InputError(".".join(filter(None, (path, inner.argument))), inner.rule, inner.value)
    if fault["type"] in {"missing", "extra_forbidden"}:
        where = "nothing" if fault["type"] == "missing" else _short(fault["input"])
        return InputError(path, _RULES[fault["type"]], where)
    bound = _BOUNDS.get(fault["type"], "").format(**fault.get("ctx", {}))
    rule = bound or _RULES.get(fault["type"]) or f"is not valid: {fault['msg'][0].lower()}{fault['msg'][1:]}"
    return InputError(path or "scenario", rule, _short(fault["input"]))


def _path(fault: ErrorDetails) -> str:
    path = ""
    for part in fault["loc"]:
        if isinstance(part, int):
            path += f"[{part}]"
        else:
            # A field name from a file may hold anything, and the error must stay one line.
            name = part if part.isidentifier() else _cut(ascii(part))
            path += f".{name}" if path else name
    return path


def _cut(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:37]}..."


def _short(value: object) -> object:
    return value if isinstance(value, (int, float, str, type(None))) else type(value).__name__
