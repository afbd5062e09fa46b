"""Agents in processes of their own, which talk through streams on loopback: another driver of the same agents.

Each process listens on a port of 127.0.0.1 that the system gives, and connects to its neighbours of higher numbers. A
packet is preceded by its length. A stream that ends is a lost link. The parent says when to begin and when all
robots have ended; every wait has a limit, and no process outlives the call.
"""

from __future__ import annotations

import asyncio
import struct
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from time import monotonic
from typing import TYPE_CHECKING, Any

from ratt_opt._validation import check_integer
from ratt_opt.decentralised.agent import Agent
from ratt_opt.decentralised.messages import VERSION, decode, encode
from ratt_opt.decentralised.plan import knowledge_of
from ratt_opt.errors import InputError
from ratt_opt.problem import check_problem

if TYPE_CHECKING:
    from collections.abc import Mapping
    from multiprocessing.context import SpawnProcess

    from ratt_opt.decentralised.knowledge import ExchangeParams, Knowledge
    from ratt_opt.problem import Problem

__all__ = ["ProcessParams", "ProcessPlan", "plan_in_processes"]

HERE, LENGTH, NUMBER = "127.0.0.1", struct.Struct("<I"), struct.Struct("<H")


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessParams:
    """Limits of the processes.

    ``most_robots`` : more are refused: each is a process; ``seconds`` : of the whole call, after which it fails [s];
    ``tick`` : until items that may be lost are sent again [s]: streams lose nothing, so it only answers
    """

    most_robots: int = 32
    seconds: float = 60.0
    tick: float = 0.05


PARAMS = ProcessParams()


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessPlan:
    """Plan of robots in processes: ``elements`` by robot, ``None`` for one whose process was killed.

    ``seconds`` : from the moment all were connected until the last one had ended [s]; ``messages`` : packets sent
    """

    elements: tuple[int | None, ...]
    bait: tuple[int, ...]
    components: tuple[tuple[int, ...], ...]
    seconds: float
    messages: int


def plan_in_processes(
    problem: Problem,
    *,
    hops: int | None = None,
    exchanges: ExchangeParams | None = None,
    killed: tuple[int, ...] = (),
    versions: Mapping[int, int] | None = None,
    params: ProcessParams = PARAMS,
) -> ProcessPlan:
    """Plan by messages between real processes on loopback.

    Parameters
    ----------
    problem : with a criterion of information matrices
    hops, exchanges : as in :func:`decentralised_ratt` and :func:`decentralised_refined`
    killed : robots whose process is killed as the others begin
    versions : robots whose messages are of another version, to see them refused

    Raises
    ------
    InputError : robots are too many, or a process has not ended within the limit.
    """
    n = check_integer("n_robots", check_problem(problem).n_robots, low=1, high=params.most_robots)
    for robot in killed:
        check_integer("killed", robot, low=0, high=n - 1)
    odd = versions or {}
    context = get_context("spawn")
    lines: list[Connection] = []
    processes: list[SpawnProcess] = []
    try:
        for i in range(n):
            ours, theirs = context.Pipe()
            told = knowledge_of(problem, i, hops=hops, exchanges=exchanges, version=odd.get(i, VERSION))
            process = context.Process(target=_run, args=(told, theirs, params), daemon=True)
            process.start()
            theirs.close()
            lines.append(ours)
            processes.append(process)
        return _conducted(lines, processes, killed, monotonic() + params.seconds)
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.join()
        for line in lines:
            line.close()


def _conducted(
    lines: list[Connection], processes: list[SpawnProcess], killed: tuple[int, ...], until: float
) -> ProcessPlan:
    """Tell every process the ports, let all begin, and wait for the last end."""
    ports = _answers(lines, range(len(lines)), until)
    for line in lines:
        line.send(ports)
    _answers(lines, range(len(lines)), until)
    begun = monotonic()
    for robot in killed:
        processes[robot].kill()
    left = [i for i in range(len(lines)) if i not in killed]
    for i in left:
        lines[i].send(None)
    found: dict[int, tuple[Any, ...]] = {}
    while not _agree(found, left):
        found |= _answers(lines, left, until, at_least=1)
    seconds = monotonic() - begun
    parts = sorted({found[i][2] for i in left} | {(i,) for i in killed})
    return ProcessPlan(
        elements=tuple(None if i in killed else found[i][0] for i in range(len(lines))),
        bait=tuple(sorted(i for i in left if i in found[i][1])),
        components=tuple(parts),
        seconds=seconds,
        messages=sum(found[i][3] for i in left),
    )


