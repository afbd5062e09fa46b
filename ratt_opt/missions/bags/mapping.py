"""The mapping file of a replay: which topic is which robot's, and which object is which target."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from ratt_opt.errors import FileFormatError, InputError
from ratt_opt.scenario.files import load_scenario, read_json
from ratt_opt.scenario.record import Record, Text, Whole

if TYPE_CHECKING:
    from pathlib import Path

    from ratt_opt.scenario.model import Scenario

__all__ = ["BagMapping", "Detections", "load_mapping"]


class Detections(Record):
    """Detections of one ``robot``, with places in the ``frame`` of the map or of the robot's body."""

    robot: Whole
    frame: Literal["map", "robot"] = "map"


class BagMapping(Record):
    """Mapping from a bag to a scenario: the input of a replay beside the bag.

    ``scenario`` : file of the team, relative to the mapping: its robots, what is known of its targets, sensors, budgets
    and sampling period. ``poses`` : topic of each robot's poses, by topic; ``detections`` : by topic.
    ``targets`` : number of a target in the scenario by the object's name in the bag; other objects are new targets
    (``unknown = "add"``) or skipped. ``motion`` : of the targets, as in :class:`MissionModel`.
    """

    format: Literal["ratt-opt replay mapping"] = "ratt-opt replay mapping"
    version: Literal[1] = 1
    scenario: Text
    poses: dict[str, Whole]
    detections: dict[str, Detections]
    targets: dict[str, Whole] = Field(default_factory=dict)
    unknown: Literal["add", "skip"] = "add"
    motion: Text = "constant velocity"


def load_mapping(path: Path) -> tuple[BagMapping, Scenario]:
    """A mapping file and its team. FileFormatError : it cannot be read, or a field breaks its rule."""
    document = read_json(path)
    if not isinstance(document, dict):
        raise FileFormatError(str(path), "must hold a JSON object", type(document).__name__)
    try:
        mapping = BagMapping(**document)
    except InputError as error:
        raise FileFormatError(f"{path}: {error.argument}", error.rule, error.value) from None
    team = load_scenario(path.parent / mapping.scenario)
    robots = {f"poses[{t!r}]": i for t, i in mapping.poses.items()}
    robots |= {f"detections[{t!r}].robot": one.robot for t, one in mapping.detections.items()}
    for where, i in robots.items():
        if i >= team.n_robots:
            raise FileFormatError(f"{path}: {where}", f"must be in [0, {team.n_robots - 1}]", i)
    for name, j in mapping.targets.items():
        if j >= team.n_targets:
            raise FileFormatError(f"{path}: targets[{name!r}]", f"must be in [0, {team.n_targets - 1}]", j)
    return mapping, team
