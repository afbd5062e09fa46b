"""A mission as an MCAP log, for the viewers of the field (Foxglove, Lichtblick, PlotJuggler); the extra ``viewers``.

Topics: ``/scene`` (robots coloured by role, links, targets' 95 % ellipses), ``/robots``, ``/targets/truth``,
``/targets/estimate`` (poses) and ``/mission`` (numbers to plot). Messages are JSON under the viewers' own schema names.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.missions.drawing.frames import frames_of
from ratt_opt.missions.drawing.rerun_log import RerunLog
from ratt_opt.report.palette import BLINDED, CUT, LOST, SURVIVING, TARGET, rgb

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from ratt_opt.missions.result import FlownMission

__all__ = ["save_frames", "save_log", "save_recording"]

FRAME = "map"
TOPICS = {
    "/scene": "foxglove.SceneUpdate",
    "/robots": "foxglove.PosesInFrame",
    "/targets/truth": "foxglove.PosesInFrame",
    "/targets/estimate": "foxglove.PosesInFrame",
    "/mission": "ratt_opt.Mission",
}
ROLES = {"best group": SURVIVING, "cut off": LOST, "blinded": BLINDED}
NANOSECONDS = 10**9


def save_log(mission: FlownMission, path: Path) -> None:
    """Write the log; time 0 is the mission's start.

    InputError : the library ``mcap`` is not installed.
    """
    period = mission.scenario.sampling_period
    frames = frames_of(mission)
    save_frames(path, frames, _numbers(mission), [frame["step"] * period for frame in frames])


def save_recording(mission: FlownMission, path: Path) -> None:
    """Write the same pictures for the viewer Rerun. InputError : the library ``rerun-sdk`` is not installed."""
    log, period = RerunLog(path), mission.scenario.sampling_period
    for frame, numbers in zip(frames_of(mission), _numbers(mission), strict=True):
        log.add(frame, numbers, frame["step"] * period)
    log.close()


def save_frames(
    path: Path, frames: Sequence[dict[str, Any]], numbers: Sequence[dict[str, Any]], times: Sequence[float]
) -> None:
    """Write pictures with their numbers and times [s].

    InputError : the library ``mcap`` is not installed.
    """
    try:
        from mcap.writer import Writer
    except ImportError:
        raise InputError("path", "needs the extra viewers (pip install ratt-opt[viewers])", path.suffix) from None
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(library="ratt-opt")
        schemas = {
            name: writer.register_schema(name=name, encoding="jsonschema", data=b'{"type": "object"}')
            for name in sorted(set(TOPICS.values()))
        }
        rgb = {
            topic: writer.register_channel(topic=topic, message_encoding="json", schema_id=schemas[name])
            for topic, name in TOPICS.items()
        }
        for frame, row, seconds in zip(frames, numbers, times, strict=True):
            time = round(seconds * NANOSECONDS)
            for topic, message in {**_messages(frame, time), "/mission": row}.items():
                data = json.dumps(message, allow_nan=False).encode()
                writer.add_message(channel_id=rgb[topic], log_time=time, publish_time=time, data=data)
        writer.finish()


def _numbers(mission: FlownMission) -> list[dict[str, Any]]:
    document = mission.to_dict()
    names = ("rmse", "trace", "nees", "nis", "value")
    return [
        {"step": k + 1, "blinded": len(attack["sensing"]), "cut": len(attack["links"])}
        | {name: document[name][k] for name in names}
        for k, attack in enumerate(document["attacks"])
    ]


def _messages(frame: dict[str, Any], time: int) -> dict[str, Any]:
    stamp = {"sec": time // NANOSECONDS, "nsec": time % NANOSECONDS}
    head = {"timestamp": stamp, "frame_id": FRAME}
    entities = [{**head, "id": "mission", "lifetime": {"sec": 0, "nsec": 0}, **_shapes(frame)}]
    return {
        "/scene": {"deletions": [], "entities": entities},
        "/robots": {**head, "poses": [_pose(x, y, angle) for x, y, angle in frame["robots"]]},
        "/targets/truth": {**head, "poses": [_pose(x, y) for x, y in frame["targets"]]},
        "/targets/estimate": {**head, "poses": [_pose(x, y) for x, y in frame["estimates"]]},
    }


def _shapes(frame: dict[str, Any]) -> dict[str, Any]:
    """Robots as cubes, ellipses as flat spheres, links as lines."""
    robots = frame["robots"]
    cubes = [
        {"pose": _pose(*place), "size": {"x": 2.0, "y": 1.5, "z": 1.0}, "color": _colour(ROLES[role])}
        for place, role in zip(robots, frame["roles"], strict=True)
    ]
    spheres = [
        {"pose": _pose(x, y, angle), "size": {"x": 2 * a, "y": 2 * b, "z": 0.1}, "color": _colour(TARGET, 0.4)}
        for (x, y), (a, b, angle) in zip(frame["estimates"], frame["ellipses"], strict=True)
    ]
    lines = [
        {
            "type": 2,  # a list of segments
            "pose": _pose(0.0, 0.0),
            "thickness": 1.0,
            "scale_invariant": True,
            "points": [{"x": robots[i][0], "y": robots[i][1], "z": 0.0} for link in links for i in link],
            "color": _colour(colour, 0.7),
            "colors": [],
            "indices": [],
        }
        for links, colour in ((frame["links"], LOST), (frame["cut"], CUT))
    ]
    return {"cubes": cubes, "spheres": spheres, "lines": lines}


def _pose(x: float, y: float, angle: float = 0.0) -> dict[str, Any]:
    turn = {"x": 0.0, "y": 0.0, "z": float(np.sin(angle / 2)), "w": float(np.cos(angle / 2))}
    return {"position": {"x": x, "y": y, "z": 0.0}, "orientation": turn}


def _colour(code: str, opacity: float = 1.0) -> dict[str, float]:
    red, green, blue = (value / 255 for value in rgb(code))
    return {"r": red, "g": green, "b": blue, "a": opacity}
