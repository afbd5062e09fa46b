"""One robot that plans by messages with its neighbours: a state machine without a clock.

A driver hands it what happens (a packet arrived, time passed, a link is lost, the sensor is blinded) and asks it, one
neighbour at a time, for the packet to send. It knows its own elements' information, the targets' prior, its neighbours,
and the budgets; nothing else.

1. Flooding: records of links go to all. If the record of every robot of the component is there, so is its link list,
   and with it the tree and ``alpha = alpha_s + alpha_cs``, both budgets clamped to the component.
2. Bait: lists of the ``alpha`` most valuable robots are merged towards the root, which tells all robots the choice.
3. Greedy: in each round the best bid goes to the root, which awards it; all robots hear the award and its information.
   A robot still without an element adds the awarded matrices in ascending order of elements: values, and so ties,
   are RATT's to the last bit.
4. End: all greedy robots have an award.

If a link is lost or a sensor blinded, its record changes. All robots that hear of it plan anew for the component that
is left. Links only vanish, so that happens finitely often. Once nothing changes any more, the robots of each component
have the elements that RATT chooses for the component alone.

Proof that no robot has to keep items for a later view. A robot sends a record before anything that follows from it, and
the channel keeps the order. So a robot that receives an item about a view has all records that its sender had. Its own
view is the same or a later one. If it is later, the item is dropped: its sender will hear the newer records, too, and
plan anew.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.decentralised.channel import Channel
from ratt_opt.decentralised.knowledge import AwardedSum, Disagreement, Knowledge
from ratt_opt.decentralised.messages import VERSION, Award, BaitChoice, BaitList, Bid, Item, LinkRecord, Packet
from ratt_opt.decentralised.view import ComponentView, digest, live_component, make_view
from ratt_opt.setfunctions.information import triangles

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["Agent", "State"]


COMPONENT = "component"
"""Subject of a disagreement of robots that know the same links and make different components of them."""


class State(Enum):
    """Stage of an agent, with a sentence about it."""

    FLOODING = "It collects the link records of its component."
    LISTING = "It collects its children's lists of valuable robots."
    LISTED = "It has sent its list and waits for the choice of bait."
    BIDDING = "It collects its children's bids of this round."
    OFFERED = "It has sent the best bid of its part of the tree and waits for the award."
    ENDED = "It knows the choices of its whole component."


@dataclass(slots=True, eq=False)
class _Progress:
    """One plan of one component, made anew for each view.

    ``name`` : digest of view and ``alpha``. ``branches`` : robots below -> child on the way to them.
    ``told`` : sum of the awarded information. ``lists``, ``bids`` : of children, ``bids`` in this round.
    ``awarded`` : robots with an element, in the order of the awards. ``open_below`` : robots without one, by child.
    ``has_sent`` : the list, or this round's bid.
    """

    view: ComponentView
    name: bytes
    alpha: int
    branches: dict[int, int]
    told: AwardedSum
    lists: dict[int, BaitList] = field(default_factory=dict)
    bait: tuple[int, ...] | None = None
    bids: dict[int, Bid] = field(default_factory=dict)
    awarded: list[int] = field(default_factory=list)
    open_below: dict[int, int] = field(default_factory=dict)
    has_sent: bool = False

    @property
    def is_over(self) -> bool:
        return self.bait is not None and len(self.bait) + len(self.awarded) == len(self.view.members)


class Agent:
    """One robot. ``element`` is its choice so far: before its first award, and as bait, its individually best one.

    ``heard`` : robots whose choices it knew when it won its own, in the order of their choices. ``version`` : of the
    messages. ``disagreements`` : neighbours refused. ``evaluations`` : values that it computed.
    """

    def __init__(self, knowledge: Knowledge, version: int = VERSION) -> None:
        self.knowledge, self.version, self.common = knowledge, version, knowledge.common
        self.robot = knowledge.robot
        self.disagreements: list[Disagreement] = []
        self.evaluations = 0
        self.heard: tuple[int, ...] = ()
        self._objective = knowledge.objective
        self._channels = {i: Channel() for i in knowledge.neighbours}
        self._left: dict[int, Channel] = {}  # to robots that it refused, or that refused it, until both know
        self._records: dict[int, LinkRecord] = {}
        self._stamp = 0
        self._missing: int | None = None
        self._progress: _Progress | None = None
        self._choose_alone()
        self._change(LinkRecord(self.robot, 1, tuple(sorted(self._channels)), knowledge.protected))

    @property
    def state(self) -> State:
        """Stage that it is in."""
        now = self._progress
        if now is None:
            return State.FLOODING
        if now.is_over:
            return State.ENDED
        if now.bait is None:
            return State.LISTED if now.has_sent else State.LISTING
        return State.OFFERED if now.has_sent else State.BIDDING

    @property
    def has_ended(self) -> bool:
        """True if it knows the choices of its component."""
        return self._progress is not None and self._progress.is_over

    @property
    def is_idle(self) -> bool:
        """True if it needs no tick: all that it sent has arrived, and it owes no answer."""
        return all(channel.is_idle for channel in (*self._channels.values(), *self._left.values()))

    @property
    def bait(self) -> tuple[int, ...]:
        """Bait of its component, ascending, as far as it knows."""
        return () if self._progress is None else self._progress.bait or ()

    @property
    def component(self) -> tuple[int, ...]:
        """Robots of its component, ascending; it alone if it does not know them yet."""
        return (self.robot,) if self._progress is None else self._progress.view.members

    @property
    def neighbours(self) -> tuple[int, ...]:
        """Robots to which it has a live link."""
        return tuple(self._channels)

    @property
    def addressees(self) -> tuple[int, ...]:
        """Robots to which it may have a packet to send: neighbours, and those refused until both know."""
        return (*self._channels, *self._left)

    # ------------------------------------------------------------------ what a driver calls

    def send(self, neighbour: int) -> Packet | None:
        """Packet for a neighbour; ``None`` if there is none to send now."""
        channel = self._channels.get(neighbour, self._left.get(neighbour))
        taken = None if channel is None else channel.take()
        if channel is None or taken is None:
            return None
        return Packet(self.version, self.common, self.robot, taken[0], channel.received, taken[1])

    def receive(self, packet: Packet) -> None:
        """Take a packet. A robot that is refused, or refused this one, is answered until it knows; others are not."""
        channel = self._channels.get(packet.sender)
        if channel is None:
            self._answer_left(packet)
            return
        if packet.version != self.version:
            self.refuse(packet.sender, "version of the messages", str(self.version), str(packet.version))
        elif packet.common != self.common:
            self.refuse(packet.sender, "criterion, prior or budgets", self.common.hex(), packet.common.hex())
        else:
            for item in channel.accept(packet):
                self._handle(packet.sender, item)
            self._look()

    def tick(self) -> None:
        """Let time pass: items that may be lost are sent again."""
        for channel in (*self._channels.values(), *self._left.values()):
            channel.tick()

    def _answer_left(self, packet: Packet) -> None:
        """Take what a robot without a live link has received, and answer it if it sent something."""
        left = self._left.get(packet.sender)
        if left is None:
            return
        if (packet.version, packet.common) == (self.version, self.common):
            left.accept(packet)
        if packet.items:
            left.answer()

    def lose(self, neighbour: int) -> None:
        """Do without the link to a neighbour, which is lost for good."""
        self._left.pop(neighbour, None)
        self._drop(neighbour)

    def _drop(self, neighbour: int) -> None:
        if self._channels.pop(neighbour, None) is not None:
            own = self._records[self.robot]
            left = tuple(i for i in own.neighbours if i != neighbour)
            self._change(replace(own, number=own.number + 1, neighbours=left))

    def blind(self) -> None:
        """Go on without a sensor: all elements tell nothing from now on."""
        own = self._records[self.robot]
        if not own.blinded:
            self._objective = self._objective.with_information(np.zeros_like(self._objective.information))
            self._choose_alone()
            self._change(replace(own, number=own.number + 1, blinded=True))

    def refuse(self, neighbour: int, about: str, own: str, other: str) -> None:
        """Stop listening to a neighbour, note why, and let it know: by any packet, or by the record without it."""
        self.disagreements.append(Disagreement(self.robot, neighbour, about, own, other))
        channel = self._channels.get(neighbour)
        if channel is None:
            return
        self._drop(neighbour)
        if about == COMPONENT:
            channel.add(self._records[self.robot])
        else:
            channel = channel.closed()
            channel.answer()
        self._left[neighbour] = channel

    # ------------------------------------------------------------------ flooding

    def _change(self, own: LinkRecord) -> None:
        self._keep(own, source=self.robot)
        self._look()

    def _keep(self, record: LinkRecord, source: int) -> None:
        """Replace a robot's record and pass it on."""
        known = self._records.get(record.robot)
        self._stamp += record.number - (0 if known is None else known.number)
        self._records[record.robot], self._has_news = record, True
        if known is not None or record.robot == self._missing:
            self._missing = None
        for i, channel in self._channels.items():
            if i != source:
                channel.add(record)

    def _handle(self, sender: int, item: Item) -> None:
        if not isinstance(item, LinkRecord):
            if sender in self._channels:
                self._look()
                self._take_part(sender, item)
            return
        known = self._records.get(item.robot)
        if known is None or item.number > known.number:
            self._keep(item, sender)
            if item.robot in self._channels and self.robot not in item.neighbours:
                self._left[item.robot] = self._channels[item.robot].closed()
                self._drop(item.robot)

    def _look(self) -> None:
        """Find the component if no record of it is missing, and plan anew if it is another one."""
        if self._missing is not None or not self._has_news:
            return
        self._has_news = False
        near = live_component(self._records, self.robot)
        if isinstance(near, int):
            self._missing, self._progress = near, None
            return
        view = make_view(near, self._records, self.knowledge.alpha_s, self.knowledge.alpha_c)
        alpha = view.threat.alpha_s + self.knowledge.links_worth(view.threat)
        name = digest(view.digest.hex(), alpha)
        if self._progress is None or self._progress.name != name:
            told = AwardedSum(self._objective)
            self._progress = _Progress(view, name, alpha, view.branches(self.robot), told)
            self._begin()

    # ------------------------------------------------------------------ the plan of one component

    @property
    def _now(self) -> _Progress:
        assert self._progress is not None
        return self._progress

    def _take_part(self, sender: int, item: BaitList | BaitChoice | Bid) -> None:
        """Take an item about a component, if it is the present one."""
        now = self._progress
        if now is None or item.view != now.name:
            if item.stamp >= self._stamp:  # its author knew the same records: it should have had the same view
                self.refuse(sender, COMPONENT, "none" if now is None else now.name.hex(), item.view.hex())
        elif isinstance(item, BaitList):
            now.lists[sender] = item
            self._list()
        elif isinstance(item, BaitChoice):
            self._to_children(item)
            self._take_choice(item.robots)
        elif isinstance(item, Award):
            self._take_award(item)
            self._bid()
        else:
            now.bids[sender] = item
            self._bid()

    def _begin(self) -> None:
        """Choose bait by messages, unless all robots are bait or none."""
        now = self._now
        if 0 < now.alpha < len(now.view.members):
            self._list()
        else:
            self._take_choice(now.view.members if now.alpha else ())

    def _list(self) -> None:
        """Send the best robots of this part of the tree once all children's lists are there; the root chooses."""
        now = self._now
        if now.has_sent or len(now.lists) < len(set(now.branches.values())):
            return
        known = [(self._best_value, self.robot)] + [one for listed in now.lists.values() for one in listed.best]
        best = tuple(sorted(known, key=lambda one: (-one[0], one[1]))[: now.alpha])
        if now.view.root == self.robot:
            bait = tuple(sorted(robot for _, robot in best))
            self._to_children(BaitChoice(self._stamp, now.name, bait))
            self._take_choice(bait)
        else:
            now.has_sent = True
            self._to_parent(BaitList(self._stamp, now.name, best))

    def _take_choice(self, bait: tuple[int, ...]) -> None:
        now = self._now
        now.bait, now.has_sent = bait, False
        if self.robot in bait:
            self._choose_alone()
        for i, child in now.branches.items():
            now.open_below[child] = now.open_below.get(child, 0) + (i not in bait)
        self._bid()

    def _bid(self) -> None:
        """Send the best bid of this part of the tree once it is known; the root awards it and goes on."""
        now = self._now
        while not now.is_over and not now.has_sent:
            if any(left and child not in now.bids for child, left in now.open_below.items()):
                return
            best = self._own_bid()
            for bid in now.bids.values():
                best = bid if bid.beats(best) else best
            now.has_sent = True
            if best is None:
                return
            if now.view.root != self.robot:
                self._to_parent(best)
                return
            told = (best.round, best.robot, best.element, best.value, best.information)
            self._take_award(Award(self._stamp, now.name, *told))

    def _own_bid(self) -> Bid | None:
        """Best own element beside those awarded; ``None`` if this robot has its element."""
        now = self._now
        assert now.bait is not None
        if self.robot in now.bait or self.robot in now.awarded:
            return None
        values = self._values(now.told.posterior())
        k = int(np.argmax(values))
        told = triangles(self._objective.information[k]).ravel()
        element = int(self.knowledge.elements[k])
        return Bid(self._stamp, now.name, len(now.awarded), self.robot, element, float(values[k]), told)

    def _take_award(self, award: Award) -> None:
        now = self._now
        if award.robot == self.robot:
            self.element, self.heard = award.element, tuple(now.awarded)
        elif self.robot not in now.awarded:
            now.told.add(award.element, award.information)
        now.awarded.append(award.robot)
        now.bids.clear()
        now.has_sent = False
        child = now.branches.get(award.robot)
        if child is not None:
            now.open_below[child] -= 1
        self._to_children(award)

    def _to_parent(self, item: Item) -> None:
        self._channels[self._now.view.parent[self.robot]].add(item)

    def _to_children(self, item: Item) -> None:
        for child in sorted(set(self._now.branches.values())):
            self._channels[child].add(item)

    # ------------------------------------------------------------------ values of its own elements

    def _choose_alone(self) -> None:
        values = self._values(self._objective.prior_information)
        k = int(np.argmax(values))
        self.element, self._best_value, self.heard = int(self.knowledge.elements[k]), float(values[k]), ()

    def _values(self, posterior: FloatArray) -> FloatArray:
        """(K,) values of the own elements beside others, whose posterior information is given."""
        self.evaluations += self._objective.n
        return self._objective.value(posterior + self._objective.information)
