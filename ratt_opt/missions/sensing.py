"""Pieces of information from measurements, linearised where a group believes the targets to be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.missions.belief import Innovation
from ratt_opt.missions.memory import Pieces
from ratt_opt.setfunctions.information import symmetric_inverse

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.params import MissionParams
    from ratt_opt.missions.world import World
    from ratt_opt.scenario.sensors.model import SensorModel

__all__ = ["Reading", "group_pieces", "innovations_squared", "simulated_readings"]


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """Reading of one robot: ``values`` (M, k), of the targets ``seen`` (M,)."""

    values: FloatArray
    seen: BoolArray


def simulated_readings(world: World, poses: FloatArray, truth: FloatArray, luck: FloatArray) -> list[Reading]:
    """Simulate every robot's reading of targets in states ``truth`` (M, d); ``luck`` (N, M, k) standard normal."""
    readings, on_top = dict[int, Reading](), world.model.params.on_top
    for sensor, robots in world.alike:
        here, states = poses[robots][:, None], truth[:, : sensor.reads]
        apart = np.linalg.norm(states[:, :2] - here[..., :2], axis=-1)
        there = np.where((apart > on_top)[..., None], states, states + 1.0)
        values = sensor.measure(here, there) + sensor.disturbance(here, there, luck[robots, :, : sensor.size])
        seen = sensor.sees(here, there) & (apart > on_top)
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

    ``poses`` : robot by robot (p,), or (M, p) if each target was measured from another pose.
    ``pose_covariances`` : (N, p, p) of the poses, whose errors are taken for further noise of every measurement.
    """
    pieces = Pieces.none(world.scenario.n_robots, predicted)
    members = set(robots)
    rounds = world.model.params.linearisations if world.model.linearisation == "iterated" else 1
    point, second_order = predicted, world.model.linearisation != "first order"
    for _ in range(rounds):
        squared, count = 0.0, 0
        for sensor, owners in world.alike:
            own = [i for i in owners.tolist() if i in members]
            if own:
                sightings = _stacked(own, poses, readings, pose_covariances)
                read = _linearise(sensor, sightings, (predicted, point), world.model.params, second_order=second_order)
                r = sensor.reads
                pieces.information[own, :, :r, :r], pieces.vector[own, :, :r] = read.information, read.vector
                squared, count = squared + float(read.squared.sum()), count + int(read.usable.sum()) * sensor.size
        chosen = np.isin(np.arange(world.scenario.n_robots), sorted(members))
        information, vector = pieces.of(chosen)
        point = updated = predicted.updated(information, vector)
    # Sum of nu' S^-1 nu over all targets, by the matrix inversion lemma: what R^-1 says less what the update explains.
    moved = vector - (information @ predicted.mean[..., None])[..., 0]
    explained = float(np.einsum("mi,mij,mj->", moved, updated.covariance, moved))
    return pieces, Innovation(squared=max(squared - explained, 0.0), count=count)


def innovations_squared(
    world: World,
    predicted: Belief,
    poses: Mapping[int, FloatArray],
    readings: Mapping[int, Reading],
    pose_covariances: FloatArray | None = None,
) -> FloatArray:
    """(N, M) normalised innovation squared of each measurement alone, before any is taken in; NaN if there is none.

    ``nu' S^-1 nu`` with ``S = H P H' + R``; of a consistent filter a chi-square variable of ``sensor.size`` degrees.
    """
    squares = np.full((world.scenario.n_robots, len(predicted.mean)), np.nan)
    for sensor, owners in world.alike:
        own = [i for i in owners.tolist() if i in readings]
        if own:
            second_order, r = world.model.linearisation != "first order", sensor.reads
            sightings = _stacked(own, poses, readings, pose_covariances)
            read = _linearise(sensor, sightings, (predicted, predicted), world.model.params, second_order=second_order)
            i, j = np.nonzero(read.usable)
            mean, covariance = predicted.mean[j, :r], predicted.covariance[j, :r, :r]
            # By the matrix inversion lemma, so that a sensor may be silent in some direction (R^-1 singular).
            moved = read.vector[i, j] - (read.information[i, j] @ mean[..., None])[..., 0]
            left = symmetric_inverse(symmetric_inverse(covariance) + read.information[i, j])
            explained = np.einsum("ki,kij,kj->k", moved, left, moved)
            squares[np.array(own)[i], j] = np.maximum(read.squared[i, j] - explained, 0.0)
    return squares


@dataclass(frozen=True, slots=True, eq=False)
class _Sightings:
    """Readings of K robots with the same sensor, from ``poses`` (K, M, p): ``values`` (K, M, k), ``seen`` (K, M).

    ``pose_covariances`` : (K, p, p), or ``None`` if the poses are exact.
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
    places = np.stack([np.broadcast_to(poses[i], (seen.shape[1], np.shape(poses[i])[-1])) for i in robots])
    unsure = None if pose_covariances is None else pose_covariances[robots]
    return _Sightings(places, np.stack([readings[i].values for i in robots]), seen, unsure)


