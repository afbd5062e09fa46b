"""Several steps ahead: control sequences as elements, the joint state of all steps, and the part one cares about.

For ``H`` steps the state of a target is ``(x_1, ..., x_H)``, Gaussian before any measurement with covariance blocks
``P_a`` and ``P_a F_{a+1}' ... F_b'`` for ``a < b``. What step ``h`` measures is information about ``x_h`` alone, so
the information of a sequence is block diagonal and that of a team adds up. The posterior block of the last step is the
Kalman filter's covariance after all steps; earlier blocks are the smoother's. One criterion of all that is
``tr(C L^-1 C')`` with an output matrix ``C``: the position at the last step, or the mean over the steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, readonly
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.models.robots import TeamMotion
    from ratt_opt.missions.models.targets import TargetMotion
    from ratt_opt.scenario.model import Scenario

__all__ = ["OUTPUTS", "Sequences", "control_sequences", "extended", "joint_covariance", "output_matrix"]

OUTPUTS = ("mean", "last")


@dataclass(frozen=True, slots=True, eq=False)
class Sequences:
    """The elements of a plan: ``owner`` (E,), ``controls`` (E, H, c) and the ``poses`` (E, H, p) they lead through."""

    owner: IntArray
    controls: FloatArray
    poses: FloatArray

    def only(self, elements: IntArray | BoolArray) -> Sequences:
        """Some of them."""
        chosen = (self.owner[elements], self.controls[elements], self.poses[elements])
        return Sequences(*(readonly(part) for part in chosen))


def control_sequences(scenario: Scenario, poses: FloatArray, horizon: int, motion: TeamMotion, most: int) -> Sequences:
    """All sequences of ``horizon`` controls of every robot, robot by robot, the first control slowest.

    InputError : a robot would have more than ``most``.
    """
    owner, controls = [], []
    for i, robot in enumerate(scenario.robots):
        count = len(robot.controls) ** horizon
        if count > most:
            raise InputError("horizon", f"must give robot {i} at most {most} control sequences", count)
        owner.append(np.full(count, i))
        controls.append(np.array(list(product(_wide(scenario, i), repeat=horizon))))
    owners, sequences = np.concatenate(owner), np.concatenate(controls)
    path = [poses[owners]]
    for h in range(horizon):
        path.append(motion.moved(owners, path[-1], sequences[:, h], scenario.sampling_period))
    return Sequences(readonly(owners), readonly(sequences), readonly(np.stack(path[1:], axis=1)))


def extended(scenario: Scenario, sequences: Sequences, motion: TeamMotion) -> Sequences:
    """Every sequence followed by every control of its robot, the new control fastest."""
    counts = np.array([len(robot.controls) for robot in scenario.robots])[sequences.owner]
    again = np.repeat(np.arange(len(sequences.owner)), counts)
    added = np.concatenate([_wide(scenario, i) for i in sequences.owner])
    last = motion.moved(sequences.owner[again], sequences.poses[again, -1], added, scenario.sampling_period)
    controls = np.concatenate([sequences.controls[again], added[:, None]], axis=1)
    poses = np.concatenate([sequences.poses[again], last[:, None]], axis=1)
    return Sequences(readonly(sequences.owner[again]), readonly(controls), readonly(poses))


def _wide(scenario: Scenario, robot: int) -> FloatArray:
    """(C, c) controls of a robot, as wide as the team's."""
    return np.asarray(scenario.controls[scenario.robot == robot])


def joint_covariance(
    beliefs: list[Belief], motion: TargetMotion, period: float, size: int, noise_floor: float
) -> FloatArray:
    """(M, r H, r H) of the first ``size`` r numbers of the states in all steps, from the predicted beliefs.

    ``noise_floor`` : share of the covariance that is added if steps determine each other (no process noise): the prior
    of plans must be invertible
    """
    n_targets, d = beliefs[0].mean.shape
    horizon = len(beliefs)
    joint = np.zeros((n_targets, horizon * d, horizon * d))
    for a in range(horizon):
        block = beliefs[a].covariance
        joint[:, a * d : (a + 1) * d, a * d : (a + 1) * d] = block
        for b in range(a + 1, horizon):
            block = block @ np.swapaxes(motion.transition(beliefs[b - 1].mean, period), -1, -2)
            joint[:, a * d : (a + 1) * d, b * d : (b + 1) * d] = block
            joint[:, b * d : (b + 1) * d, a * d : (a + 1) * d] = np.swapaxes(block, -1, -2)
    if horizon > 1 and np.linalg.eigvalsh(motion.noise(period))[:, 0].min() <= 0:
        sizes = np.diagonal(joint, axis1=1, axis2=2).copy()
        sizes[:, :d] = 0.0  # the first step is known as it is
        joint += noise_floor * sizes[:, None, :] * np.eye(horizon * d)
    places = np.array([h * d + axis for h in range(horizon) for axis in range(size)])
    return joint[:, places[:, None], places]


def output_matrix(output: str, horizon: int, size: int) -> FloatArray | None:
    """(q, r H) the part of all steps' states that counts, positions; ``None`` if that is the whole of one position.

    ``"last"`` : the position at the last step; ``"mean"`` : those of all steps, over the root of their number: the
    trace is then the mean of theirs, and the largest eigenvalue that of the joint covariance over their number.
    """
    if horizon == 1 and size == 2:
        return None
    positions = np.kron(np.eye(horizon), np.eye(2, size))
    return np.asarray(positions / horizon**0.5 if output == "mean" else positions[-2:])
