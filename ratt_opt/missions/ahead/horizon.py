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
    from ratt_opt.missions.models.robots import RobotMotion
    from ratt_opt.missions.models.targets import TargetMotion
    from ratt_opt.scenario.model import Scenario

__all__ = ["OUTPUTS", "Sequences", "control_sequences", "extended", "joint_position_covariance", "output_matrix"]

OUTPUTS = ("mean", "last")
NOISE_FLOOR = 1e-6
"""Of a target's covariance: joint states whose steps determine each other (no process noise) get that much noise
a step, so that their prior is invertible. It moves values by that share."""
MOST_SEQUENCES = 20_000
"""Of one robot: twelve controls make 1,728 in three steps and 20,736 in four, whose matrices would take gigabytes."""


@dataclass(frozen=True, slots=True, eq=False)
class Sequences:
    """The elements of a plan: ``owner`` (E,), ``controls`` (E, H, 2) and the ``poses`` (E, H, 3) they lead through."""

    owner: IntArray
    controls: FloatArray
    poses: FloatArray

    def only(self, elements: IntArray | BoolArray) -> Sequences:
        """Some of them."""
        chosen = (self.owner[elements], self.controls[elements], self.poses[elements])
        return Sequences(*(readonly(part) for part in chosen))


def control_sequences(scenario: Scenario, poses: FloatArray, horizon: int, motion: RobotMotion) -> Sequences:
    """All sequences of ``horizon`` controls of every robot, robot by robot, the first control slowest.

    InputError : a robot would have too many.
    """
    owner, controls = [], []
    for i, robot in enumerate(scenario.robots):
        count = len(robot.controls) ** horizon
        if count > MOST_SEQUENCES:
            raise InputError("horizon", f"must give robot {i} at most {MOST_SEQUENCES} control sequences", count)
        owner.append(np.full(count, i))
        controls.append(np.array(list(product(robot.controls, repeat=horizon))))
    owners, sequences = np.concatenate(owner), np.concatenate(controls)
    path = [poses[owners]]
    for h in range(horizon):
        path.append(motion(path[-1], sequences[:, h], scenario.sampling_period))
    return Sequences(readonly(owners), readonly(sequences), readonly(np.stack(path[1:], axis=1)))


def extended(scenario: Scenario, sequences: Sequences, motion: RobotMotion) -> Sequences:
    """Every sequence followed by every control of its robot, the new control fastest."""
    counts = np.array([len(robot.controls) for robot in scenario.robots])[sequences.owner]
    again = np.repeat(np.arange(len(sequences.owner)), counts)
    added = np.concatenate([np.array(scenario.robots[i].controls) for i in sequences.owner])
    last = motion(sequences.poses[again, -1], added, scenario.sampling_period)
    controls = np.concatenate([sequences.controls[again], added[:, None]], axis=1)
    poses = np.concatenate([sequences.poses[again], last[:, None]], axis=1)
    return Sequences(readonly(sequences.owner[again]), readonly(controls), readonly(poses))


def joint_position_covariance(beliefs: list[Belief], motion: TargetMotion, period: float) -> FloatArray:
    """(M, 2 H, 2 H) of the positions in all steps, from the predicted beliefs of the H steps."""
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
        joint += NOISE_FLOOR * sizes[:, None, :] * np.eye(horizon * d)
    places = np.array([h * d + axis for h in range(horizon) for axis in range(2)])
    return joint[:, places[:, None], places]


def output_matrix(output: str, horizon: int) -> FloatArray | None:
    """(q, 2 H) the part of all steps' positions that counts; ``None`` if that is the whole of one position.

    ``"last"`` : the position at the last step; ``"mean"`` : those of all steps, over the root of their number: the
    trace is then the mean of theirs, and the largest eigenvalue that of the joint covariance over their number.
    """
    if horizon == 1:
        return None
    whole = np.eye(2 * horizon)
    return whole / horizon**0.5 if output == "mean" else whole[-2:]
