"""What a tracker is told, and what it knows: plain data that pickles and becomes JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ratt_opt._validation import FloatArray, check_finite, check_integer, check_number
from ratt_opt._values import ByValue, Shown
from ratt_opt.errors import InputError
from ratt_opt.missions.belief import Belief

__all__ = ["Measurement", "TrackerState"]


@dataclass(frozen=True, slots=True)
class Measurement:
    """What ``robot`` measured of ``target``: range [m] and bearing [rad], or what its own sensor gives."""

    robot: int
    target: int
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TrackerState(ByValue, Shown):
    """All that a tracker knows: ``time`` [s] since it began, and the caller's clock ``now`` [s] if there was one.

    ``poses`` : (N, 3) expected at the next measurements; ``belief`` : of the targets at ``time``; ``controls`` :
    (N, H, 2) what is left of the last plan; ``steps``, ``missed`` : how many there were, and whose plans were late.
    """

    time: float
    now: float | None
    poses: FloatArray
    belief: Belief
    controls: FloatArray
    steps: int = 0
    missed: int = 0

    def to_dict(self) -> dict[str, Any]:
        """Plain data for strict JSON; floats at full precision."""
        return {
            "format": "ratt-opt tracker",
            "version": 1,
            "time": self.time,
            "now": self.now,
            "poses": self.poses.tolist(),
            "mean": self.belief.mean.tolist(),
            "covariance": self.belief.covariance.tolist(),
            "controls": self.controls.tolist(),
            "steps": self.steps,
            "missed": self.missed,
        }

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> TrackerState:
        """The state that :meth:`to_dict` wrote.

        Raises
        ------
        InputError : a field is missing or breaks its rule, as a covariance that is singular.
        """
        if not isinstance(document, dict):
            raise InputError("state", "must be a record", type(document).__name__)
        for name, known in (("format", "ratt-opt tracker"), ("version", 1)):
            if document.get(name) != known:
                raise InputError(name, f"must be {known}", document.get(name))
        missing = sorted({"time", "now", "poses", "mean", "covariance", "controls", "steps", "missed"} - set(document))
        if missing:
            raise InputError(missing[0], "is missing", "nothing")
        return cls(
            time=check_number("time", document["time"], low=0.0),
            now=None if document["now"] is None else check_number("now", document["now"]),
            poses=check_finite("poses", document["poses"], ndim=2),
            belief=Belief.of(document["mean"], document["covariance"]),
            controls=check_finite("controls", document["controls"], ndim=3),
            steps=check_integer("steps", document["steps"], low=0),
            missed=check_integer("missed", document["missed"], low=0),
        )