def _agree(found: Mapping[int, tuple[Any, ...]], left: list[int]) -> bool:
    """Test whether all have ended, and the robots of each component name the same ones, all of them alive."""
    if len(found) < len(left):
        return False
    return all(set(found[i][2]) <= set(left) and all(found[j][2] == found[i][2] for j in found[i][2]) for i in left)


def _answers(lines: list[Connection], robots: Any, until: float, at_least: int | None = None) -> dict[int, Any]:
    """One answer of each robot, or of some."""
    found: dict[int, Any] = {}
    number = {id(lines[i]): i for i in robots}
    wanted = len(number) if at_least is None else at_least
    while len(found) < wanted:
        ready = wait([lines[i] for i in robots if i not in found], timeout=max(until - monotonic(), 0.0))
        if not ready:
            late = sorted(set(robots) - set(found))
            raise InputError("seconds", "must suffice for all processes", f"robots {late} have not answered")
        for line in ready:
            assert isinstance(line, Connection)
            try:
                found[number[id(line)]] = line.recv()
            except EOFError:
                rule = "must run until the plan is made"
                raise InputError(f"process of robot {number[id(line)]}", rule, "it ended") from None
    return found


def _run(knowledge: Knowledge, parent: Connection, params: ProcessParams) -> None:
    """Entry of a process."""
    with suppress(KeyboardInterrupt, EOFError, BrokenPipeError):
        asyncio.run(_Robot(knowledge, parent, params).live())


@dataclass(slots=True)
class _Robot:
    """One agent and its streams."""

    knowledge: Knowledge
    parent: Connection
    params: ProcessParams
    streams: dict[int, tuple[asyncio.StreamReader, asyncio.StreamWriter]] = field(default_factory=dict)
    messages: int = 0
    told: tuple[Any, ...] | None = None

    async def live(self) -> None:
        """Connect, wait for the word to begin, and exchange packets until the parent ends the process."""
        server = await asyncio.start_server(self._greeted, HERE, 0)
        self.parent.send(server.sockets[0].getsockname()[1])
        ports = await asyncio.to_thread(self.parent.recv)
        own = self.knowledge.robot
        for other in self.knowledge.neighbours:
            if other > own:
                reader, writer = await asyncio.open_connection(HERE, ports[other])
                writer.write(NUMBER.pack(own))
                self.streams[other] = reader, writer
        while len(self.streams) < len(self.knowledge.neighbours):
            await asyncio.sleep(0.001)
        self.parent.send("connected")
        await asyncio.to_thread(self.parent.recv)
        agent = Agent(self.knowledge)
        self._flush(agent)
        await asyncio.gather(self._pass_time(agent), *(self._listen(agent, other) for other in list(self.streams)))

    async def _greeted(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        (other,) = NUMBER.unpack(await reader.readexactly(NUMBER.size))
        self.streams[other] = reader, writer

    async def _listen(self, agent: Agent, other: int, longest: int = 2**26) -> None:
        """Take packets of at most that many bytes of one neighbour until its stream ends or it speaks otherwise."""
        reader, writer = self.streams[other]
        try:
            while True:
                (size,) = LENGTH.unpack(await reader.readexactly(LENGTH.size))
                if size > longest:
                    raise InputError("packet", f"must have at most {longest} bytes", size)
                agent.receive(decode(await reader.readexactly(size), agent.version))
                self._flush(agent)
        except (asyncio.IncompleteReadError, ConnectionError):
            agent.lose(other)
        except InputError as error:
            agent.refuse(other, "packets", "packets of this version", str(error))
        writer.close()
        self._flush(agent)

    async def _pass_time(self, agent: Agent) -> None:
        while True:
            await asyncio.sleep(self.params.tick)
            agent.tick()
            self._flush(agent)

    def _flush(self, agent: Agent) -> None:
        """Write all packets that are ready, and tell the parent of an end that it does not know."""
        for other in agent.addressees:
            _, writer = self.streams[other]
            while not writer.is_closing() and (packet := agent.send(other)) is not None:
                data = encode(packet)
                writer.write(LENGTH.pack(len(data)) + data)
                self.messages += 1
        ended = (agent.element, agent.bait, agent.component) if agent.has_ended else None
        if ended is not None and ended != self.told:
            self.told = ended
            self.parent.send((*ended, self.messages))
