"""The tables that the search by marginal gains shares with its compiled loop (``native/src/marginals.h``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.native.library import address, check_numbers, checked
from ratt_opt.native.loops import AttacksRecord, ChoosersRecord, GainsRecord, PathRecord

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.solvers.maxmin.elements import PackedElements

__all__ = ["BRANCHED", "MOST_ROBOTS", "Attacks", "Choosers", "Gains", "Path"]

BRANCHED = -1
"""Mark of a node that is divided by the elements of the next robot. Any other number is the attack of a dead end."""
MOST_ROBOTS = 64
"""Robots that masks hold."""


class Choosers:
    """Robots in the order in which they choose; ``sizes`` : (N,) how many of the elements, in that order, each has.

    Raises
    ------
    InputError : a shape or a type is another, a robot has no element, or there are more than 64 robots.
    """

    def __init__(self, elements: PackedElements, sizes: IntArray) -> None:
        self.elements, self.robots = elements, len(sizes)
        checked("sizes", sizes, np.int64, (self.robots,))
        if self.robots > MOST_ROBOTS:
            raise InputError("sizes", f"must be of at most {MOST_ROBOTS} robots", self.robots)
        if np.any(sizes < 1) or sizes.sum() != elements.count:
            raise InputError("sizes", f"must be positive and sum to {elements.count}", sizes)
        self._first, self._seeing = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64), _seeing(elements.sees)
        self.record = ChoosersRecord(
            all=elements.record, robots=self.robots, first=address(self._first), seeing=address(self._seeing)
        )


def _seeing(sees: BoolArray) -> IntArray:
    """(M, E) elements of which ``sees`` (E, M) is true, the last first, padded by -1."""
    seeing = np.full(sees.T.shape, -1, dtype=np.int64)
    for row, own in zip(seeing, sees.T, strict=True):
        elements = np.flatnonzero(own)[::-1]
        row[: len(elements)] = elements
    return seeing


class Attacks:
    """Groups ``of`` (A, S) each attack, padded by -1; ``members`` (G,) : masks of their robots, none of them blinded.

    ``order`` : (A,) in which attacks are tried; those that last led to a dead end come first

    Raises
    ------
    InputError : a shape or a type is another, or a number is not that of a group, or of an attack.
    """

    def __init__(self, members: NDArray[np.uint64], of: IntArray, order: IntArray) -> None:
        attacks, widest = len(order), np.shape(of)[-1] if np.ndim(of) == 2 else 0
        self.order, self._arrays = order, (members, of)  # the record has their addresses only
        checked("members", members, np.uint64, (len(members),))
        checked("of", of, np.int64, (attacks, widest))
        checked("order", order, np.int64, (attacks,), written=True)
        check_numbers("of", of, -1, len(members))
        check_numbers("order", order, 0, attacks)
        self.record = AttacksRecord(
            attacks=attacks, widest=widest, members=address(members), of=address(of), order=address(order)
        )


class Path:
    """Path of the search: ``chosen`` (N,) the elements of the robots that have chosen, and the end of each node."""

    def __init__(self, choosers: Choosers, room: int) -> None:
        self.chosen, targets = np.zeros(choosers.robots, np.int64), choosers.elements.targets
        self._seers, self._version = np.zeros(targets, np.uint64), np.zeros(targets, np.int64)
        self._nodes = np.zeros(room, np.int32)
        self.record = PathRecord(
            depth=0,
            size=0,
            chosen=address(self.chosen),
            seers=address(self._seers),
            version=address(self._version),
            record=address(self._nodes),
        )

    @property
    def nodes(self) -> NDArray[np.int32]:
        """(R,) of each node, in preorder, how it ended."""
        return self._nodes[: self.record.size]

    def make_room(self, more: int) -> None:
        """Grow until that many nodes fit in."""
        while len(self.nodes) + more > len(self._nodes):
            self._nodes = np.concatenate([self._nodes, np.zeros_like(self._nodes)])
        self.record.record = address(self._nodes)


class Gains:
    """Marginals of each target beside the sets of its seers that came last, ``sets`` of them."""

    def __init__(self, elements: PackedElements, sets: int) -> None:
        shape = elements.targets, sets
        self._value, self._gain = np.zeros(shape), np.zeros((*shape, elements.count))
        self._since, self._version = np.zeros(shape, np.int64), np.full(shape, -1, np.int64)
        self._seers, self._slot = np.zeros(shape, np.uint64), np.zeros(elements.targets, np.int64)
        self.record = GainsRecord(
            sets=sets,
            value=address(self._value),
            gain=address(self._gain),
            since=address(self._since),
            version=address(self._version),
            seers=address(self._seers),
            slot=address(self._slot),
        )
