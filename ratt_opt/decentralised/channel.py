"""Items of one robot for one neighbour: each arrives once and in order, whatever the link loses, repeats or reorders.

Items wait until the radio is free; a link record that the other robot turns out to know is then not sent, and a newer
one takes the place of an older one. Items sent are numbered from 0. A packet has those that wait (or, after a silent
tick, all that are not known to have arrived) and says how many of the other's items have arrived in order. If items are
missing in between, a packet is dropped; it comes again. This is go-back-N.

Source: Tanenbaum, Computer Networks, Section 3.4.2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.decentralised.messages import LinkRecord

if TYPE_CHECKING:
    from ratt_opt.decentralised.messages import Item, Packet

__all__ = ["Channel"]


class Channel:
    """One robot's end of a link."""

    __slots__ = (
        "_arrived",
        "_at_last_tick",
        "_items",
        "_must_answer",
        "_others",
        "_owes_answer",
        "_patience",
        "_sent",
        "_silent",
        "_waiting",
        "received",
    )

    def __init__(self) -> None:
        self._items: list[Item] = []
        self._waiting: dict[int, Item] = {}  # by the robot of a record; other items by numbers below 0
        self._sent = self._arrived = self._at_last_tick = self.received = 0
        self._others = -1
        self._owes_answer = self._must_answer = False

    @property
    def is_idle(self) -> bool:
        """True if all items have arrived there, and the other robot knows what has arrived here."""
        return self._arrived == len(self._items) and not self._waiting and not self._owes_answer

    def closed(self) -> Channel:
        """The channel without anything to send: it only answers what still comes."""
        closed = Channel()
        closed.received = self.received
        return closed

    def answer(self) -> None:
        """Send a packet soon, if only an empty one."""
        self._must_answer = True

    def add(self, item: Item) -> None:
        """Append an item to send."""
        self._waiting[item.robot if isinstance(item, LinkRecord) else self._others] = item
        self._others -= 1

    def take(self) -> tuple[int, tuple[Item, ...]] | None:
        """Items to send now, with the number of the first; ``None`` if there is nothing to send."""
        if self._sent == len(self._items) and not self._waiting and not self._must_answer:
            return None
        self._items += self._waiting.values()
        self._waiting.clear()
        first, self._sent = self._sent, len(self._items)
        self._owes_answer = self._must_answer = False
        return first, tuple(self._items[first:])

    def accept(self, packet: Packet) -> tuple[Item, ...]:
        """Items of a packet that are new and next in order."""
        self._arrived = max(self._arrived, min(packet.received, len(self._items)))
        self._sent = max(self._sent, self._arrived)
        if not packet.items:
            return ()
        self._owes_answer = True
        if packet.first > self.received:
            return ()
        new = packet.items[self.received - packet.first :]
        self.received += len(new)
        for item in new:
            if isinstance(item, LinkRecord):
                self._spare(item)
        return new

    def _spare(self, known: LinkRecord) -> None:
        """Do not send a record that the other robot knows, or an older one."""
        waits = self._waiting.get(known.robot)
        if isinstance(waits, LinkRecord) and waits.number <= known.number:
            del self._waiting[known.robot]

    def tick(self) -> None:
        """Let time pass: answer, and send again if nothing has arrived since the last tick."""
        self._must_answer = self._owes_answer
        if self._arrived == self._at_last_tick:
            self._sent = self._arrived
        self._at_last_tick = self._arrived
