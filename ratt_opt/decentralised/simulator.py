"""Deterministic simulation of agents that plan by radio: one event after the other, everything random from one seed.

A robot's radio sends one packet at a time, to its neighbours in turn. A packet takes ``bits / bandwidth``, then a
random delay. An event is an arrival, the end of a transmission, a tick, a fault, or the news of a lost link. The
simulation is over once no event is left: all items have arrived, and every robot has ended or crashed.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from heapq import heappop, heappush
from random import Random
from typing import TYPE_CHECKING

from ratt_opt.budget import Budget, Stop

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ratt_opt.decentralised.agent import Agent
    from ratt_opt.decentralised.faults import Faults
    from ratt_opt.decentralised.messages import Packet

__all__ = ["Costs", "Simulation"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Costs:
    """Price of a plan, until the last robot has ended or planning was stopped.

    ``rounds`` : longest chain of messages; ``messages`` and ``bytes`` : packets sent, lost and repeated ones included;
    ``time`` : seconds of the radios.
    """

    rounds: int = 0
    messages: int = 0
    bytes: int = 0
    time: float = 0.0


@dataclass(slots=True)
class Simulation:
    """Agents by robot number, what goes wrong, and a seed. :meth:`run` once.

    ``costs`` : until the last robot ended. ``met`` : faults that came before that.
    ``cut`` : links; ``crashed`` : robots.
    """

    agents: Mapping[int, Agent]
    faults: Faults
    seed: int
    costs: Costs = Costs()
    met: list[tuple[int, str, tuple[int, ...]]] = field(default_factory=list)
    cut: set[tuple[int, int]] = field(default_factory=set)
    crashed: set[int] = field(default_factory=set)
    _now: float = 0.0
    _rounds: int = 0
    _messages: int = 0
    _bytes: int = 0
    _count: int = 0
    _events: list[tuple[float, int, Callable[[], int | None]]] = field(default_factory=list)
    _depth: dict[int, int] = field(default_factory=dict)
    _turn: dict[int, deque[int]] = field(default_factory=dict)
    _sending: set[int] = field(default_factory=set)
    _ticking: set[int] = field(default_factory=set)
    _awake: set[int] = field(default_factory=set)
    _random: Random = field(default_factory=Random)

    def run(self, budget: Budget | None = None, look: int = 256) -> Stop:
        """Run until nothing is left to do: ``EXHAUSTED``; or until the budget is over.

        ``look`` : events between two looks at the budget, some milliseconds.
        """
        budget = budget or Budget()
        self._random = Random(self.seed)
        due = deque(self.faults.by_round())
        for i, agent in self.agents.items():
            self._depth[i], self._turn[i] = 0, deque(agent.neighbours)
            self._awake.add(i)
        self._break(due)
        for i in self.agents:
            self._attend(i)
        steps = 0
        while self._events:
            steps += 1
            if steps % look == 0 and (stop := budget.stop()) is not None:
                self._settle()
                return stop
            self._now, _, event = heappop(self._events)
            robot = event()
            if robot is not None:
                self._attend(robot)
            if due and due[0][0] <= self._rounds and self._awake:
                self._break(due)
        assert not self._awake, f"robots {sorted(self._awake)} wait for ever"
        return Stop.EXHAUSTED

    def _at(self, delay: float, event: Callable[[], int | None]) -> None:
        self._count += 1
        heappush(self._events, (self._now + delay, self._count, event))

    def _attend(self, robot: int) -> None:
        """Note whether a robot has ended, start its radio, and set its clock."""
        if robot in self.crashed:
            return
        agent = self.agents[robot]
        if not agent.has_ended:
            self._awake.add(robot)
        elif robot in self._awake:
            self._awake.discard(robot)
            if not self._awake:
                self._settle()
        if robot not in self._sending:
            self._send(robot)
        if robot not in self._ticking and not agent.is_idle:
            self._ticking.add(robot)
            self._at(self.faults.radio.tick, lambda: self._tick(robot))

    def _settle(self) -> None:
        self.costs = Costs(rounds=self._rounds, messages=self._messages, bytes=self._bytes, time=self._now)

    def _tick(self, robot: int) -> int:
        self._ticking.discard(robot)
        if robot not in self.crashed:
            self.agents[robot].tick()
        return robot

    def _send(self, robot: int) -> None:
        """Send the next packet, neighbours in turn, if there is one."""
        agent, turn = self.agents[robot], self._turn[robot]
        for _ in range(len(turn)):
            other = turn[0]
            turn.rotate(-1)
            packet = agent.send(other)
            if packet is None:
                continue
            self._sending.add(robot)
            self._transmit(packet, other)
            return

    def _transmit(self, packet: Packet, other: int) -> None:
        robot, size = packet.sender, packet.size
        self._messages += 1
        self._bytes += size
        seconds, depth = 8 * size / self.faults.radio.bandwidth, self._depth[robot] + bool(packet.items)
        self._at(seconds, lambda: self._is_free(robot))
        for _ in range(1 + (self._random.random() < self.faults.duplicates)):
            if self._random.random() >= self.faults.loss:
                delay = self._random.uniform(*self.faults.radio.delay)
                self._at(seconds + delay, lambda: self._arrive(packet, other, depth))

    def _is_free(self, robot: int) -> int:
        self._sending.discard(robot)
        return robot

    def _arrive(self, packet: Packet, robot: int, depth: int) -> int | None:
        if robot in self.crashed or (min(packet.sender, robot), max(packet.sender, robot)) in self.cut:
            return None
        if depth > self._depth[robot]:
            self._depth[robot] = depth
            self._rounds = max(self._rounds, depth)
        self.agents[robot].receive(packet)
        return robot

    # ------------------------------------------------------------------ faults

    def _break(self, due: deque[tuple[int, str, tuple[int, ...]]]) -> None:
        while due and due[0][0] <= self._rounds:
            fault = due.popleft()
            _, kind, who = fault
            self.met.append(fault)
            if kind == "cut":
                self._cut(*who)
            elif who[0] not in self.crashed and kind == "blinded":
                self.agents[who[0]].blind()
                self._attend(who[0])
            elif who[0] not in self.crashed:
                self._crash(who[0])

    def _cut(self, i: int, j: int) -> None:
        self.cut.add((min(i, j), max(i, j)))
        self._notify(i, j)
        self._notify(j, i)

    def _crash(self, robot: int) -> None:
        self.crashed.add(robot)
        self._awake.discard(robot)
        for other in self._turn[robot]:
            self._notify(other, robot)
        if not self._awake:
            self._settle()

    def _notify(self, robot: int, other: int) -> None:
        self._at(self.faults.radio.detection, lambda: self._lose(robot, other))

    def _lose(self, robot: int, other: int) -> int | None:
        if robot in self.crashed:
            return None
        self.agents[robot].lose(other)
        return robot
