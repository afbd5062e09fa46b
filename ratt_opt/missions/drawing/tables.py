"""The rows of ``mission.csv`` (robots) and ``tracks.csv`` (targets)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.missions.result import FlownMission

__all__ = ["mission_columns", "mission_rows", "track_columns", "track_rows"]

MISSION_COLUMNS = ("step", "robot", "name", "x", "y", "heading", "speed", "turn_rate", "role", "group")
TRACK_COLUMNS = (
    *("step", "target", "name", "group", "team", "true_x", "true_y", "x", "y"),
    *("covariance_xx", "covariance_xy", "covariance_yy", "nees"),
)


def mission_columns(mission: FlownMission) -> tuple[str, ...]:
    """Columns of :func:`mission_rows`: heights and motion to the left and up only if there are any."""
    return (*MISSION_COLUMNS, *(("z",) if mission.start.shape[1] > 3 else ()), *_beside(mission))


def track_columns(mission: FlownMission) -> tuple[str, ...]:
    """Columns of :func:`track_rows`: estimated and true velocities, heights and so on if the motion has them."""
    names = ("vx", "vy", "z", "climb") if mission.dimension > 5 else ("vx", "vy", "turn_rate")
    more = names[: mission.dimension - 2]
    return (*TRACK_COLUMNS, *more, *(f"true_{name}" for name in more))


def _beside(mission: FlownMission) -> tuple[str, ...]:
    holonomic = any(robot.motion == "holonomic" for robot in mission.scenario.robots)
    return ("left", "climb") if holonomic else ()


def _parts(motion: str, control: list[float]) -> tuple[float, float, float, float]:
    """Speed forward, turn rate, speed to the left and climb rate of a control."""
    forward, second, third, climb = (*control, 0.0, 0.0)[:4]
    return (forward, third, second, climb) if motion == "holonomic" else (forward, second, 0.0, 0.0)


def mission_rows(mission: FlownMission) -> Iterator[tuple[object, ...]]:
    """One row of :func:`mission_columns` a step and robot: its pose after the control, which group it is in, its role.

    Step 0 is the start, before any control.
    """
    names, beside = [robot.name for robot in mission.scenario.robots], _beside(mission)
    for i, pose in enumerate(mission.start.tolist()):
        yield 0, i, names[i], *pose[:3], "", "", "", "", *pose[3:], *("" for _ in beside)
    for number, step in enumerate(mission.steps, start=1):
        home = {i: k for k, group in enumerate(step.groups) for i in group.robots}
        for i, (pose, control) in enumerate(zip(step.poses.tolist(), step.controls.tolist(), strict=True)):
            speed, turn, *more = _parts(mission.scenario.robots[i].motion, control)
            yield number, i, names[i], *pose[:3], speed, turn, step.role(i), home[i], *pose[3:], *more[: len(beside)]


def track_rows(mission: FlownMission) -> Iterator[tuple[object, ...]]:
    """One row of :func:`track_columns` a step, group and target; ``team`` is 1 for the team's group.

    Sharing the best group's belief only, that group's belief is everybody's, and no other is written.
    """
    names = [target.name for target in mission.scenario.targets]
    for number, step in enumerate(mission.steps, start=1):
        for k, group in enumerate(step.groups):
            if k != step.best and group.belief == step.team.belief:
                continue
            error_squared = group.belief.nees(step.truth).tolist()
            rows = zip(
                step.truth.tolist(),
                group.belief.mean.tolist(),
                group.belief.position_covariance.tolist(),
                error_squared,
                strict=True,
            )
            for j, (truth, place, (first, second), nees) in enumerate(rows):
                spread = (first[0], first[1], second[1])
                yield (
                    number,
                    j,
                    names[j],
                    k,
                    int(k == step.best),
                    *truth[:2],
                    *place[:2],
                    *spread,
                    nees,
                    *place[2:],
                    *truth[2:],
                )
