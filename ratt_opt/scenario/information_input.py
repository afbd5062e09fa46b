"""The second input: covariances, information matrices and owners, for users whose robots are not unicycles."""

from __future__ import annotations

from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_serializer,
    model_validator,
)
from pydantic.json_schema import SkipJsonSchema

from ratt_opt._validation import readonly
from ratt_opt.errors import InputError
from ratt_opt.scenario.problem_record import Link, ProblemRecord
from ratt_opt.scenario.record import Number, Positive, Text, Whole, plain

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["InformationInput"]

LARGEST_ENTRY = 1e100
"""Units are the user's, so far larger entries than a scenario's are accepted; products of two stay finite."""

LATER = ("output", "units", "element_headings", "element_controls", "at_most")
"""Optional fields that came after the first release of the format."""

Entry = Annotated[float, Field(strict=True, ge=-LARGEST_ENTRY, le=LARGEST_ENTRY), BeforeValidator(plain)]
Matrix = tuple[tuple[Entry, ...], ...]
Place = tuple[Number, Number]
NUMBERS = (float, int, np.floating, np.integer)


def _at_once(dimensions: int) -> WrapValidator:
    """Accept entries together if NumPy reads them as numbers in range; otherwise look at each, to name the bad one."""

    def accept(value: Any, one_by_one: ValidatorFunctionWrapHandler) -> Any:
        try:
            array = np.array(value, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            return one_by_one(value)
        fine = array.ndim == dimensions and array.size > 0 and bool((np.abs(array) <= LARGEST_ENTRY).all())
        if not fine or not all(issubclass(kind, NUMBERS) and kind is not bool for kind in _kinds(value, dimensions)):
            return one_by_one(value)
        return _as_tuples(array)

    return WrapValidator(accept)


def _kinds(value: Any, dimensions: int) -> set[type]:
    """The types of the entries of nested lists or of an array: text and booleans become numbers in NumPy's hands."""
    if isinstance(value, np.ndarray):
        return {value.dtype.type}
    for _ in range(dimensions - 1):
        value = chain.from_iterable(value)
    return set(map(type, value))


def _as_tuples(array: FloatArray) -> tuple[Any, ...]:
    """Nested tuples of Python's floats: each dimension takes that many neighbours of the one below together."""
    parts: Iterator[Any] = iter(array.ravel().tolist())
    for size in reversed(array.shape[1:]):
        parts = zip(*[parts] * size, strict=True)
    return tuple(parts)


class InformationInput(ProblemRecord):
    """A max-min problem given by its matrices.

    ``prior`` : (M, d, d) predicted covariances; ``information`` : (E, M, d, d); ``robot`` : (E,) owner of
    each element; ``weights`` : (M,) or ``None``; ``labels`` : (E,) what each element is, or ``None``.
    ``output`` : (q, d) the part ``C x`` of every target's state that counts, for the trace and the max-eigenvalue;
    ``None`` for the whole state. ``payload`` : (E,) objects of your own, one for each element, such as commands; they
    stay in memory (no file holds them) and count neither for equality nor for the digest. Links, budgets and
    protections are those of a scenario. ``at_most`` : robots that may choose another element than their idle one, the
    first without information; ``None`` for all. ``with_idle`` adds idle elements.

    For maps and tables only, each optional: ``units`` : (d,) of the state's coordinates, such as ``["m", "m", "m/s",
    "m/s"]``; ``robot_names`` : (N,); ``target_names`` : (M,); ``robot_positions`` : (N, 2) now, ``element_positions`` :
    (E, 2) and ``element_headings`` : (E,) after each element's control, ``target_positions`` : (M, 2), all x, y [m] and
    angles [rad]; ``element_controls`` : (E, 2) speed [m/s] and turn rate [rad/s].
    """

    format: Literal["ratt-opt information"] = "ratt-opt information"
    version: Literal[1] = 1
    prior: Annotated[tuple[Matrix, ...], Field(min_length=1), _at_once(3)]
    information: Annotated[tuple[tuple[Matrix, ...], ...], Field(min_length=1), _at_once(4)]
    robot: Annotated[tuple[Whole, ...], Field(min_length=1)]
    alpha_s: Whole
    alpha_c: Whole
    weights: tuple[Positive, ...] | None = None
    labels: tuple[Text, ...] | None = None
    links: tuple[Link, ...] | None = None
    protected_robots: tuple[Whole, ...] = ()
    protected_links: tuple[Link, ...] = ()
    notes: tuple[Text, ...] = ()
    robot_names: tuple[Text, ...] | None = None
    target_names: tuple[Text, ...] | None = None
    robot_positions: tuple[Place, ...] | None = None
    element_positions: tuple[Place, ...] | None = None
    target_positions: tuple[Place, ...] | None = None
    output: Matrix | None = None
    units: tuple[Text, ...] | None = None
    element_headings: tuple[Number, ...] | None = None
    element_controls: tuple[Place, ...] | None = None
    at_most: Whole | None = None
    payload: SkipJsonSchema[tuple[Any, ...] | None] = Field(default=None, exclude=True, repr=False)

    @model_serializer(mode="wrap")
    def _as_before(self, whole: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Drop later fields that hold nothing, so that files and their SHA-256 stay as they were before these came."""
        document: dict[str, Any] = whole(self)
        return {name: value for name, value in document.items() if value is not None or name not in LATER}

    @model_validator(mode="after")
    def _check_whole(self) -> Self:
        if self.labels is not None and len(self.labels) != len(self.robot):
            raise InputError("labels", f"must have {len(self.robot)} entries, one per element", len(self.labels))
        # Before anything is built on the robots: a stray index of 10^9 would ask for a graph of that size.
        owners = frozenset(self.robot)
        missing = next(i for i in range(len(self.robot) + 1) if i not in owners)
        if missing <= max(self.robot):
            raise InputError("robot", "must give every robot at least one element", f"none for robot {missing}")
        self._check_sizes(len(self.robot), len(self.prior[0]))
        self._check_links()
        self._check_lengths()
        self.problem()
        return self

    @property
    def n_robots(self) -> int:
        """Number of robots N."""
        return max(self.robot) + 1

    @property
    def _at_most(self) -> int | None:
        return self.at_most

    @property
    def n_targets(self) -> int:
        """Number of targets M."""
        return len(self.prior)

    @property
    def element_labels(self) -> tuple[str, ...] | None:
        """(E,) what each element is, or ``None``."""
        return self.labels

    @cached_property
    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """``prior`` (M, d, d) and ``information`` (E, M, d, d) as arrays."""
        return readonly(_array("prior", self.prior)), readonly(_array("information", self.information))

    def with_idle(self, at_most: int) -> Self:
        """Return the input in which each robot may be idle, too, and ``at_most`` robots may be busy.

        A robot that has an element without information keeps it. Each other one gets one after all elements, labelled
        ``idle``, at the robot's place.

        Raises
        ------
        InputError : ``at_most`` is not in ``[0, N]``, or a payload is given: an idle element has none.
        """
        if self.payload is not None:
            raise InputError("payload", "must be absent to add idle elements", "one")
        information, owners = self.matrices[1], np.array(self.robot)
        rests = ~np.any(information, axis=(1, 2, 3))
        without = [i for i in range(self.n_robots) if not rests[owners == i].any()]
        first = [self.robot.index(i) for i in without]
        given = self.element_positions, self.robot_positions, self.element_headings
        stays: dict[str, tuple[Any, ...] | None] = {
            "information": nested(np.zeros((len(without), *information.shape[1:]))),
            "robot": tuple(without),
            "labels": ("idle",) * len(without),
            "element_positions": _taken(given[1], without) if given[1] else _taken(given[0], first),
            "element_headings": _taken(given[2], first),
            "element_controls": ((0.0, 0.0),) * len(without),
        }
        own = {name: getattr(self, name) for name in stays}
        changes = {name: value and (*value, *(stays[name] or ())) for name, value in own.items()}
        return self.replace(**changes, at_most=at_most)

    def replace(self, **changes: Any) -> Self:
        """Replace fields; the payload stays unless it is changed."""
        return super().replace(**({"payload": self.payload} | changes))

    def _fields(self) -> dict[str, Any]:
        return {name: value for name, value in super()._fields().items() if name != "payload"}

    def _check_lengths(self) -> None:
        for name, length, of in (
            ("robot_names", self.n_robots, "robot"),
            ("target_names", self.n_targets, "target"),
            ("robot_positions", self.n_robots, "robot"),
            ("element_positions", len(self.robot), "element"),
            ("payload", len(self.robot), "element"),
            ("target_positions", self.n_targets, "target"),
            ("element_headings", len(self.robot), "element"),
            ("element_controls", len(self.robot), "element"),
            ("units", len(self.prior[0]), "coordinate"),
        ):
            given = getattr(self, name)
            if given is not None and len(given) != length:
                raise InputError(name, f"must have {length} entries, one per {of}", len(given))

    @property
    def _output(self) -> FloatArray | None:
        return None if self.output is None else _array("output", self.output)

    @property
    def _owners(self) -> IntArray:
        return np.array(self.robot)

    @property
    def _places(self) -> FloatArray | None:
        return None if self.robot_positions is None else np.array(self.robot_positions)

    @property
    def _matrices(self) -> tuple[FloatArray, FloatArray, FloatArray | None]:
        return *self.matrices, None if self.weights is None else np.array(self.weights)


def _taken(entries: tuple[Any, ...] | None, places: list[int]) -> tuple[Any, ...] | None:
    return None if entries is None else tuple(entries[k] for k in places)


def _array(name: str, nested: object) -> FloatArray:
    try:
        return np.array(nested, dtype=np.float64)
    except ValueError:
        raise InputError(name, "must hold square matrices of one size", "lists of different lengths") from None


def nested(array: FloatArray) -> Any:
    """An array as nested tuples, the form of the fields of a record."""
    return tuple(nested(part) for part in array) if array.ndim > 1 else tuple(array.tolist())
