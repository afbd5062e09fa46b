"""Motions of robots: the paper's, turning while they drive, flying sideways, or one of your own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.scenario.motion import fly_robots, move_robots

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.scenario.model import Scenario

    MoveRobots = Callable[[FloatArray, FloatArray, float], FloatArray]

__all__ = ["ROBOT_MOTIONS", "RobotMotion", "TeamMotion", "check_robot_motion", "move_on_arcs"]


def move_on_arcs(poses: FloatArray, controls: FloatArray, period: float) -> FloatArray:
    """Unicycle poses after one period of driving on an arc: the heading turns during the step.

    Parameters
    ----------
    poses : (..., 3 or 4) x [m], y [m], heading [rad], height [m], which stays
    controls : (..., 2) speed [m/s], turn rate [rad/s]
    period : sampling period [s]

    Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), eq. 5.9; the chord of the arc is written with
    ``sin(a) / a``, which has no singularity at turn rate 0.
    """
    half = period * controls[..., 1] / 2
    chord = period * controls[..., 0] * np.sinc(half / np.pi)
    moved = (
        poses[..., 0] + chord * np.cos(poses[..., 2] + half),
        poses[..., 1] + chord * np.sin(poses[..., 2] + half),
        poses[..., 2] + 2 * half,
        *np.moveaxis(poses[..., 3:], -1, 0),
    )
    return np.stack(np.broadcast_arrays(*moved), axis=-1)


class RobotMotion(ABC):
    """A motion of your own for all robots: subclass it and give it as ``MissionModel(robot_motion=...)``."""

    @abstractmethod
    def move(self, poses: FloatArray, controls: FloatArray, period: float) -> FloatArray:
        """(..., p) poses after one period.

        ``poses`` : (..., 3 or 4) x [m], y [m], heading [rad], height [m] if the team has heights; ``controls`` :
        (..., c) those of the scenario's robots, with zeros behind shorter ones; ``period`` [s].
        """


ROBOT_MOTIONS: dict[str, MoveRobots] = {"paper": move_robots, "arc": move_on_arcs, "holonomic": fly_robots}
"""``"paper"`` moves along the heading held before the turn; ``"holonomic"`` in any direction."""


def check_robot_motion(motion: object) -> None:
    """InputError : it is neither a motion's name nor a :class:`RobotMotion`."""
    if not isinstance(motion, RobotMotion) and not (isinstance(motion, str) and motion in ROBOT_MOTIONS):
        shown = motion if isinstance(motion, str) else type(motion).__name__
        raise InputError("robot_motion", f"must be {', '.join(ROBOT_MOTIONS)} or a RobotMotion", shown)


@dataclass(frozen=True, slots=True)
class TeamMotion:
    """Motions of a team, in groups of robots that move alike: ``moves`` of the robots in ``robots``."""

    moves: tuple[tuple[MoveRobots, frozenset[int]], ...]

    @classmethod
    def of(cls, scenario: Scenario, motion: str | RobotMotion) -> TeamMotion:
        """Unicycles as ``motion`` says, holonomic robots as such; all of them by a motion of one's own."""
        check_robot_motion(motion)
        everybody = frozenset(range(scenario.n_robots))
        if isinstance(motion, RobotMotion):
            return cls(((motion.move, everybody),))
        flying = frozenset(i for i, robot in enumerate(scenario.robots) if robot.motion == "holonomic")
        groups = ((ROBOT_MOTIONS[motion], everybody - flying), (fly_robots, flying))
        return cls(tuple(group for group in groups if group[1]))

    def moved(self, owner: IntArray, poses: FloatArray, controls: FloatArray, period: float) -> FloatArray:
        """(K, p) poses after one period of controls (K, c) by their robots ``owner`` (K,)."""
        if len(self.moves) == 1:
            return self.moves[0][0](poses, controls, period)
        after = np.empty_like(poses)
        for move, robots in self.moves:
            own = np.isin(owner, sorted(robots))
            after[own] = move(poses[own], controls[own], period)
        return after
