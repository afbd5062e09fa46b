"""Parameters of missions and trackers: what is passed in ``MissionModel(params=...)``."""

from __future__ import annotations

from dataclasses import dataclass

from ratt_opt.errors import InputError

__all__ = ["MissionParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionParams:
    """Parameters of a mission's filter, plans and clock; ``replace`` changes some.

    ``linearisations`` : of an iterated update; with the paper's settings the estimate no longer moves visibly after 3
    ``on_top`` : distance [m] below which a measurement has no derivative: it is linearised at the point it names
    ``sequences`` : control sequences of one robot, at most; twelve controls make 1,728 in three steps, whose
    matrices still fit in memory
    ``noise_floor`` : noise a step for joint states whose steps determine each other (no process noise), as a share of
    the covariance: it makes their prior invertible, and moves values by that share
    ``on_time`` : share of the sampling period within which two times count as one
    ``most_periods`` : between two steps of a tracker, at most; each is predicted on its own, and after that many
    nothing is known of a target
    ``pose_rounding`` : asymmetry and most negative eigenvalue that a pose's covariance may have, relative to its
    largest entry
    ``search_share`` : of the time left of a step, for a search within a limit: it looks at the clock between nodes only
    ``fallback_nodes`` : of each worst case by which known plans are compared if the planner fails; a thousand take some
    milliseconds
    """

    linearisations: int = 4
    on_top: float = 1e-9
    sequences: int = 20_000
    noise_floor: float = 1e-6
    on_time: float = 1e-6
    most_periods: int = 10_000
    pose_rounding: float = 1e-9
    search_share: float = 0.7
    fallback_nodes: int = 1000

    def __post_init__(self) -> None:
        """Check what no mission could go on with. ``InputError`` : a number is out of its range."""
        for name in ("linearisations", "sequences", "most_periods"):
            if not (value := getattr(self, name)) >= 1:
                raise InputError(f"params.{name}", "must be at least 1", value)
        if not self.noise_floor > 0:
            raise InputError("params.noise_floor", "must be positive", self.noise_floor)
        if not 0 <= self.on_time < 0.5:
            raise InputError("params.on_time", "must be at least 0 and below half a period", self.on_time)
