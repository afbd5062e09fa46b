"""Memory of the measurements that each robot holds, and beliefs of groups that split and meet again.

A measurement becomes information about the state at its step (``H'R^-1 H`` and ``H'R^-1 z``), which adds up. Every
robot keeps the pieces that it made or was told since the last step of which all robots know everything. A group's
belief is that of a filter run over the union of its pieces: whatever splits and meetings there were, nothing is
counted twice, and if nothing is lost the belief is that of one central filter. Adding beliefs themselves would
count their common past, and the motion noise they share, twice.

Source: information filter; the pieces are those of Durrant-Whyte and Henderson, Multisensor Data Fusion (2008).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, readonly

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.models.targets import TargetMotion

__all__ = ["Memory", "Pieces"]


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """Measurements of one step by robot: ``information`` (N, M, d, d) and ``vector`` (N, M, d)."""

    information: FloatArray
    vector: FloatArray

    @classmethod
    def none(cls, n_robots: int, belief: Belief) -> Pieces:
        """Return zeros: no robot has measured anything."""
        return cls(np.zeros((n_robots, *belief.covariance.shape)), np.zeros((n_robots, *belief.mean.shape)))

    def of(self, robots: BoolArray) -> tuple[FloatArray, FloatArray]:
        """Sums over some robots (N,), in the order of their numbers."""
        return self.information[robots].sum(axis=0), self.vector[robots].sum(axis=0)


@dataclass(frozen=True, slots=True, eq=False)
class Memory:
    """The pieces of all robots since the step of which everybody knows everything.

    ``base`` : the belief after that step, at ``base_time`` [s]; ``steps`` : the pieces of each step since;
    ``holds`` (N, S, N) : whether robot i knows the piece that robot k made in step s.
    """

    motion: TargetMotion
    period: float
    base: Belief
    base_time: float
    steps: tuple[Pieces, ...]
    holds: BoolArray
    _known: dict[bytes, Belief] = field(default_factory=dict, repr=False)

    @classmethod
    def start(cls, motion: TargetMotion, period: float, belief: Belief, n_robots: int) -> Memory:
        """All robots share one belief at time 0."""
        return cls(motion, period, belief, 0.0, (), np.zeros((n_robots, 0, n_robots), dtype=np.bool_))

    def belief(self, robot: int) -> Belief:
        """Compute a robot's belief after the last step: the filter over all pieces that it holds."""
        start = len(self.steps)
        while start and self._key(robot, start) not in self._known:
            start -= 1
        belief = self._known[self._key(robot, start)] if start else self.base
        for s in range(start, len(self.steps)):
            held = self.holds[robot, s]
            predicted = belief.predicted(self.motion, self.period, self.base_time + s * self.period)
            belief = predicted.updated(*self.steps[s].of(held)) if held.any() else predicted
            self._known[self._key(robot, s + 1)] = belief
        return belief

    def shared(self, groups: Iterable[Iterable[int]]) -> Memory:
        """Every robot tells its group all that it knows."""
        holds = self.holds.copy()
        for group in groups:
            members = sorted(group)
            holds[members] = self.holds[members].any(axis=0)
        return replace(self, holds=readonly(holds))._forgotten()

    def advanced(self, pieces: Pieces, made: BoolArray) -> Memory:
        """One step later: each robot of ``made`` (N,) knows its own new piece."""
        new = np.diag(made)[:, None, :]
        return replace(self, steps=(*self.steps, pieces), holds=readonly(np.concatenate([self.holds, new], axis=1)))

    def _forgotten(self) -> Memory:
        """Move the steps that all robots know alike into the base."""
        alike = (self.holds == self.holds[:1]).all(axis=(0, 2))
        count = len(self.steps) if alike.all() else int(np.argmin(alike))
        if count == 0:
            return self
        base = (
            self if count == len(self.steps) else replace(self, steps=self.steps[:count], holds=self.holds[:, :count])
        )
        time = self.base_time + count * self.period
        return Memory(self.motion, self.period, base.belief(0), time, self.steps[count:], self.holds[:, count:])

    def _key(self, robot: int, steps: int) -> bytes:
        return steps.to_bytes(4, "big") + np.packbits(self.holds[robot, :steps]).tobytes()
