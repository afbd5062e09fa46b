"""The tables that a search in depth by covers shares with its compiled loop (``native/src/covers.h``)."""

from __future__ import annotations

from ctypes import Structure, c_int64, c_void_p
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.native.library import address, checked

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.solvers.maxmin.covers.choices import Choices

__all__ = ["BY_COVER", "BY_SUM", "NODE", "STEP", "TRIED", "Covers", "Record", "Stack", "Sums", "Ways"]

BY_COVER, BY_SUM, TRIED = 0, 1, 2
"""What forbids an element, or ends a frame: a cover, a sum of covers, or that the element was a dead end."""
NODE = np.dtype([(name, np.int64) for name in ("kind", "subject", "robot", "place", "next")])
STEP = np.dtype([*((name, np.int64) for name in ("kind", "what", "robot")), ("gone", np.uint64)])


class WaysRecord(Structure):
    """``Ways`` of ``native/src/covers.h``; so are the others of that file."""

    _fields_: ClassVar = [
        *((name, c_int64) for name in ("groups", "partitions", "widest")),
        *((name, c_void_p) for name in ("members", "inside", "of", "order")),
    ]


class Ways:
    """Partitions ``of`` (P, S) of groups, padded by -1, in the ``order`` (P,) in which they are tried; it changes.

    ``members`` : (G, N), ``inside`` : (G, E) which robots and elements are in each group

    Raises
    ------
    InputError : a shape or a type is another, or a number is not that of a group, or of a partition.
    """

    def __init__(self, choices: Choices, members: BoolArray, inside: BoolArray, of: IntArray, order: IntArray) -> None:
        groups, partitions = len(members), len(order)
        widest = np.shape(of)[-1] if np.ndim(of) == 2 else 0
        self._arrays = (
            checked("members", members, np.bool_, (groups, len(choices.safe))),
            checked("inside", inside, np.bool_, (groups, choices.elements.count)),
            checked("of", of, np.int64, (partitions, widest)),
            checked("order", order, np.int64, (partitions,), written=True),
        )
        _check_numbers("of", of, -1, groups)
        _check_numbers("order", order, 0, partitions)
        self.widest = widest
        self.record = WaysRecord(groups, partitions, widest, *map(address, self._arrays))


def _check_numbers(argument: str, numbers: IntArray, least: int, count: int) -> None:
    if np.any((numbers < least) | (numbers >= count)):
        raise InputError(argument, f"must be in [{least}, {count - 1}]", numbers)


class CoversRecord(Structure):
    """``Covers``."""

    _fields_: ClassVar = [
        *((name, c_int64) for name in ("size", "room", "groups")),
        *((name, c_void_p) for name in ("left_out", "partition", "sums", "level")),
    ]


class Covers:
    """Covers by number, the first ``size`` of each array, for which there is ``room``.

    ``left_out`` : (K, N) masks of elements; ``partition`` : (K,); ``sums`` : (K, S, M, T) posterior information at
    which the tangents of the partition's groups, ``groups`` at most, touch
    ``level`` : (K,) the least level that the cover is true for
    """

    def __init__(self, choices: Choices, room: int, groups: int) -> None:
        self.left_out = np.zeros((room, len(choices.safe)), np.uint64)
        self.partition = np.zeros(room, np.int64)
        self.sums = np.zeros((room, groups, *choices.elements.prior.shape))
        self.level = np.zeros(room)
        self.arrays = self.left_out, self.partition, self.sums, self.level
        self.record = CoversRecord(0, room, groups, *map(address, self.arrays))

    @property
    def room(self) -> int:
        """Covers for which there is room."""
        return int(self.record.room)

    @property
    def groups(self) -> int:
        """Groups of a partition at most."""
        return int(self.record.groups)


class SumsRecord(Structure):
    """``Sums``."""

    _fields_: ClassVar = [("looked_at", c_int64), *((name, c_void_p) for name in ("terms", "tried", "used"))]


class Sums:
    """Sums of covers by number: what each element counts, ``terms`` (R, E), of which plans have to count ``enough``.

    ``tried`` : (A,) those that are looked at; ``used`` : (R,) how often each was of use; it changes

    Raises
    ------
    InputError : a shape or a type is another, or one that is tried is not there.
    """

    def __init__(self, elements: int, terms: FloatArray, tried: IntArray, used: FloatArray) -> None:
        self._arrays = (
            checked("terms", terms, np.float64, (len(used), elements)),
            checked("tried", tried, np.int64, (len(tried),)),
            checked("used", used, np.float64, (len(used),), written=True),
        )
        _check_numbers("tried", tried, 0, len(used))
        self.terms, self.record = terms, SumsRecord(len(tried), *map(address, self._arrays))


class StackRecord(Structure):
    """``Stack``."""

    _fields_: ClassVar = [
        *((name, c_int64) for name in ("frame", "count")),
        *((name, c_void_p) for name in ("start", "allowed", "strongest", "fixed", "first", "steps", "reasons")),
        *((name, c_void_p) for name in ("since", "touched", "activity")),
    ]


class Stack:
    """Frames and steps, at first one frame in which everything is allowed.

    ``allowed`` : (N + 1, N) masks of the elements that are allowed in each frame
    """

    def __init__(self, choices: Choices) -> None:
        n, e = choices.element.shape[0], choices.elements.count
        self.allowed, strongest = np.zeros((n + 1, n), np.uint64), np.zeros((n + 1, *choices.strongest.shape))
        self.allowed[0], strongest[0] = choices.masks, choices.strongest
        self._arrays = (
            choices.masks,
            self.allowed,
            strongest,
            np.zeros(n + 1, np.int64),
            np.zeros(n + 2, np.int64),
            np.zeros(e + 1, STEP),
            np.zeros((e + 1, n), np.uint64),
            np.full(e, -1, np.int64),
            np.zeros((n + 1, n), np.int64),
            np.zeros(n),
        )
        self.record = StackRecord(0, 0, *map(address, self._arrays))

    @property
    def frame(self) -> int:
        """The present one."""
        return int(self.record.frame)


class NodesRecord(Structure):
    """``Record``."""

    _fields_: ClassVar = [("size", c_int64), ("room", c_int64), ("nodes", c_void_p)]


class Record:
    """The nodes of a search: the last one is the root.

    A node's subject is a cover, a sum, or the node of the dead end. What ends a frame has robot -1.
    """

    def __init__(self, room: int) -> None:
        self._nodes = np.zeros(room, NODE)
        self.record = NodesRecord(0, room, address(self._nodes))

    @property
    def size(self) -> int:
        """How many there are."""
        return int(self.record.size)

    @property
    def nodes(self) -> IntArray:
        """(R, 5) kind, its subject, robot, element's place, the next node."""
        return self._nodes[: self.size].view(np.int64).reshape(-1, 5)

    def make_room(self, more: int) -> None:
        """Grow as long as there is no room for ``more`` nodes and one."""
        while self.size + more >= len(self._nodes):
            self._nodes = np.concatenate([self._nodes, np.zeros_like(self._nodes)])
        self.record = NodesRecord(self.size, len(self._nodes), address(self._nodes))
