"""From measurements to pieces of information: linearised where a group believes the targets to be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.missions.belief import Innovation
from ratt_opt.missions.memory import Pieces

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.world import World
    from ratt_opt.scenario.sensors.model import SensorModel

__all__ = ["Reading", "group_pieces", "simulated_readings"]

ROUNDS = 4
"""Linearisations of an iterated update; on the paper's settings the estimate no longer moves visibly after three."""
ON_TOP = 1e-9
"""Nearer to a robot than this [m] a measurement has no derivative: it is linearised at the point that it names."""


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """What one robot measured: ``values`` (M, k), of the targets ``seen`` (M,)."""

    values: FloatArray
    seen: BoolArray


def simulated_readings(world: World, poses: FloatArray, truth: FloatArray, luck: FloatArray) -> list[Reading]:
    """What every robot would measure of targets at ``truth`` (M, 2); ``luck`` (N, M, k) standard normal numbers."""
    readings: dict[int, Reading] = {}
    for sensor, robots in world.alike:
        here = poses[robots][:, None]
        apart = np.linalg.norm(truth - here[..., :2], axis=-1)
        there = np.where((apart > ON_TOP)[..., None], truth, truth + 1.0)
        values = sensor.measure(here, there) + sensor.disturbance(here, there, luck[robots, :, : sensor.size])
        seen = sensor.sees(here, there) & (apart > ON_TOP)
        readings |= {int(i): Reading(values[k], seen[k]) for k, i in enumerate(robots)}
    return [readings[i] for i in range(len(poses))]


def group_pieces(
    world: World,
    predicted: Belief,
    poses: Mapping[int, FloatArray],
    readings: Mapping[int, Reading],
    robots: Collection[int],
    *,
    pose_covariances: FloatArray | None = None,
) -> tuple[Pieces, Innovation]:
    """The pieces of a group's seeing ``robots`` (zero for others), and how surprising they were together.

    Every measurement is linearised at the predicted positions, as the plan does; with an iterated linearisation at the
    estimate that follows, again and again. A sighting counts even if its target was expected out of view.

    ``poses`` : robot by robot (3,), or (M, 3) if each target was measured from another pose.
    ``pose_covariances`` : (N, 3, 3) of the poses, whose errors are taken for further noise of every measurement.
    """
    pieces = Pieces.none(world.scenario.n_robots, predicted)
    members = set(robots)
    rounds = ROUNDS if world.model.linearisation == "iterated" else 1
    point, spread = predicted, None if world.model.linearisation == "first order" else predicted.position_covariance
    for _ in range(rounds):
        squared, count = 0.0, 0
        for sensor, owners in world.alike:
            own = [i for i in owners.tolist() if i in members]
            if own:
                sightings = _stacked(own, poses, readings, pose_covariances)
                read = _linearise(sensor, sightings, (predicted, point, spread))
                pieces.information[own, :, :2, :2], pieces.vector[own, :, :2] = read.information, read.vector
                squared, count = squared + read.squared, count + read.count
        chosen = np.isin(np.arange(world.scenario.n_robots), sorted(members))
        information, vector = pieces.of(chosen)
        updated = predicted.updated(information, vector)
        point, spread = updated, None if spread is None else updated.position_covariance
    # Sum of nu' S^-1 nu over all targets, by the matrix inversion lemma: what R^-1 says less what the update explains.
    moved = vector - (information @ predicted.mean[..., None])[..., 0]
    explained = float(np.einsum("mi,mij,mj->", moved, updated.covariance, moved))
    return pieces, Innovation(squared=max(squared - explained, 0.0), count=count)


@dataclass(frozen=True, slots=True, eq=False)
class _Sightings:
    """What K robots with the same sensor measured, from ``poses`` (K, M, 3): ``values`` (K, M, k), ``seen`` (K, M).

    ``pose_covariances`` : (K, 3, 3), or ``None`` if the poses are exact.
    """

    poses: FloatArray
    values: FloatArray
    seen: BoolArray
    pose_covariances: FloatArray | None


def _stacked(
    robots: list[int],
    poses: Mapping[int, FloatArray],
    readings: Mapping[int, Reading],
    pose_covariances: FloatArray | None,
) -> _Sightings:
    seen = np.stack([readings[i].seen for i in robots])
    places = np.stack([np.broadcast_to(poses[i], (seen.shape[1], 3)) for i in robots])
    unsure = None if pose_covariances is None else pose_covariances[robots]
    return _Sightings(places, np.stack([readings[i].values for i in robots]), seen, unsure)


@dataclass(frozen=True, slots=True, eq=False)
class _Read:
    """K robots' ``information`` (K, M, 2, 2) and ``vector`` (K, M, 2), and ``nu' R^-1 nu`` of the numbers measured."""

    information: FloatArray
    vector: FloatArray
    squared: float
    count: int


def _linearise(sensor: SensorModel, sightings: _Sightings, about: tuple[Belief, Belief, FloatArray | None]) -> _Read:
    """Some robots' pieces, linearised at the second belief of ``about``; the first is the prediction."""
    predicted, point, spread = about
    poses, places = sightings.poses, _places(sensor, sightings, point.positions)
    usable = sightings.seen & (np.linalg.norm(places - poses[..., :2], axis=-1) > ON_TOP)
    i, j = np.nonzero(usable)
    here, there, values = poses[i, j], places[i, j], sightings.values[i, j]
    slope = sensor.jacobian(here, there)
    added = None if spread is None else sensor.bending(here, there, spread[j])
    if sightings.pose_covariances is not None:
        turned = sensor.pose_jacobian(here, there)
        of_poses = turned @ sightings.pose_covariances[i] @ np.swapaxes(turned, -1, -2)
        added = of_poses if added is None else added + of_poses
    weights = sensor.weights(here, there, added, values)
    surprise = sensor.surprise(values, sensor.measure(here, there))
    # As linear in the position: the surprise at the point of linearisation, plus the slope times that point.
    linear = surprise + (slope @ there[..., None])[..., 0]
    weighted = np.swapaxes(slope, -1, -2) @ weights
    information = weighted @ slope
    off = linear - (slope @ predicted.positions[j][..., None])[..., 0]
    read = _Read(
        information=np.zeros((*usable.shape, 2, 2)),
        vector=np.zeros((*usable.shape, 2)),
        squared=float(np.einsum("mi,mij,mj->", off, weights, off)),
        count=len(j) * sensor.size,
    )
    read.information[i, j] = (information + np.swapaxes(information, -1, -2)) / 2
    read.vector[i, j] = (weighted @ linear[..., None])[..., 0]
    return read


def _places(sensor: SensorModel, sightings: _Sightings, expected: FloatArray) -> FloatArray:
    """(K, M, 2) where to linearise: as expected, or if that is on top of the robot, at the point that was sighted."""
    places = np.array(np.broadcast_to(expected, (*sightings.values.shape[:2], 2)))
    on_top = sightings.seen & (np.linalg.norm(places - sightings.poses[..., :2], axis=-1) <= ON_TOP)
    if on_top.any():
        pointed = sensor.pointed_at(sightings.poses, sightings.values)
        places[on_top] = places[on_top] if pointed is None else pointed[on_top]
    return places
