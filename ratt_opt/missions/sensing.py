"""From measurements to pieces of information: linearised where a group believes the targets to be."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.missions.memory import Pieces

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.models.sensors import SensorModel
    from ratt_opt.missions.world import World

__all__ = ["Innovation", "Reading", "group_pieces", "simulated_readings"]

ROUNDS = 4
"""Linearisations of an iterated update; on the paper's settings the estimate no longer moves visibly after three."""
ON_TOP = 1e-9
"""A target nearer to a robot than this [m] is not measured: its bearing has no derivative there."""


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """What one robot measured: ``values`` (M, k), of the targets ``seen`` (M,)."""

    values: FloatArray
    seen: BoolArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Innovation:
    """Sum of the normalised innovations squared of a group's measurements, and how many numbers that were."""

    squared: float = 0.0
    count: int = 0


def simulated_readings(world: World, poses: FloatArray, truth: FloatArray, luck: FloatArray) -> list[Reading]:
    """What every robot would measure of targets at ``truth`` (M, 2); ``luck`` (N, M, k) standard normal numbers."""
    readings = []
    for i, sensor in enumerate(world.sensors):
        apart = np.linalg.norm(truth - poses[i, :2], axis=-1)
        there = np.where((apart > ON_TOP)[:, None], truth, truth + 1.0)
        noise = np.sqrt(sensor.noise(poses[i], there)) * luck[i, :, : sensor.size]
        seen = sensor.sees(poses[i], there) & (apart > ON_TOP)
        readings.append(Reading(sensor.measure(poses[i], there) + noise, seen))
    return readings


def group_pieces(
    world: World,
    predicted: Belief,
    poses: Mapping[int, FloatArray],
    readings: Mapping[int, Reading],
    robots: Collection[int],
) -> tuple[Pieces, Innovation]:
    """The pieces of a group's seeing ``robots`` (zero for others), and how surprising they were together.

    Every measurement is linearised at the predicted positions, as the plan does; with an iterated linearisation at the
    estimate that follows, again and again.

    ``poses`` : robot by robot (3,), or (M, 3) where each target was measured from another pose.
    """
    pieces = Pieces.none(world.scenario.n_robots, predicted)
    members = sorted(robots)
    rounds = ROUNDS if world.model.linearisation == "iterated" else 1
    point, spread = predicted, None if world.model.linearisation == "first order" else predicted.position_covariance
    for _ in range(rounds):
        squared, count = 0.0, 0
        for i in members:
            piece = _linearise(world.sensors[i], poses[i], readings[i], (predicted, point, spread))
            pieces.information[i, :, :2, :2], pieces.vector[i, :, :2] = piece.information, piece.vector
            squared, count = squared + piece.squared, count + piece.count
        chosen = np.isin(np.arange(world.scenario.n_robots), members)
        information, vector = pieces.of(chosen)
        updated = predicted.updated(information, vector)
        point, spread = updated, None if spread is None else updated.position_covariance
    # Sum of nu' S^-1 nu over all targets, by the matrix inversion lemma: what R^-1 says less what the update explains.
    moved = vector - (information @ predicted.mean[..., None])[..., 0]
    explained = float(np.einsum("mi,mij,mj->", moved, updated.covariance, moved))
    return pieces, Innovation(squared=max(squared - explained, 0.0), count=count)


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """One robot's ``information`` (M, 2, 2) and ``vector`` (M, 2), and ``nu' R^-1 nu`` of the numbers measured."""

    information: FloatArray
    vector: FloatArray
    squared: float = 0.0
    count: int = 0


def _linearise(
    sensor: SensorModel, pose: FloatArray, reading: Reading, about: tuple[Belief, Belief, FloatArray | None]
) -> _Piece:
    """One robot's piece, linearised at the second belief of ``about``; the first is the prediction."""
    predicted, point, spread = about
    places = point.positions
    pose = np.broadcast_to(pose, (len(places), 3))
    piece = _Piece(np.zeros((*places.shape, 2)), np.zeros(places.shape))
    usable = reading.seen & sensor.sees(pose, predicted.positions)
    usable &= np.linalg.norm(places - pose[:, :2], axis=-1) > ON_TOP
    j = np.flatnonzero(usable)
    if not len(j):
        return piece
    slope = sensor.jacobian(pose[j], places[j])
    weights = np.linalg.inv(sensor.noise_covariance(pose[j], places[j], None if spread is None else spread[j]))
    surprise = sensor.surprise(reading.values[j], sensor.measure(pose[j], places[j]))
    # As linear in the position: the surprise at the point of linearisation, plus the slope times that point.
    linear = surprise + (slope @ places[j][..., None])[..., 0]
    weighted = np.swapaxes(slope, -1, -2) @ weights
    information = weighted @ slope
    piece.information[j] = (information + np.swapaxes(information, -1, -2)) / 2
    piece.vector[j] = (weighted @ linear[..., None])[..., 0]
    off = linear - (slope @ predicted.positions[j][..., None])[..., 0]
    squared = float(np.einsum("mi,mij,mj->", off, weights, off))
    return replace(piece, squared=squared, count=len(j) * sensor.size)
