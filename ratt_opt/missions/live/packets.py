"""Reports of a step on each measurement: accepted, or skipped and why, with its innovation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from scipy.special import gammaincc

from ratt_opt.errors import InputError
from ratt_opt.problem import Plan

if TYPE_CHECKING:
    from ratt_opt.missions.live.state import Measurement

__all__ = ["MeasurementInnovation", "PacketError", "Reason", "Skipped", "TrackerPlan"]

Reason = Literal[
    "unknown robot",
    "unknown target",
    "lost robot",
    "blinded robot",
    "future",
    "too late",
    "before its target",
    "repeated",
    "impossible",
    "outlier",
    "tells nothing",
]


class PacketError(InputError):
    """A measurement that cannot be taken in; ``reason`` says in two words why."""

    def __init__(self, reason: Reason, argument: str, rule: str, value: object) -> None:
        super().__init__(argument, rule, value)
        self.reason: Reason = reason


@dataclass(frozen=True, slots=True)
class Skipped:
    """A measurement that was not taken in: the ``reason`` in two words, and ``why`` in one line."""

    measurement: Measurement
    reason: Reason
    why: str


@dataclass(frozen=True, slots=True)
class MeasurementInnovation:
    """Innovation of a measurement, before any measurement of the same time was applied.

    ``squared`` : normalised innovation squared; of a consistent filter a chi-square variable with as many degrees of
    freedom as the measurement has numbers (``count``). ``accepted`` : whether it was taken in.
    """

    measurement: Measurement
    squared: float
    count: int
    accepted: bool

    @property
    def probability(self) -> float:
        """Share of a consistent filter's measurements that are at least as surprising."""
        return float(gammaincc(self.count / 2, self.squared / 2))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TrackerPlan(Plan):
    """A plan, and what became of the measurements that it was made with.

    ``skipped`` : those not taken in, each with why. ``innovations`` : of all that were judged. ``lost`` : targets whose
    sightings were all refused so often that the next is believed; ``found`` : lost targets that were found again in
    this step. ``fallback`` : why the planner's plan is not used (``"late"``, or its error), or ``""``.
    """

    skipped: tuple[Skipped, ...] = ()
    innovations: tuple[MeasurementInnovation, ...] = ()
    lost: tuple[int, ...] = ()
    found: tuple[int, ...] = ()
    fallback: str = ""
