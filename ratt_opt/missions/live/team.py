"""A tracker in every robot, without a centre: each takes in what it measured and what it heard over the links left."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, readonly
from ratt_opt.missions.live.tracker import Tracker
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.missions.live.packets import TrackerPlan
    from ratt_opt.missions.live.state import Measurement, TrackerState
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.scenario.model import Scenario

__all__ = ["TeamStep", "TeamTrackers"]


@dataclass(frozen=True, slots=True, eq=False)
class _Packet:
    """Pose (p,) and measurements of one robot at one time [s]."""

    robot: int
    time: float
    pose: FloatArray
    measurements: tuple[Measurement, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TeamStep:
    """Choices of all robots after a step.

    ``elements`` (N,) and ``controls`` (N, c) : each robot's own, from its own plan; ``plans`` : the whole plan that
    each made; ``groups`` : robots that told each other all they know
    """

    elements: IntArray
    controls: FloatArray
    plans: tuple[TrackerPlan, ...]
    groups: tuple[frozenset[int], ...]


@dataclass(slots=True, eq=False)
class _Memory:
    """Packets that a robot holds, by ``(step, robot)``, and those that its tracker does not know yet."""

    held: dict[tuple[int, int], _Packet] = field(default_factory=dict)
    fresh: list[_Packet] = field(default_factory=list)

    def hear(self, packets: dict[tuple[int, int], _Packet]) -> None:
        """Keep the packets that are new."""
        new = {key: packet for key, packet in packets.items() if key not in self.held}
        self.held |= new
        self.fresh += new.values()


class TeamTrackers:
    """One :class:`Tracker` per robot; robots that are linked tell each other their packets.

    A packet has a robot's pose and measurements of one step. Robots pass on all packets that they hold, old ones too:
    what was measured while the team was split is taken in, at its own time and pose, when links return (within the
    trackers' ``lag``). Where a robot that it does not hear is, a tracker takes from its own plan. Robots of one group
    hold the same packets, so they have the same belief and make the same plan.

    Parameters
    ----------
    scenario, planner, options : of every tracker

    ``trackers`` : robot by robot; ``poses`` (N, p) : where each robot knows itself to be.

    Raises
    ------
    InputError : as :class:`Tracker`.
    """

    def __init__(self, scenario: Scenario, *, planner: str | Planner = "decentralised", **options: Any) -> None:
        self.trackers = tuple(Tracker(scenario, planner=planner, **options) for _ in range(scenario.n_robots))
        self._memories = [_Memory() for _ in self.trackers]
        self._steps = 0

    @property
    def poses(self) -> FloatArray:
        """(N, p) poses that the robots' own plans led to."""
        return readonly(np.stack([tracker.state.poses[i] for i, tracker in enumerate(self.trackers)]))

    def step(
        self, measurements: Iterable[Measurement] = (), attack: Attack | None = None, *, standing: Attack | None = None
    ) -> TeamStep:
        """Measure, tell, hear and plan, all robots in one sampling period.

        Parameters
        ----------
        measurements : those that robots made now; none of a blinded robot counts
        attack : in force as they measured and told each other; none by default
        standing : what of it robots know to stay: they plan without these sensors and links

        Raises
        ------
        InputError : as :meth:`Tracker.step` and :meth:`Tracker.attacked`.
        """
        attack, poses, made = attack or Attack(), self.poses, list(measurements)
        time = self._steps * self.trackers[0].world.period
        for i, memory in enumerate(self._memories):
            own = tuple(one for one in made if one.robot == i and i not in attack.sensing)
            memory.hear({(self._steps, i): _Packet(i, time, poses[i], own)})
        groups = self.trackers[0].world.communication(poses, attack).groups()
        for group in groups:
            known = {key: one for i in sorted(group) for key, one in self._memories[i].held.items()}
            for i in group:
                self._memories[i].hear(known)
        plans = tuple(self._planned(i, time, standing or Attack()) for i in range(len(self.trackers)))
        self._steps += 1
        return TeamStep(
            elements=readonly(np.array([plan.elements[i] for i, plan in enumerate(plans)])),
            controls=readonly(np.stack([tracker.controls[i] for i, tracker in enumerate(self.trackers)])),
            plans=plans,
            groups=tuple(sorted(groups, key=min)),
        )

    def _planned(self, robot: int, time: float, standing: Attack) -> TrackerPlan:
        """Let one tracker take in what its robot has heard since its last step, and plan."""
        tracker, memory = self.trackers[robot], self._memories[robot]
        fresh, memory.fresh = sorted(memory.fresh, key=lambda packet: (packet.time, packet.robot)), []
        oldest = time - tracker.lag
        memory.held = {key: packet for key, packet in memory.held.items() if packet.time >= oldest}
        here = tracker.state.poses.copy()
        for packet in fresh:
            if packet.time == time:
                here[packet.robot] = packet.pose
            else:
                tracker.state = _moved(tracker.state, packet, tracker.world.on_time)
        told = [replace(one, time=packet.time) for packet in fresh for one in packet.measurements]
        if tracker.state.attack != standing:
            tracker.attacked(standing)
        return tracker.step(told, now=time, poses=here)


def _moved(state: TrackerState, packet: _Packet, near: float) -> TrackerState:
    """The state once it is known where a robot was at an earlier time."""
    moments = list(state.moments)
    for k, moment in enumerate(moments):
        if abs(moment.time - packet.time) <= near:
            poses = moment.poses.copy()
            poses[packet.robot] = packet.pose
            moments[k] = replace(moment, poses=readonly(poses))
    return replace(state, moments=tuple(moments))
