"""Groups that split and meet believe what a central filter does, and nothing is counted twice."""

import numpy as np
import pytest

from ratt_opt import Belief, ConstantVelocity, InputError, random_scenario
from ratt_opt.missions.memory import Memory, Pieces


def pieces(rng, n_robots, n_targets):
    """Random pieces about the positions of constant-velocity targets."""
    information, vector = np.zeros((n_robots, n_targets, 4, 4)), np.zeros((n_robots, n_targets, 4))
    root = rng.normal(size=(n_robots, n_targets, 2, 2))
    information[..., :2, :2] = root @ root.swapaxes(-1, -2)
    vector[..., :2] = rng.normal(size=(n_robots, n_targets, 2))
    return Pieces(information, vector)


def start():
    scenario = random_scenario(4, 3, alpha_s=0, alpha_c=0, seed=0)
    motion = ConstantVelocity.of(scenario)
    return motion, Memory.start(motion, 1.0, motion.initial(scenario), 4)


def central(motion, belief, steps, robots):
    """Kalman filter in covariance form, one robot's measurement after the other."""
    mean, covariance = belief.mean.copy(), belief.covariance.copy()
    F, Q = motion.transition(mean, 1.0)[0], motion.noise(1.0)
    for step, seen in zip(steps, robots, strict=True):
        mean, covariance = mean @ F.T, F @ covariance @ F.T + Q
        for i in seen:
            for j in range(len(mean)):
                root = np.linalg.cholesky(step.information[i, j, :2, :2])
                H = np.concatenate([root.T, np.zeros((2, 2))], axis=1)
                z = np.linalg.solve(root, step.vector[i, j, :2])
                gain = covariance[j] @ H.T @ np.linalg.inv(H @ covariance[j] @ H.T + np.eye(2))
                mean[j] += gain @ (z - H @ mean[j])
                covariance[j] -= gain @ H @ covariance[j]
    return mean, covariance


def check(memory, robot, expected):
    found = memory.belief(robot)
    np.testing.assert_allclose(found.mean, expected[0], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(found.covariance, expected[1], rtol=1e-8, atol=1e-8)


def test_split_groups_meet_again_as_one_central_filter() -> None:
    rng = np.random.default_rng(0)
    motion, memory = start()
    first = memory.base
    everyone = np.ones(4, dtype=bool)
    splits = [[{0, 1}, {2, 3}], [{0}, {1, 2}, {3}], [{0, 3}, {1}, {2}], [{0, 1, 2, 3}]]
    log = []
    for groups in splits:
        log.append(pieces(rng, 4, 3))
        memory = memory.advanced(log[-1], everyone).shared(groups)
    check(memory, 2, central(motion, first, log, [range(4)] * 4))
    assert memory.steps == ()  # all know everything: nothing is kept but the belief


def test_a_group_knows_what_it_measured_or_was_told() -> None:
    rng = np.random.default_rng(1)
    motion, memory = start()
    first, everyone, log = memory.base, np.ones(4, dtype=bool), []
    for groups in ([{0, 1}, {2, 3}], [{0, 1}, {2, 3}], [{0, 2}, {1}, {3}]):
        log.append(pieces(rng, 4, 3))
        memory = memory.advanced(log[-1], everyone).shared(groups)
    check(memory, 0, central(motion, first, log, [range(4), range(4), [0, 2]]))
    check(memory, 1, central(motion, first, log, [[0, 1], [0, 1], [1]]))
    # Robots 1 and 0 meet: what 0 was told by 2 is known, the pieces that both hold count once.
    memory = memory.shared([{0, 1}, {2}, {3}])
    check(memory, 1, central(motion, first, log, [range(4), range(4), [0, 1, 2]]))
    assert memory.belief(1) == memory.belief(0)


def test_blinded_robots_make_no_piece() -> None:
    rng = np.random.default_rng(2)
    motion, memory = start()
    log = pieces(rng, 4, 3)
    made = np.array([True, False, False, True])
    memory = memory.advanced(log, made).shared([{0, 1, 2, 3}])
    check(
        memory, 1, central(motion, motion.initial(random_scenario(4, 3, alpha_s=0, alpha_c=0, seed=0)), [log], [[0, 3]])
    )


def test_bad_beliefs() -> None:
    with pytest.raises(InputError, match=r"covariance\[1\] must be positive definite"):
        Belief.of(np.zeros((2, 2)), [np.eye(2), np.diag([1.0, 0.0])])
    with pytest.raises(InputError, match="covariance must have shape"):
        Belief.of(np.zeros((2, 2)), np.eye(2)[None])
    with pytest.raises(InputError, match="mean must be finite"):
        Belief.of(np.full((1, 2), np.nan), np.eye(2)[None])
