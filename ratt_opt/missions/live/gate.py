"""The gate: which measurements are refused as outliers, and how a target that was lost is found again.

Each measurement is judged alone, by its normalised innovation squared ``nu' S^-1 nu`` about the prediction, before any
measurement of the same time is taken in. So the order of delivery does not matter.

A target is *lost* once all its sightings at ``patience`` times in a row were refused. Then the belief is taken to be
wrong, not the sightings. For each sighting of that time the covariance is scaled up until this one is as surprising as
expected (``nu' S^-1 nu`` equals its degrees of freedom), and the others are judged after it is taken in. The sighting
with which most others agree decides (of equal ones the nearest): it and those that agree with it are taken in.

Sources: gate: Bar-Shalom, Li, Kirubarajan, Estimation with Applications (2001), section 5.7.2. Scaling a covariance to
fit the innovations: Xia, Rao, Ying, Shen, Adaptive fading Kalman filter, Automatica 30 (1994).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import gammaincinv

from ratt_opt._validation import check_integer, check_number, readonly
from ratt_opt.errors import InputError
from ratt_opt.missions.belief import Belief
from ratt_opt.missions.sensing import Reading, group_pieces, innovations_squared

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.missions.world import World

__all__ = ["Gate", "Judgement", "SightingSet", "gate_of", "judged"]


@dataclass(frozen=True, slots=True)
class Gate:
    """Refuse outliers, and give up a belief that all sightings contradict.

    A target all of whose sightings were refused at ``patience`` times in a row is lost. At its next sightings its
    covariance is scaled up until one of them is as surprising as expected: the one with which most others agree.

    ``probability`` : share of a consistent filter's measurements that pass (chi-square); a smaller one refuses more
    outliers and more good measurements. ``patience`` : times in a row at which all sightings of a target are refused
    before it counts as lost; more withstand longer disturbances, fewer find a lost target sooner. ``widest`` : largest
    factor of a lost target's covariance.
    """

    probability: float = 0.999
    patience: int = 5
    widest: float = 1e12

    def __post_init__(self) -> None:
        if not 0 < check_number("gate", self.probability) < 1:
            raise InputError("gate", "must be a probability between 0 and 1, a Gate, or None", self.probability)
        check_integer("patience", self.patience, low=1)
        check_number("widest", self.widest, low=1.0)

    def limits(self, sizes: FloatArray) -> FloatArray:
        """(...) largest normalised innovations squared that pass, of measurements of these degrees of freedom."""
        return np.asarray(2 * gammaincinv(sizes / 2, self.probability))


def gate_of(gate: float | Gate | None) -> Gate | None:
    """The gate as given, or that of this probability. InputError : it is none of these."""
    return gate if gate is None or isinstance(gate, Gate) else Gate(gate)


@dataclass(frozen=True, slots=True, eq=False)
class SightingSet:
    """All that was measured at one time: ``poses`` robot by robot, their covariances or ``None``, ``readings``."""

    poses: Mapping[int, FloatArray]
    readings: Mapping[int, Reading]
    pose_covariances: FloatArray | None

    def only(self, accepted: BoolArray) -> SightingSet:
        """Keep the readings that were accepted (N, M)."""
        kept = {i: Reading(one.values, one.seen & accepted[i]) for i, one in self.readings.items()}
        return SightingSet(self.poses, kept, self.pose_covariances)


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """Sightings at one time, judged: ``accepted`` (N, M) and ``squares`` (N, M), NaN if nothing was measured.

    ``belief`` : the prediction to update, of targets found again with a scaled covariance; ``refused`` : (M,) times in
    a row at which all sightings of a target were refused; ``found`` : targets that were lost till now.
    """

    belief: Belief
    accepted: BoolArray
    squares: FloatArray
    refused: tuple[int, ...]
    found: tuple[int, ...] = ()


def judged(
    world: World, belief: Belief, sighted: SightingSet, refused: tuple[int, ...], gate: Gate | None
) -> Judgement:
    """Judge the sightings of one time about the predicted ``belief``."""
    squares = _squares(world, belief, sighted)
    seen: BoolArray = np.zeros(squares.shape, dtype=np.bool_)
    for i, reading in sighted.readings.items():
        seen[i] = reading.seen
    if gate is None:
        return Judgement(belief, seen, squares, refused)
    limits = gate.limits(np.array([float(sensor.size) for sensor in world.sensors]))[:, None]
    outlying = squares > limits  # False for NaN: what tells nothing is no outlier
    hopeless: BoolArray = np.asarray(seen.any(axis=0) & (outlying | ~seen).all(axis=0))
    lost = [j for j in np.flatnonzero(hopeless).tolist() if refused[j] >= gate.patience]
    accepted: BoolArray = np.asarray(seen & ~outlying)
    for j in lost:
        belief, accepted[:, j] = _found_again(world, belief, sighted, j, gate)
    counts = [0 if accepted[:, j].any() else count + int(hopeless[j]) for j, count in enumerate(refused)]
    return Judgement(belief, accepted, squares, tuple(counts), tuple(lost))


def _squares(world: World, belief: Belief, sighted: SightingSet) -> FloatArray:
    return innovations_squared(world, belief, sighted.poses, sighted.readings, sighted.pose_covariances)


def _one(shape: tuple[int, ...], i: int, j: int) -> BoolArray:
    chosen = np.zeros(shape, dtype=np.bool_)
    chosen[i, j] = True
    return chosen


def _found_again(
    world: World, belief: Belief, sighted: SightingSet, target: int, gate: Gate
) -> tuple[Belief, BoolArray]:
    """The belief of a lost target, widened for the sighting with which most others agree, and who agrees (N,)."""
    limits = gate.limits(np.array([float(sensor.size) for sensor in world.sensors]))
    distances = _squares(world, belief, sighted)[:, target] / limits
    best: tuple[Belief, BoolArray] | None = None
    for robot in np.argsort(distances, kind="stable")[: int(np.isfinite(distances).sum())].tolist():
        alone = sighted.only(_one((len(distances), len(belief.mean)), robot, target))
        wider = _widened(world, belief, alone, (robot, target), gate)
        pieces, _ = group_pieces(
            world, wider, alone.poses, alone.readings, alone.readings, pose_covariances=alone.pose_covariances
        )
        after = wider.updated(pieces.information.sum(axis=0), pieces.vector.sum(axis=0))
        agree: BoolArray = np.asarray(_squares(world, after, sighted)[:, target] <= limits)
        agree[robot] = True
        if best is None or agree.sum() > best[1].sum():
            best = wider, agree
    assert best is not None
    return best


def _widened(world: World, belief: Belief, sighted: SightingSet, pair: tuple[int, int], gate: Gate) -> Belief:
    """The belief with a target's covariance scaled so that one sighting is as surprising as expected (bisection)."""
    robot, target = pair
    expected, low, high = world.sensors[robot].size, 0.0, float(np.log(gate.widest))
    while high - low > 1e-12 * max(high, 1.0):
        middle = (low + high) / 2
        square = _squares(world, _scaled(belief, target, np.exp(middle)), sighted)[robot, target]
        low, high = (middle, high) if square > expected else (low, middle)
    return _scaled(belief, target, np.exp(high))


def _scaled(belief: Belief, target: int, factor: float) -> Belief:
    covariance = belief.covariance.copy()
    covariance[target] *= factor
    return Belief(belief.mean, readonly(covariance))
