"""Values of a step's problem, against Stone Soup's own updater fed with predicted measurements."""

import copy
from itertools import islice
from typing import Any

import numpy as np
import pytest

pytest.importorskip("stonesoup", reason="Stone Soup is not installed: pip install ratt-opt[stonesoup]")

from stonesoup.models.transition.linear import ConstantVelocity
from stonesoup.platform import FixedPlatform
from stonesoup.types.groundtruth import GroundTruthState
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import State
from stonesoup.types.update import Update
from stonesoup.updater.kalman import ExtendedKalmanUpdater, UnscentedKalmanUpdater

from ratt_opt.interop.stonesoup import RobustSensorManager, closed_forms
from ratt_opt.interop.stonesoup.nodes import options
from tests.interop.teams import NEXT, predictor_of, radar, random_team, random_track

CRITERIA = {
    "trace": lambda before, after: sum(np.trace(p) - np.trace(q) for p, q in zip(before, after, strict=True)),
    "logdet": lambda before, after: sum(
        np.linalg.slogdet(p)[1] - np.linalg.slogdet(q)[1] for p, q in zip(before, after, strict=True)
    ),
    "maxeig": lambda before, after: (
        max(np.linalg.eigvalsh(p)[-1] for p in before) - max(np.linalg.eigvalsh(q)[-1] for q in after)
    ),
}


class OurJacobian(ExtendedKalmanUpdater):
    """Stone Soup's update with this package's Jacobian where it has one."""

    def _measurement_matrix(self, predicted_state: Any, measurement_model: Any = None, **more: Any) -> Any:
        sensor = measurement_model.asked
        if not closed_forms.is_recognised(sensor):
            return super()._measurement_matrix(predicted_state, measurement_model, **more)
        place = np.asarray(measurement_model.translation_offset, dtype=float).ravel()
        angles = np.asarray(measurement_model.rotation_offset, dtype=float).ravel()
        mean = np.asarray(predicted_state.mean, dtype=float).ravel()
        _, rows = closed_forms.linearised(sensor, place, angles, mean[None])
        matrix = np.zeros((rows.shape[-2], len(mean)))
        matrix[:, closed_forms.mapping_of(sensor)] = rows[0]
        return matrix


def updated(config: dict[Any, Any], tracks: list[Any], predictor: Any, updater: Any) -> list[Any]:
    """Each track's prediction and its update after the predicted measurements of every sensor of the team."""
    memo: dict[int, Any] = {}
    acted = []
    for actionable, actions in config.items():
        replica = copy.deepcopy(actionable, memo)
        replica.add_actions(actions)
        replica.act(NEXT)
        acted.append(replica)
    found = []
    for track in tracks:
        prediction = state = predictor.predict(track, timestamp=NEXT)
        truth = GroundTruthState(prediction.mean, timestamp=NEXT)
        for sensor in acted:
            if hasattr(sensor, "measure"):
                for detection in sensor.measure({truth}, noise=False):
                    detection.measurement_model.asked = sensor
                    state = updater.update(SingleHypothesis(state, detection))
        found.append((prediction, state))
    return found


def random_step(rng: np.random.Generator, criterion: str, updater: Any) -> tuple[Any, dict[Any, Any], list[Any], Any]:
    """A step of one drawn option for each platform and sensor."""
    platforms, sensors, tracks, predictor = random_team(rng, int(rng.integers(1, 4)), int(rng.integers(1, 4)))
    manager = RobustSensorManager(
        platforms=platforms, sensors=sensors, predictor=predictor, updater=updater, criterion=criterion
    )
    config = {}
    for node in manager.nodes:
        for actionable in node.actionables:
            every = list(islice(options(actionable, NEXT), 40))
            config[actionable] = every[rng.integers(len(every))]
    choices = tuple(tuple([config[a]] for a in node.actionables) for node in manager.nodes)
    return manager.step(manager.nodes, choices, tracks, NEXT), config, tracks, predictor


@pytest.mark.parametrize("block", range(10))
def test_values_are_those_of_stone_soups_updater(block: int) -> None:
    rng = np.random.default_rng([43, block])
    told = 0
    for case in range(50):
        criterion = list(CRITERIA)[case % 3]
        ours = case % 2 == 0
        updater = OurJacobian(None) if ours else ExtendedKalmanUpdater(None)
        step, config, tracks, predictor = random_step(rng, criterion, updater)
        pairs = updated(config, tracks, predictor, updater)
        blocks = [np.ix_(rows, rows) for rows in step.coordinates]
        before = [np.asarray(p.covar)[b] for (p, _), b in zip(pairs, blocks, strict=True)]
        after = [np.asarray(s.covar)[b] for (_, s), b in zip(pairs, blocks, strict=True)]
        expected = CRITERIA[criterion](before, after)
        scale = CRITERIA["trace"](before, 0 * np.array(before, dtype=object)) if criterion != "logdet" else 1 + expected
        value = step.problem.objective(range(step.problem.n_robots))
        assert value == pytest.approx(expected, abs=(1e-9 if ours else 1e-6) * scale)
        told += any(isinstance(state, Update) for _, state in pairs)
    assert told > 25  # most teams see something


@pytest.mark.parametrize("seed", range(20))
def test_an_unscented_updater_is_asked_for_its_own_linearisation(seed: int) -> None:
    rng = np.random.default_rng([44, seed])
    updater, track = UnscentedKalmanUpdater(None), random_track(rng, 4, (0, 2))
    predictor, sensor = predictor_of([ConstantVelocity(0.1)] * 2), radar(rng, (0, 2), 4, fov=360.0)
    sensor.max_range = 200.0
    platform = FixedPlatform(states=[State([30.0, 30.0])], position_mapping=(0, 1), sensors=[sensor])
    counted = (0, 2) if seed % 2 else None
    manager = RobustSensorManager(platforms=[platform], predictor=predictor, updater=updater, coordinates=counted)
    config = {platform: (), sensor: options(sensor, NEXT)[0]}
    step = manager.step(manager.nodes, (([()], [config[sensor]]),), [track], NEXT)
    ((before, after),) = updated(config, [track], predictor, updater)
    block = np.ix_(counted or range(4), counted or range(4))
    expected = CRITERIA["trace"]([before.covar[block]], [after.covar[block]])
    assert step.problem.objective([0]) == pytest.approx(expected, rel=1e-6)