@dataclass(frozen=True, slots=True, eq=False)
class _Read:
    """K robots' ``information`` (K, M, r, r) and ``vector`` (K, M, r) of what is ``usable`` (K, M).

    ``squared`` : (K, M) ``nu' R^-1 nu`` of each measurement.
    """

    information: FloatArray
    vector: FloatArray
    squared: FloatArray
    usable: BoolArray


def _linearise(
    sensor: SensorModel, sightings: _Sightings, about: tuple[Belief, Belief], how: MissionParams, *, second_order: bool
) -> _Read:
    """Some robots' pieces, linearised at the second belief of ``about``; the first is the prediction."""
    predicted, point = about
    r, poses = sensor.reads, sightings.poses
    places = _places(sensor, sightings, point.mean[:, :r], how.on_top)
    usable = sightings.seen & (np.linalg.norm(places[..., :2] - poses[..., :2], axis=-1) > how.on_top)
    i, j = np.nonzero(usable)
    here, there, values = poses[i, j], places[i, j], sightings.values[i, j]
    slope = sensor.jacobian(here, there)
    added = sensor.bending(here, there, point.covariance[j, :r, :r]) if second_order else None
    if sightings.pose_covariances is not None:
        turned = sensor.pose_jacobian(here, there)
        of_poses = turned @ sightings.pose_covariances[i] @ np.swapaxes(turned, -1, -2)
        added = of_poses if added is None else added + of_poses
    weights = sensor.weights(here, there, added, values)
    surprise = sensor.surprise(values, sensor.measure(here, there))
    # As linear in the state: the surprise at the point of linearisation, plus the slope times that point.
    linear = surprise + (slope @ there[..., None])[..., 0]
    weighted = np.swapaxes(slope, -1, -2) @ weights
    information = weighted @ slope
    off = linear - (slope @ predicted.mean[j, :r][..., None])[..., 0]
    read = _Read(
        information=np.zeros((*usable.shape, r, r)),
        vector=np.zeros((*usable.shape, r)),
        squared=np.zeros(usable.shape),
        usable=usable,
    )
    read.information[i, j] = (information + np.swapaxes(information, -1, -2)) / 2
    read.vector[i, j] = (weighted @ linear[..., None])[..., 0]
    read.squared[i, j] = np.einsum("mi,mij,mj->m", off, weights, off)
    return read


def _places(sensor: SensorModel, sightings: _Sightings, expected: FloatArray, nearest: float) -> FloatArray:
    """(K, M, r) where to linearise: as expected, or if that is on top of the robot, at the point that was sighted."""
    places = np.array(np.broadcast_to(expected, (*sightings.values.shape[:2], expected.shape[-1])))
    on_top = sightings.seen & (np.linalg.norm(places[..., :2] - sightings.poses[..., :2], axis=-1) <= nearest)
    if on_top.any():
        pointed = sensor.pointed_at(sightings.poses, sightings.values)
        if pointed is not None:
            places[on_top, :2] = pointed[on_top]
    return places
