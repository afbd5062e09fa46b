"""Messages between neighbours: their fields, their bytes and their sizes.

A *packet* goes from a robot to one neighbour. It holds *items*, numbered along the way between the two, and says how
many items of the other one have arrived. All numbers are little-endian. A packet is its header and its items:

==============  ==================================================================================================
header          version (1 byte), common digest (8), sender (2), number of the first item (4), items received (4),
                number of items (2)
link record     kind 1 (1), robot (2), number (4), flags (1: blinded 1, cannot be blinded 2, as bit masks 4), n (2),
                then n times: neighbour (2; highest bit: protected); or n bytes: bit mask of neighbours, n bytes: of
                protected ones (the shorter form)
bait list       kind 2 (1), stamp (4), view (8), n (2), n times: value (8), robot (2)
bait choice     kind 3 (1), stamp (4), view (8), n (2), n times: robot (2)
bid             kind 4 (1), stamp (4), view (8), round (2), value (8), n (2), m (4), n times: robot (2), element (4),
                bit mask (m / 8) of the numbers, of m, that are not 0, and these (8)
award           kind 5, fields as of a bid
menu            kind 6, fields as of a bid
==============  ==================================================================================================
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import IntFlag, auto
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.graph.communication import mask_of, robots_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = [
    "MOST_ROBOTS",
    "VERSION",
    "Award",
    "BaitChoice",
    "BaitList",
    "Bid",
    "Choice",
    "Item",
    "LinkRecord",
    "Menu",
    "Packet",
    "decode",
    "encode",
]

VERSION = 2
"""Version of the schema above: a robot refuses packets of any other."""
HEADER = struct.Struct("<B8sHIIH")
RECORD = struct.Struct("<BHIBH")
ABOUT_BAIT = struct.Struct("<BI8sH")
PRICED = struct.Struct("<dH")
OFFER = struct.Struct("<BI8sHdHI")
CHOICE = struct.Struct("<HI")
MOST_ROBOTS = 1 << 15
"""Robots that numbers of 16 bits tell apart; the highest bit of a neighbour's says that the link is protected."""


class RecordFlag(IntFlag):
    """Flags of a record of links: of its robot, and of how its neighbours are written."""

    BLINDED = auto()
    CANNOT_BE_BLINDED = auto()
    AS_MASKS = auto()


@dataclass(frozen=True, slots=True)
class LinkRecord:
    """The live links of one robot; of two records of a robot the one of the larger ``number`` holds.

    ``protected`` : neighbours whose link to the robot cannot be cut. ``blinded`` : the robot sees nothing;
    ``is_protected`` : it cannot be blinded.
    """

    robot: int
    number: int
    neighbours: tuple[int, ...]
    protected: frozenset[int] = frozenset()
    blinded: bool = False
    is_protected: bool = False

    @property
    def mask_bytes(self) -> int:
        """Bytes of a bit mask of its neighbours."""
        return max(self.neighbours, default=-1) // 8 + 1

    @property
    def size(self) -> int:
        """Bytes."""
        return RECORD.size + 2 * min(len(self.neighbours), self.mask_bytes)


@dataclass(frozen=True, slots=True)
class BaitList:
    """The most valuable robots of a part of the tree: ``(value, robot)``, best first, towards the root.

    ``stamp`` : sum of the numbers of the link records that the sender knows; ``view`` : digest of its component.
    """

    stamp: int
    view: bytes
    best: tuple[tuple[float, int], ...]

    @property
    def size(self) -> int:
        """Bytes."""
        return ABOUT_BAIT.size + PRICED.size * len(self.best)


@dataclass(frozen=True, slots=True)
class BaitChoice:
    """The bait robots, from the root to all."""

    stamp: int
    view: bytes
    robots: tuple[int, ...]

    @property
    def size(self) -> int:
        """Bytes."""
        return ABOUT_BAIT.size + 2 * len(self.robots)


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """An element of a robot. ``information`` : (M d (d + 1) / 2,) lower triangles of its matrices, target by target."""

    robot: int
    element: int
    information: FloatArray

    @property
    def size(self) -> int:
        """Bytes."""
        return CHOICE.size + (len(self.information) + 7) // 8 + 8 * int(np.count_nonzero(self.information))


@dataclass(frozen=True, slots=True, eq=False)
class Bid:
    """The best element of a part of the tree beside those awarded, or its best exchange, towards the root.

    ``value`` : of the plan with it; of an exchange, what is proved of its worst case. ``choices`` : one element; of an
    exchange all elements that change, none if no exchange is better.
    """

    stamp: int
    view: bytes
    round: int
    value: float
    choices: tuple[Choice, ...]

    @property
    def size(self) -> int:
        """Bytes."""
        return OFFER.size + sum(choice.size for choice in self.choices)

    def beats(self, other: Bid | None) -> bool:
        """Tell whether it is worth more; of equals the lowest element wins, as in RATT."""
        return other is None or self._rank > other._rank

    @property
    def _rank(self) -> tuple[float, float]:
        return self.value, -min((choice.element for choice in self.choices), default=np.inf)


class Award(Bid):
    """The winner of a round, from the root to all; with limited hops a robot's own choice. Without choices: the end."""

    __slots__ = ()


class Menu(Bid):
    """All elements of a robot, for a neighbour."""

    __slots__ = ()


OFFERS: dict[int, type[Bid]] = {4: Bid, 5: Award, 6: Menu}
Item = LinkRecord | BaitList | BaitChoice | Bid


