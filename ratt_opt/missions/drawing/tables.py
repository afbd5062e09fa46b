"""The rows of ``mission.csv`` (robots) and ``tracks.csv`` (targets)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.missions.result import FlownMission

__all__ = ["MISSION_COLUMNS", "TRACK_COLUMNS", "mission_rows", "track_rows"]

MISSION_COLUMNS = ("step", "robot", "name", "x", "y", "heading", "speed", "turn_rate", "role", "group")
TRACK_COLUMNS = (
    *("step", "target", "name", "group", "team", "true_x", "true_y", "x", "y"),
    *("covariance_xx", "covariance_xy", "covariance_yy", "nees"),
)


def mission_rows(mission: FlownMission) -> Iterator[tuple[object, ...]]:
    """One row of ``MISSION_COLUMNS`` a step and robot: its pose after the control, which group it is in, its role.

    Step 0 is the start, before any control.
    """
    names = [robot.name for robot in mission.scenario.robots]
    for i, pose in enumerate(mission.start.tolist()):
        yield 0, i, names[i], *pose, "", "", "", ""
    for number, step in enumerate(mission.steps, start=1):
        home = {i: k for k, group in enumerate(step.groups) for i in group.robots}
        for i, (pose, control) in enumerate(zip(step.poses.tolist(), step.controls.tolist(), strict=True)):
            yield number, i, names[i], *pose, *control, step.role(i), home[i]


def track_rows(mission: FlownMission) -> Iterator[tuple[object, ...]]:
    """One row of ``TRACK_COLUMNS`` a step, group and target; ``team`` is 1 for the team's group.

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
                group.belief.positions.tolist(),
                group.belief.position_covariance.tolist(),
                error_squared,
                strict=True,
            )
            for j, (truth, place, (first, second), nees) in enumerate(rows):
                spread = (first[0], first[1], second[1])
                yield number, j, names[j], k, int(k == step.best), *truth[:2], *place, *spread, nees
