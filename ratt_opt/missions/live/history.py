"""Measurements taken in at the time they were made, in whatever order they arrive.

The tracker keeps the moments of the last seconds: beliefs, poses, and what was measured. A measurement of an earlier
time goes into its moment, or into a new one between two that are known, and the filter runs again from there. So the
belief is that of a filter that got everything in order, to the last digit if every time was known before.

Robots are taken to drive straight and at one speed between two moments. Between two uncertain poses the interpolated
covariance is that of the ends, which is an upper bound whatever their correlation.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, readonly
from ratt_opt.missions.belief import Belief
from ratt_opt.missions.live.gate import SightingSet, judged
from ratt_opt.missions.live.packets import MeasurementInnovation, PacketError
from ratt_opt.missions.live.state import Measurement, Moment
from ratt_opt.missions.sensing import Reading, group_pieces
from ratt_opt.scenario.sensor import wrap_angle

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.missions.live.gate import Gate, Judgement
    from ratt_opt.missions.world import World

__all__ = ["FilterUpdate", "MomentFilter", "StampedMeasurement"]


@dataclass(frozen=True, slots=True)
class StampedMeasurement:
    """A measurement that was made at ``time`` [s since the start]; ``name`` is for errors.

    ``stamped`` : whether the caller said when. Then a repeated delivery is found.
    """

    name: str
    time: float
    measurement: Measurement
    stamped: bool


@dataclass(slots=True)
class FilterUpdate:
    """The ``moments`` with new measurements, and what became of these.

    ``faults`` : repeated ones; ``silent`` : those that told nothing; ``innovations`` : of all that were judged;
    ``found`` : targets that were lost and are found again. Measurements are known by their ``id``.
    """

    moments: tuple[Moment, ...] = ()
    faults: dict[int, PacketError] = field(default_factory=dict)
    silent: set[int] = field(default_factory=set)
    innovations: dict[int, MeasurementInnovation] = field(default_factory=dict)
    found: set[int] = field(default_factory=set)


@dataclass(frozen=True, slots=True, eq=False)
class MomentFilter:
    """The filter over moments: ``targets`` (M,) numbers of the targets, ``born`` (M,) when each appeared [s]."""

    world: World
    targets: tuple[int, ...]
    born: FloatArray
    gate: Gate | None

    def taken_in(self, moments: Sequence[Moment], made: Sequence[StampedMeasurement]) -> FilterUpdate:
        """The moments with new measurements, and what became of each.

        The last moment is new: its belief and all after the first change are worked out anew.
        """
        kept, found = list(moments), FilterUpdate()
        first = len(kept) - 1
        for new in made:
            k = self._placed(kept, new.time)
            if k is None:
                k = self._inserted(kept, new.time)
                first += k <= first
            if (fault := self._repeated(kept, k, new)) is not None:
                found.faults[id(new.measurement)] = fault
                continue
            kept[k] = replace(kept[k], measurements=(*kept[k].measurements, new.measurement))
            first = min(first, k)
        for k in range(first, len(kept)):
            kept[k] = self._updated(kept[k - 1], kept[k], found)
        found.moments = tuple(kept)
        return found

    def predicted(self, belief: Belief, begin: float, end: float) -> Belief:
        """The belief at ``end``; targets that had not appeared before are left as they are."""
        ahead, time = belief, begin
        for step in _parts(end - begin, self.world.period, self.world.on_time):
            ahead = ahead.predicted(self.world.motion, step, time)
            time += step
        unborn = self.born >= end
        if not unborn.any():
            return ahead
        mean = np.where(unborn[:, None], belief.mean, ahead.mean)
        return Belief(readonly(mean), readonly(np.where(unborn[:, None, None], belief.covariance, ahead.covariance)))

    def _placed(self, moments: Sequence[Moment], time: float) -> int | None:
        """The moment of this time, if there is one; the first is not: what was measured before it is forgotten."""
        near = self.world.on_time
        return next((k for k in range(len(moments) - 1, 0, -1) if abs(moments[k].time - time) <= near), None)

    @staticmethod
    def _inserted(moments: list[Moment], time: float) -> int:
        """A new moment of this time between two known ones: its place."""
        k = next(k for k in range(1, len(moments)) if moments[k].time > time)
        before, after = moments[k - 1], moments[k]
        share = (time - before.time) / (after.time - before.time)
        turn = wrap_angle(after.poses[:, 2] - before.poses[:, 2])
        poses = (1 - share) * before.poses + share * after.poses
        poses[:, 2] = before.poses[:, 2] + share * turn
        unsure = (1 - share) * before.pose_covariances + share * after.pose_covariances
        moment = Moment(
            time=time,
            poses=readonly(poses),
            pose_covariances=readonly(unsure),
            belief=before.belief,
            refused=before.refused,
        )
        moments.insert(k, moment)
        return k

    def _repeated(self, moments: Sequence[Moment], k: int, new: StampedMeasurement) -> PacketError | None:
        near, pair = self.world.on_time, (new.measurement.robot, new.measurement.target)
        made = new.time if new.measurement.time is None else new.measurement.time
        own = moments if new.stamped else moments[k : k + 1]
        times = (
            moment.time if old.time is None else old.time
            for moment in own
            for old in moment.measurements
            if (old.robot, old.target) == pair
        )
        if any(not new.stamped or abs(time - made) <= near for time in times):
            rule = f"must not repeat robot {pair[0]} and target {pair[1]} at one time"
            return PacketError("repeated", new.name, rule, pair)
        return None

    def _updated(self, before: Moment, moment: Moment, found: FilterUpdate) -> Moment:
        """The moment after the one before it; what became of its measurements is noted in ``found``."""
        belief = self.predicted(before.belief, before.time, moment.time)
        if not moment.measurements:
            return replace(moment, belief=belief, refused=before.refused)
        unsure = moment.pose_covariances if moment.pose_covariances.any() else None
        sighted = SightingSet(dict(enumerate(moment.poses)), self._readings(moment.measurements), unsure)
        verdict = judged(self.world, belief, sighted, before.refused, self.gate)
        kept = sighted.only(verdict.accepted)
        pieces, _ = group_pieces(
            self.world, verdict.belief, kept.poses, kept.readings, kept.readings, pose_covariances=unsure
        )
        belief = verdict.belief.updated(pieces.information.sum(axis=0), pieces.vector.sum(axis=0))
        self._note(moment, verdict, np.asarray(pieces.information.any(axis=(-1, -2))), found)
        return replace(moment, belief=belief, refused=verdict.refused)

    def _note(self, moment: Moment, verdict: Judgement, telling: BoolArray, found: FilterUpdate) -> None:
        row = self._rows()
        for m in moment.measurements:
            i, j = m.robot, row[m.target]
            accepted, square = bool(verdict.accepted[i, j]), float(verdict.squares[i, j])
            if accepted and not telling[i, j]:
                found.silent.add(id(m))
            elif not np.isnan(square):
                found.innovations[id(m)] = MeasurementInnovation(m, square, self.world.sensors[i].size, accepted)
        found.found |= {self.targets[j] for j in verdict.found}

    def _readings(self, measurements: Sequence[Measurement]) -> dict[int, Reading]:
        row, count = self._rows(), len(self.targets)
        readings: dict[int, Reading] = {}
        for m in measurements:
            if m.robot not in readings:
                size = self.world.sensors[m.robot].size
                readings[m.robot] = Reading(np.zeros((count, size)), np.zeros(count, dtype=np.bool_))
            readings[m.robot].values[row[m.target]] = m.values
            readings[m.robot].seen[row[m.target]] = True
        return readings

    def _rows(self) -> dict[int, int]:
        return {number: row for row, number in enumerate(self.targets)}


def _parts(passed: float, period: float, near: float) -> list[float]:
    """Whole periods, and what is left: the motion noise is that of periods."""
    whole = int(passed / period * (1 + near / period))
    rest = passed - whole * period
    if whole and abs(rest) <= near:
        return [*[period] * (whole - 1), period + rest]
    return [period] * whole + ([rest] if rest > 0 else [])
