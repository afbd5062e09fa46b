"""Messages between neighbours: their fields, their bytes and their sizes.

A *packet* goes from a robot to one neighbour. It holds *items*, numbered along the way between the two, and says how
many items of the other one have arrived. All numbers are little-endian. A packet is its header and its items:

==============  ==================================================================================================
header          version (1 byte), common digest (8), sender (2), number of the first item (4), items received (4),
                number of items (2)
link record     kind 1 (1), robot (2), number (4), blinded (1), n (2), n times: neighbour (2; highest bit: protected)
bait list       kind 2 (1), stamp (4), view (8), n (2), n times: value (8), robot (2)
bait choice     kind 3 (1), stamp (4), view (8), n (2), n times: robot (2)
bid             kind 4 (1), stamp (4), view (8), round (2), robot (2), element (4), value (8), n (4), n numbers (8)
award           kind 5, fields as of a bid
==============  ==================================================================================================
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["VERSION", "Award", "BaitChoice", "BaitList", "Bid", "Item", "LinkRecord", "Packet", "decode", "encode"]

VERSION = 1
"""Version of the schema above: a robot refuses packets of any other."""
HEADER = struct.Struct("<B8sHIIH")
RECORD = struct.Struct("<BHIBH")
ABOUT_BAIT = struct.Struct("<BI8sH")
PRICED = struct.Struct("<dH")
OFFER = struct.Struct("<BI8sHHIdI")
PROTECTED = 1 << 15
"""The highest bit of a neighbour's number: robots are fewer."""


@dataclass(frozen=True, slots=True)
class LinkRecord:
    """The live links of one robot; of two records of a robot the one of the larger ``number`` holds.

    ``protected`` : neighbours whose link to the robot cannot be cut. ``blinded`` : the robot sees nothing.
    """

    robot: int
    number: int
    neighbours: tuple[int, ...]
    protected: frozenset[int] = frozenset()
    blinded: bool = False

    @property
    def size(self) -> int:
        """Bytes."""
        return RECORD.size + 2 * len(self.neighbours)


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
class Bid:
    """The best element of a part of the tree beside those awarded, towards the root.

    ``information`` : (M d (d + 1) / 2,) lower triangles of the element's information matrices, target by target.
    """

    stamp: int
    view: bytes
    round: int
    robot: int
    element: int
    value: float
    information: FloatArray

    @property
    def size(self) -> int:
        """Bytes."""
        return OFFER.size + 8 * len(self.information)

    def beats(self, other: Bid | None) -> bool:
        """Tell whether it is worth more; of equals the lowest element wins, as in RATT."""
        return other is None or (self.value, -self.element) > (other.value, -other.element)


class Award(Bid):
    """The element that won a round, from the root to all."""

    __slots__ = ()


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
        ends = [i | PROTECTED * (i in item.protected) for i in item.neighbours]
        head = RECORD.pack(1, item.robot, item.number, item.blinded, len(ends))
        return head + struct.pack(f"<{len(ends)}H", *ends)
    if isinstance(item, BaitList):
        head = ABOUT_BAIT.pack(2, item.stamp, item.view, len(item.best))
        return head + b"".join(PRICED.pack(value, robot) for value, robot in item.best)
    if isinstance(item, BaitChoice):
        head = ABOUT_BAIT.pack(3, item.stamp, item.view, len(item.robots))
        return head + struct.pack(f"<{len(item.robots)}H", *item.robots)
    kind, numbers = 5 if isinstance(item, Award) else 4, item.information
    offer = (item.round, item.robot, item.element, item.value, len(numbers))
    return OFFER.pack(kind, item.stamp, item.view, *offer) + numbers.astype("<f8").tobytes()


def decode(data: bytes) -> Packet:
    """Read a packet.

    Raises
    ------
    InputError : it is of another version, cut short, too long, or of an unknown kind.
    """
    if not data or data[0] != VERSION:
        raise InputError("packet", f"must be of version {VERSION}", data[0] if data else "nothing")
    try:
        version, common, sender, first, received, count = HEADER.unpack_from(data)
        place, items = HEADER.size, []
        for _ in range(count):
            item, place = _decoded(data, place)
            items.append(item)
    except (struct.error, IndexError):
        raise InputError("packet", "must be whole", f"{len(data)} bytes") from None
    if place != len(data):
        raise InputError("packet", f"must have {place} bytes as its items do", len(data))
    return Packet(version, common, sender, first, received, tuple(items))


def _decoded(data: bytes, place: int) -> tuple[Item, int]:
    """Read the item at a place; return it and the place behind it."""
    kind = data[place]
    if kind == 1:
        _, robot, number, blinded, n = RECORD.unpack_from(data, place)
        ends = struct.unpack_from(f"<{n}H", data, place + RECORD.size)
        protected = frozenset(end & ~PROTECTED for end in ends if end & PROTECTED)
        record = LinkRecord(robot, number, tuple(end & ~PROTECTED for end in ends), protected, bool(blinded))
        return record, place + record.size
    if kind in {2, 3}:
        _, stamp, view, n = ABOUT_BAIT.unpack_from(data, place)
        start = place + ABOUT_BAIT.size
        if kind == 3:
            choice = BaitChoice(stamp, view, struct.unpack_from(f"<{n}H", data, start))
            return choice, place + choice.size
        best = tuple(PRICED.unpack_from(data, start + k * PRICED.size) for k in range(n))
        listed = BaitList(stamp, view, best)
        return listed, place + listed.size
    if kind in {4, 5}:
        _, stamp, view, number, robot, element, value, n = OFFER.unpack_from(data, place)
        floats = struct.unpack_from(f"<{n}d", data, place + OFFER.size)
        information = np.array(floats, dtype=np.float64)
        information.setflags(write=False)
        offer = (Award if kind == 5 else Bid)(stamp, view, number, robot, element, value, information)
        return offer, place + offer.size
    raise InputError("packet", "must hold items of kinds 1 to 5", kind)
