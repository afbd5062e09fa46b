"""One robot that plans by messages with its neighbours: a state machine without a clock.

A driver hands it what happens (a packet arrived, time passed, a link is lost, the sensor is blinded) and asks it, one
neighbour at a time, for the packet to send. It knows its own elements' information, the targets' prior, its neighbours,
and the budgets; nothing else.

1. Flooding: records of links go to all. If the record of every robot of the component is there, so is its link list,
   and with it the tree and ``alpha = alpha_s + alpha_cs``, both budgets clamped to the component.
2. Bait: lists of the ``alpha`` most valuable robots are merged towards the root, which tells all robots the choice.
3. Greedy: in each round the best bid goes to the root, which awards it; all robots hear the award and its information.
   A robot still without an element adds the awarded matrices in ascending order of elements: values, and so ties,
   are RATT's to the last bit. With limited hops there are no auctions: a robot chooses once all lower ones within the
   hops have, and its choice is told that far.
4. Exchanges, if asked for: bait tells its elements by auctions, too, and neighbours send each other all of theirs. In
   each round every robot proposes the best exchange of elements of its own and its neighbours whose worst case it
   proves to be above the present one; the root takes the best. No proposal ends the plan.

If a link is lost or a sensor blinded, its record changes. All robots that hear of it plan anew for the component that
is left. Links only vanish, so that happens finitely often; and each exchange raises the worst case, so there are
finitely many. Once nothing changes any more, the robots of each component have the elements that RATT chooses for the
component alone, or better ones by exchanges. ``component_plan.py`` has points 2 to 4, ``exchanges.py`` the proposals.

Proof that no robot has to keep items for a later view. A robot sends a record before anything that follows from it, and
the channel keeps the order. So a robot that receives an item about a view has all records that its sender had. Its own
view is the same or a later one. If it is later, the item is dropped: its sender will hear the newer records, too, and
plan anew.
"""

from __future__ import annotations

from dataclasses import replace

from ratt_opt.decentralised.channel import Channel
from ratt_opt.decentralised.component_plan import ComponentPlan, State
from ratt_opt.decentralised.knowledge import Disagreement, Knowledge, OwnChoice
from ratt_opt.decentralised.messages import BaitChoice, BaitList, Bid, Item, LinkRecord, Packet
from ratt_opt.decentralised.view import digest, live_component, make_view

__all__ = ["Agent"]


COMPONENT = "component"
"""Subject of a disagreement of robots that know the same links and make different components of them."""


class Agent:
    """One robot. ``own`` : its choice. ``disagreements`` : neighbours refused."""

    def __init__(self, knowledge: Knowledge) -> None:
        self.knowledge, self.version, self.common = knowledge, knowledge.version, knowledge.common
        self.robot, self.own = knowledge.robot, OwnChoice(knowledge)
        self.disagreements: list[Disagreement] = []
        self._channels = {i: Channel() for i in knowledge.neighbours}
        self._left: dict[int, Channel] = {}  # to robots that it refused, or that refused it, until both know
        self._records: dict[int, LinkRecord] = {}
        self._stamp = 0
        self._missing: int | None = None
        self._plan: ComponentPlan | None = None
        near = tuple(sorted(self._channels))
        self._change(LinkRecord(self.robot, 1, near, knowledge.protected, is_protected=knowledge.is_protected))

    @property
    def state(self) -> State:
        """Stage that it is in."""
        return State.FLOODING if self._plan is None else self._plan.state

    @property
    def element(self) -> int:
        """Element chosen so far."""
        return self.own.element

    @property
    def has_ended(self) -> bool:
        """True if it knows all choices that it will hear of."""
        return self._plan is not None and self._plan.is_over

    @property
    def is_idle(self) -> bool:
        """True if it needs no tick: all that it sent has arrived, and it owes no answer."""
        return all(channel.is_idle for channel in (*self._channels.values(), *self._left.values()))

    @property
    def bait(self) -> tuple[int, ...]:
        """Bait of its component, ascending, as far as it knows."""
        return () if self._plan is None else self._plan.bait or ()

    @property
    def exchanges(self) -> int:
        """Exchanges that its component took, as far as it knows."""
        return 0 if self._plan is None else self._plan.exchanges

    def element_after(self, exchanges: int) -> int:
        """Choice after a number of exchanges; the present one if it has heard of fewer."""
        known = [] if self._plan is None else self._plan.own_after
        return known[exchanges] if exchanges < len(known) else self.own.element

    @property
    def component(self) -> tuple[int, ...]:
        """Robots of its component, ascending; it alone if it does not know them yet."""
        return (self.robot,) if self._plan is None else self._plan.view.members

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
            self.refuse(
                packet.sender, "criterion, prior, budgets or way to plan", self.common.hex(), packet.common.hex()
            )
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
            self.own.blind()
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
            self._missing, self._plan = near, None
            return
        view = make_view(near, self._records, self.knowledge.alpha_s, self.knowledge.alpha_c)
        alpha = view.threat.alpha_s + self.knowledge.links_worth(view.threat)
        name = digest(view.digest.hex(), alpha)
        if self._plan is None or self._plan.name != name:
            self._plan = ComponentPlan(view, name, alpha, self.own, lambda: self._stamp, self._add)
            self._plan.begin()

    def _add(self, neighbour: int, item: Item) -> None:
        self._channels[neighbour].add(item)

    def _take_part(self, sender: int, item: BaitList | BaitChoice | Bid) -> None:
        """Take an item about a component, if it is the present one."""
        plan = self._plan
        if plan is not None and item.view == plan.name:
            plan.take(sender, item)
        elif item.stamp >= self._stamp:  # its author knew the same records: it should have had the same view
            self.refuse(sender, COMPONENT, "none" if plan is None else plan.name.hex(), item.view.hex())