@dataclass(frozen=True, slots=True)
class Packet:
    """Items from one robot to a neighbour. ``first`` : number of the first one; ``received`` : items that arrived."""

    version: int
    common: bytes
    sender: int
    first: int
    received: int
    items: tuple[Item, ...]

    @property
    def size(self) -> int:
        """Bytes."""
        return HEADER.size + sum(item.size for item in self.items)


def encode(packet: Packet) -> bytes:
    """Write a packet as bytes; there are ``packet.size`` of them."""
    header = (packet.version, packet.common, packet.sender, packet.first, packet.received, len(packet.items))
    return HEADER.pack(*header) + b"".join(map(_encoded, packet.items))


def _encoded(item: Item) -> bytes:
    if isinstance(item, LinkRecord):
        return _encoded_record(item)
    if isinstance(item, BaitList):
        head = ABOUT_BAIT.pack(2, item.stamp, item.view, len(item.best))
        return head + b"".join(PRICED.pack(value, robot) for value, robot in item.best)
    if isinstance(item, BaitChoice):
        head = ABOUT_BAIT.pack(3, item.stamp, item.view, len(item.robots))
        return head + struct.pack(f"<{len(item.robots)}H", *item.robots)
    kind = next(number for number, one in OFFERS.items() if type(item) is one)
    floats = len(item.choices[0].information) if item.choices else 0
    head = OFFER.pack(kind, item.stamp, item.view, item.round, item.value, len(item.choices), floats)
    return head + b"".join(map(_encoded_choice, item.choices))


def _encoded_choice(choice: Choice) -> bytes:
    told = choice.information != 0
    bits = np.packbits(told, bitorder="little").tobytes()
    numbers: bytes = choice.information[told].astype("<f8").tobytes()
    return CHOICE.pack(choice.robot, choice.element) + bits + numbers


def _encoded_record(record: LinkRecord) -> bytes:
    n, size = len(record.neighbours), record.mask_bytes
    flags = RecordFlag.BLINDED * record.blinded | RecordFlag.CANNOT_BE_BLINDED * record.is_protected
    flags |= RecordFlag.AS_MASKS * (size < n)
    head = RECORD.pack(1, record.robot, record.number, flags, min(size, n))
    if size < n:
        return head + b"".join(mask_of(ends).to_bytes(size, "little") for ends in (record.neighbours, record.protected))
    return head + struct.pack(f"<{n}H", *(i | MOST_ROBOTS * (i in record.protected) for i in record.neighbours))


def decode(data: bytes, version: int = VERSION) -> Packet:
    """Read a packet.

    Raises
    ------
    InputError : it is of another version, cut short, too long, or of an unknown kind.
    """
    if not data or data[0] != version:
        raise InputError("packet", f"must be of version {version}", data[0] if data else "nothing")
    try:
        _, common, sender, first, received, count = HEADER.unpack_from(data)
        place, items = HEADER.size, []
        for _ in range(count):
            items.append(_decoded(data, place))
            place += items[-1].size
    except (struct.error, IndexError):
        raise InputError("packet", "must be whole", f"{len(data)} bytes") from None
    if place != len(data):
        raise InputError("packet", f"must have {place} bytes as its items do", len(data))
    return Packet(version, common, sender, first, received, tuple(items))


def _decoded(data: bytes, place: int) -> Item:
    """Read the item at a place."""
    kind = data[place]
    if kind == 1:
        return _decoded_record(data, place)
    if kind in {2, 3}:
        _, stamp, view, n = ABOUT_BAIT.unpack_from(data, place)
        start = place + ABOUT_BAIT.size
        if kind == 3:
            return BaitChoice(stamp, view, struct.unpack_from(f"<{n}H", data, start))
        return BaitList(stamp, view, tuple(PRICED.unpack_from(data, start + k * PRICED.size) for k in range(n)))
    if kind not in OFFERS:
        raise InputError("packet", "must hold items of kinds 1 to 6", kind)
    _, stamp, view, number, value, n, floats = OFFER.unpack_from(data, place)
    place, choices = place + OFFER.size, []
    for _ in range(n):
        choices.append(_decoded_choice(data, place, floats))
        place += choices[-1].size
    return OFFERS[kind](stamp, view, number, value, tuple(choices))


def _decoded_choice(data: bytes, place: int, floats: int) -> Choice:
    start = place + CHOICE.size + (floats + 7) // 8
    bits = np.frombuffer(data[place + CHOICE.size : start], dtype=np.uint8)
    if 8 * len(bits) < floats:
        raise IndexError
    told = np.unpackbits(bits, count=floats, bitorder="little").astype(bool)
    information = np.zeros(floats)
    information[told] = struct.unpack_from(f"<{np.count_nonzero(told)}d", data, start)
    information.setflags(write=False)
    robot, element = CHOICE.unpack_from(data, place)
    return Choice(robot, element, information)


def _decoded_record(data: bytes, place: int) -> LinkRecord:
    _, robot, number, flags, n = RECORD.unpack_from(data, place)
    place += RECORD.size
    if flags & RecordFlag.AS_MASKS:
        if len(data) < place + 2 * n:
            raise IndexError
        masks = (int.from_bytes(data[place + k * n : place + (k + 1) * n], "little") for k in range(2))
        neighbours, protected = (tuple(robots_of(mask)) for mask in masks)
    else:
        ends = struct.unpack_from(f"<{n}H", data, place)
        neighbours = tuple(end & ~MOST_ROBOTS for end in ends)
        protected = tuple(end & ~MOST_ROBOTS for end in ends if end & MOST_ROBOTS)
    seen = (bool(flags & RecordFlag.BLINDED), bool(flags & RecordFlag.CANNOT_BE_BLINDED))
    return LinkRecord(robot, number, neighbours, frozenset(protected), *seen)
