"""Pictures for the viewer Rerun, as they come or in a file (``.rrd``); the extra ``live``."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.report.palette import BLINDED, CUT, LOST, SURVIVING, TARGET, rgb

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from ratt_opt._validation import FloatArray

__all__ = ["RerunLog"]

ROLES = {"best group": SURVIVING, "cut off": LOST, "blinded": BLINDED}


@dataclass(frozen=True, slots=True, kw_only=True)
class Marks:
    """Sizes on the map: ``robot`` and ``target`` radii and ``heading`` length [m]; ``corners`` of an ellipse."""

    robot: float = 1.0
    target: float = 0.7
    heading: float = 3.0
    corners: int = 48


@dataclass(slots=True)
class RerunLog:
    """A recording to which pictures are added; without a ``path`` the viewer opens and shows them as they come.

    InputError : the library ``rerun-sdk`` is not installed.
    """

    path: Path | None = None
    marks: Marks = field(default_factory=Marks)
    _rerun: Any = field(init=False, repr=False)
    _stream: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        try:
            import rerun
        except ImportError:
            rule = "needs the extra live (pip install ratt-opt[live])"
            raise InputError("live view", rule, "no module 'rerun'") from None
        self._rerun, self._stream = rerun, rerun.RecordingStream("ratt_opt")
        if self.path is None:
            self._stream.spawn()
        else:
            self._stream.save(str(self.path))

    def add(self, frame: Mapping[str, Any], numbers: Mapping[str, float | None], seconds: float) -> None:
        """Add one picture (see ``frames.py``), numbers to plot, and their time [s]."""
        rr, log = self._rerun, self._stream.log
        self._stream.set_time("time", duration=seconds)
        robots = np.reshape(frame["robots"], (-1, 3))
        colours = [rgb(ROLES[role]) for role in frame["roles"]]
        names = frame.get("names") or [str(i) for i in range(len(robots))]
        log("map/robots", rr.Points2D(robots[:, :2], colors=colours, radii=self.marks.robot, labels=names))
        ahead = self.marks.heading * np.stack([np.cos(robots[:, 2]), np.sin(robots[:, 2])], axis=-1)
        log("map/headings", rr.Arrows2D(origins=robots[:, :2], vectors=ahead, colors=colours))
        for name, colour in (("links", LOST), ("cut", CUT)):
            log(
                f"map/{name}",
                rr.LineStrips2D([robots[list(link), :2] for link in frame[name]], colors=[rgb(colour)]),
            )
        for name, places in (("truth", frame["targets"]), ("estimates", frame["estimates"])):
            log(
                f"map/{name}",
                rr.Points2D(np.reshape(places, (-1, 2)), colors=[rgb(TARGET)], radii=self.marks.target),
            )
        outlines = [self._outline(*pair) for pair in zip(frame["estimates"], frame["ellipses"], strict=True)]
        log("map/uncertainty", rr.LineStrips2D(outlines, colors=[rgb(TARGET)]))
        for name, value in numbers.items():
            if value is not None:
                log(f"numbers/{name}", rr.Scalars(float(value)))

    def _outline(self, centre: list[float], ellipse: list[float]) -> FloatArray:
        """(corners + 1, 2) closed outline of an ellipse."""
        long, short, angle = ellipse
        turn = np.linspace(0.0, 2 * np.pi, self.marks.corners + 1)
        x, y = long * np.cos(turn), short * np.sin(turn)
        cosine, sine = np.cos(angle), np.sin(angle)
        return np.asarray(np.array(centre) + np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1))

    def close(self) -> None:
        """Send on what was added; a file is whole then."""
        self._stream.flush()
        self._stream.disconnect()
