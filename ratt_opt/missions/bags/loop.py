"""The tracker over a bag: measurements in as they were recorded, a plan out at every step."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, readonly
from ratt_opt.errors import FileFormatError
from ratt_opt.missions.bags.mapping import load_mapping
from ratt_opt.missions.bags.reading import Detection, PoseMessage, read_bag
from ratt_opt.missions.bags.record import BagStep, ReplayedBag
from ratt_opt.missions.live.state import Measurement
from ratt_opt.missions.live.tracker import Tracker
from ratt_opt.missions.world import MissionModel
from ratt_opt.problem import Attack
from ratt_opt.scenario.model import Target

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from ratt_opt.missions.bags.mapping import BagMapping
    from ratt_opt.missions.live.view import LiveView
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.scenario.model import Scenario

__all__ = ["BagReplay", "replay_bag"]


class BagReplay(ReplayedBag):
    """A replayed bag: its team, every step, and the bag's object names by target."""

    __slots__ = ()

    def save(self, directory: str | Path) -> list[Path]:
        """Write ``replay.json``, ``tracks.csv``, ``plans.csv``, ``skipped.csv``, figures and ``replay.mcap``.

        InputError : the folder cannot be written.
        """
        from ratt_opt.missions.bags.written import write_replay  # draws

        return write_replay(self, directory)


def replay_bag(
    bag: Path,
    mapping: Path,
    *,
    planner: str | Planner = "ratt",
    gate: float | None = 0.999,
    progress: Callable[[int], object] | None = None,
    view: LiveView | None = None,
) -> BagReplay:
    """Run the tracker over a ROS 1 or ROS 2 bag (``rosbags``, the extra ``bags``).

    Positions of detections become measurements of the scenario's sensors, whose noise counts. Steps are one sampling
    period of the scenario apart, from the time at which every mapped robot has a pose.

    Parameters
    ----------
    bag : a ``.bag`` file, the folder of a ROS 2 bag (``sqlite3`` or MCAP), or an ``.mcap`` file alone
    mapping : file that says which topic is which robot's, see :class:`BagMapping`
    planner, gate : as in :class:`Tracker`
    progress : called with the number of each step
    view : shows each step as it is planned

    Raises
    ------
    FileFormatError : a file cannot be read, or the bag holds no poses.
    InputError : the library is not installed, or an argument breaks its rule.
    """
    wanted, team = load_mapping(mapping)
    events = sorted(read_bag(bag, [*wanted.poses, *wanted.detections]), key=lambda event: event.time)
    run = _Run(wanted, team, Tracker(team, planner=planner, gate=gate, model=MissionModel(motion=wanted.motion)), view)
    first = {event.topic: event.time for event in reversed(events) if isinstance(event, PoseMessage)}
    if set(first) != set(wanted.poses):
        raise FileFormatError(str(bag), "must hold a pose on each mapped topic", sorted(set(wanted.poses) - set(first)))
    period, k = team.sampling_period, 0
    clock, end = max(first.values()), events[-1].time
    while clock <= end + period / 2:
        while k < len(events) and events[k].time <= clock:
            run.take(events[k])
            k += 1
        run.step(clock)
        if progress is not None:
            progress(len(run.steps))
        clock += period
    return BagReplay(scenario=team, steps=tuple(run.steps), objects={j: name for name, j in run.numbers.items()})


@dataclass(slots=True)
class _Run:
    """The state of a replay under way."""

    mapping: BagMapping
    team: Scenario
    tracker: Tracker
    view: LiveView | None = None
    steps: list[BagStep] = field(default_factory=list)
    waiting: list[tuple[Detection, FloatArray]] = field(default_factory=list)
    numbers: dict[str, int] = field(default_factory=dict)
    poses: FloatArray = field(init=False)
    unsure: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        n, p = self.team.poses.shape
        self.poses, self.unsure = np.array(self.team.poses), np.zeros((n, p, p))
        self.numbers = dict(self.mapping.targets)

    def take(self, event: PoseMessage | Detection) -> None:
        """A message arrives: a detection is kept with the pose from which it was made."""
        p = self.poses.shape[1]
        if isinstance(event, PoseMessage):
            robot = self.mapping.poses[event.topic]
            self.poses[robot], self.unsure[robot] = event.pose[:p], event.covariance[:p, :p]
        else:
            robot = self.mapping.detections[event.topic].robot
            self.waiting.append((event, self.poses[robot].copy()))

    def step(self, clock: float) -> None:
        """One step of the tracker with what has arrived."""
        made = [one for event, pose in self.waiting if (one := self._measurement(event, pose)) is not None]
        count, self.waiting = len(self.waiting), []
        before = readonly(self.poses)
        plan = self.tracker.step(made, now=clock, poses=before, pose_covariances=self.unsure)
        self.steps.append(
            BagStep(
                time=clock,
                poses=before,
                plan=plan,
                controls=self.tracker.controls,
                targets=self.tracker.targets,
                belief=self.tracker.beliefs,
                measured=count,
                links=self.tracker.world.communication(before, Attack()).links,
            )
        )
        if self.view is not None:
            self.view.show(self.tracker, plan)

    def _measurement(self, event: Detection, pose: FloatArray) -> Measurement | None:
        how = self.mapping.detections[event.topic]
        place, velocity = event.place, np.zeros(3) if event.velocity is None else event.velocity
        if how.frame == "robot":
            cosine, sine = np.cos(pose[2]), np.sin(pose[2])
            turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
            above = pose[3] if len(pose) > 3 else 0.0
            place, velocity = turn @ place + [*pose[:2], above], turn @ velocity
        if event.object not in self.numbers:
            if self.mapping.unknown == "skip":
                return None
            self.numbers[event.object] = self.tracker.add_target(_appeared(event, place, velocity))
            return None  # it is where it was seen: that sighting is what is known of it
        sensor = self.tracker.world.sensors[how.robot]
        state = np.array([*place[:2], *velocity[:2], place[2], velocity[2]])[: sensor.reads]
        values = sensor.measure(pose, state)
        return Measurement(how.robot, self.numbers[event.object], tuple(values.tolist()), event.time)


def _appeared(event: Detection, place: FloatArray, velocity: FloatArray) -> Target:
    """A new target as its first detection says."""
    speed, heading = float(np.hypot(*velocity[:2])), float(np.arctan2(velocity[1], velocity[0]))
    spread = (event.covariance[:2, :2] + event.covariance[:2, :2].T) / 2
    known = {"covariance": spread.tolist()} if np.linalg.eigvalsh(spread)[0] > 0 else {}
    return Target(x=place[0], y=place[1], z=place[2], speed=speed, heading=heading, name=event.object, **known)
