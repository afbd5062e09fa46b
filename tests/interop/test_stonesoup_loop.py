"""The whole loop: manager, attacker, a tracker for each group; order, determinism, certificates, networks, faults."""

import datetime
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import pytest

pytest.importorskip("stonesoup", reason="Stone Soup is not installed: pip install ratt-opt[stonesoup]")

from ordered_set import OrderedSet
from stonesoup.dataassociator.neighbour import GNNWith2DAssignment
from stonesoup.dataassociator.probability import JPDA
from stonesoup.deleter.error import CovarianceBasedDeleter
from stonesoup.hypothesiser.distance import DistanceHypothesiser
from stonesoup.hypothesiser.probability import PDAHypothesiser
from stonesoup.initiator.simple import SimpleMeasurementInitiator
from stonesoup.measures import Mahalanobis
from stonesoup.models.measurement.nonlinear import CartesianToElevationBearingRange
from stonesoup.platform import FixedPlatform
from stonesoup.predictor.information import InformationKalmanPredictor
from stonesoup.predictor.kalman import KalmanPredictor, SqrtKalmanPredictor
from stonesoup.predictor.particle import ParticlePredictor
from stonesoup.sensor.radar.beam_pattern import StationaryBeam
from stonesoup.sensor.radar.beam_shape import Beam2DGaussian
from stonesoup.sensor.radar.radar import AESARadar
from stonesoup.sensor.sensor import SensorSuite
from stonesoup.tracker.simple import MultiTargetMixtureTracker, MultiTargetTracker
from stonesoup.types.array import StateVectors
from stonesoup.types.groundtruth import GroundTruthPath, GroundTruthState
from stonesoup.types.prediction import StatePrediction
from stonesoup.types.state import (
    GaussianState,
    InformationState,
    ParticleState,
    SqrtGaussianState,
    State,
    StateVector,
)
from stonesoup.types.track import Track
from stonesoup.updater.kalman import ExtendedKalmanUpdater, UnscentedKalmanUpdater

from ratt_opt import Attack, InputError, save_scenario, verify_certificate
from ratt_opt.interop.stonesoup import (
    CriterionReward,
    GroupTrackers,
    RobustSensorManager,
    SequentialGreedySensorManager,
    WorstCaseAttacker,
)
from tests.interop.teams import NEXT, PLANAR, START, PositionSensor, grid_platform, predictor_of, radar, random_track

PREDICTOR = predictor_of(PLANAR["velocity"][0])
WHERE = (0, 2)


def team(seed: int, n: int = 4, *, n_steps: int = 1, fov: float = 90.0, dwells: int = 8) -> list[Any]:
    rng = np.random.default_rng([50, seed])
    return [grid_platform(rng, [radar(rng, WHERE, 4, fov=fov, dwells=dwells, seed=i)], n_steps) for i in range(n)]


def tracks(seed: int, n: int = 3) -> list[Any]:
    rng = np.random.default_rng([51, seed])
    return [random_track(rng, 4, WHERE) for _ in range(n)]


def tracker_of(updater: Any, *, jpda: bool) -> Any:
    initiator = SimpleMeasurementInitiator(GaussianState(np.zeros(4), np.diag([25.0, 4, 25, 4])))
    deleter = CovarianceBasedDeleter(covar_trace_thresh=300.0)
    if jpda:
        associator = JPDA(PDAHypothesiser(PREDICTOR, updater, clutter_spatial_density=1e-4, prob_detect=0.9))
        return MultiTargetMixtureTracker(initiator, deleter, None, associator, updater)
    associator = GNNWith2DAssignment(DistanceHypothesiser(PREDICTOR, updater, Mahalanobis(), missed_distance=4))
    return MultiTargetTracker(initiator, deleter, None, associator, updater)


def truths_at(step: int) -> list[GroundTruthPath]:
    """Four targets on their ways; one leaves at step 20, another appears then."""
    at = START + datetime.timedelta(seconds=step)
    found = []
    for k in range(4):
        if (k == 0 and step > 20) or (k == 3 and step < 20):
            continue
        start, speed = np.array([10.0 + 12 * k, 50 - 12 * k]), np.array([0.3, -0.2 + 0.1 * k])
        place = start + speed * step
        state = [place[0], speed[0], place[1], speed[1]]
        found.append(GroundTruthPath([GroundTruthState(state, timestamp=at)]))
    return found


@pytest.mark.parametrize("jpda", [False, True])
def test_fifty_steps_of_manager_attacker_and_trackers(jpda: bool) -> None:
    """Every warning is an error (pyproject.toml)."""
    platforms = team(1)
    updater = ExtendedKalmanUpdater(None)
    manager = RobustSensorManager(
        platforms=platforms, predictor=PREDICTOR, updater=updater, graph=nx.cycle_graph(4), alpha_s=1, alpha_c=2,
        method="ratt" if jpda else "refined",
    )  # fmt: skip
    attacker, trackers = WorstCaseAttacker(manager), GroupTrackers(tracker_of(updater, jpda=jpda))
    seen: list[int] = []
    assert not trackers.tracks
    for step in range(1, 51):
        timestamp = START + datetime.timedelta(seconds=step)
        truths = truths_at(step)
        (config,) = manager.choose_actions(trackers.tracks, timestamp)
        for actionable, actions in config.items():
            actionable.add_actions(actions)
        for actionable in manager.actionables:
            actionable.act(timestamp)
        aftermath = attacker.attack(trackers.tracks, timestamp)
        found = trackers.update(aftermath, truths, timestamp)
        assert found == trackers.tracks
        assert len(aftermath.blinded) <= 1
        assert len(aftermath.cut) <= 2
        assert sum(len(group.members) for group in aftermath.groups) == 4
        blind = {id(sensor) for platform in aftermath.blinded for sensor in platform.sensors}
        assert not blind & {id(sensor) for group in aftermath.groups for sensor in group.sensors}
        if aftermath.result is not None:
            assert aftermath.best.value == pytest.approx(aftermath.result.upper, rel=1e-9, abs=1e-9)
        seen.append(len(found))
    assert max(seen) >= 3
    assert len(set(seen)) > 1


def test_groups_are_really_apart() -> None:
    platforms = team(2, 2, n_steps=0, fov=360.0)
    for platform in platforms:
        platform.sensors[0].max_range = 500.0
    manager = RobustSensorManager(
        platforms=platforms, predictor=PREDICTOR, graph=nx.path_graph(2), alpha_s=0, alpha_c=1, method="ratt"
    )
    for platform in platforms:
        platform.sensors[0].act(NEXT)
    known = tracks(2, 2)
    aftermath = WorstCaseAttacker(manager).attack(known, NEXT)
    assert aftermath.cut == ((platforms[0], platforms[1]),)
    assert [len(group.members) for group in aftermath.groups] == [1, 1]
    assert aftermath.groups[0].value >= aftermath.groups[1].value
    updater = ExtendedKalmanUpdater(None)
    trackers = GroupTrackers(tracker_of(updater, jpda=False), reconnected=False)
    trackers.tracker._tracks |= set(known)
    truths = [GroundTruthPath([GroundTruthState(track.state_vector, timestamp=NEXT)]) for track in known]
    trackers.update(aftermath, truths, NEXT)
    (_, one), (_, two) = trackers.groups
    assert not one.tracks & two.tracks
    assert not one.tracks & set(known)
    for track in known:
        assert len(track) == 1
        copies = [next(t for t in tracker.tracks if t.id == track.id) for tracker in (one, two)]
        models = [copied.hypothesis.measurement.measurement_model.translation_offset for copied in copies]
        places = [group.members[0].position for group, _ in trackers.groups]
        np.testing.assert_allclose(np.asarray(models, dtype=float), np.asarray(places, dtype=float))
    later = NEXT + datetime.timedelta(seconds=1)
    for platform in platforms:
        platform.sensors[0].act(later)
    truths = [GroundTruthPath([GroundTruthState(track.state_vector, timestamp=later)]) for track in known]
    held = {group.members[0]: tracker for group, tracker in trackers.groups}
    trackers.update(WorstCaseAttacker(manager).attack(trackers.tracks, later), truths, later)
    for group, tracker in trackers.groups:  # each went on from its own tracks
        own, before = max(tracker.tracks, key=len), held[group.members[0]]
        assert any(own[0:2] == list(old)[0:2] or own[1] is old[1] for old in before.tracks)


def test_without_tracks_nobody_is_attacked_and_groups_are_the_networks() -> None:
    platforms = team(3, 3, n_steps=0)
    graph = nx.Graph([(0, 1)])
    manager = RobustSensorManager(platforms=platforms, predictor=PREDICTOR, graph=graph, alpha_c=1)
    aftermath = WorstCaseAttacker(manager).attack(set(), NEXT)
    assert aftermath.blinded == aftermath.cut == ()
    assert aftermath.result is None
    assert [len(group.members) for group in aftermath.groups] == [2, 1]
    assert [len(group.sensors) for group in aftermath.groups] == [2, 1]


def test_blinded_members_relay_but_see_nothing() -> None:
    platforms = team(3, 3, n_steps=0, fov=360.0)
    for platform in platforms:
        platform.sensors[0].max_range = 500.0
        platform.sensors[0].act(NEXT)
    manager = RobustSensorManager(platforms=platforms, predictor=PREDICTOR, graph=nx.path_graph(3), alpha_s=1)
    aftermath = WorstCaseAttacker(manager).attack(tracks(3), NEXT)
    (group,) = aftermath.groups
    assert set(group.members) == set(platforms)
    assert len(group.sensors) == 2
    truth = GroundTruthPath([GroundTruthState([30.0, 0, 30, 0], timestamp=NEXT)])
    assert [len(found) for found in group.detections([truth])] == [1, 1]


def test_nothing_of_the_users_moves_while_planning() -> None:
    platforms, known = team(4), set(tracks(4))
    before = [(np.array(p.position), len(p.states), np.array(p.sensors[0].dwell_centre)) for p in platforms]
    states = {track.id: list(track) for track in known}
    for method in ("ratt", "refined", "maxmin"):
        RobustSensorManager(platforms=platforms, predictor=PREDICTOR, method=method).choose_actions(known, NEXT)
    for platform, (place, count, dwell) in zip(platforms, before, strict=True):
        np.testing.assert_array_equal(platform.position, place)
        np.testing.assert_array_equal(platform.sensors[0].dwell_centre, dwell)
        assert len(platform.states) == count
        assert platform.sensors[0].timestamp == START
    assert {track.id: list(track) for track in known} == states


PROGRAM = """
import sys, numpy as np
sys.path.insert(0, {folder!r})
from tests.interop.test_stonesoup_loop import PREDICTOR, RobustSensorManager, team, tracks, NEXT
platforms = set(team(5))
manager = RobustSensorManager(platforms=platforms, predictor=PREDICTOR, method="refined", seed=3)
config = manager.choose_actions(set(tracks(5)), NEXT)[0]
for actionable, actions in config.items():
    actionable.add_actions(actions)
for node in manager.nodes:
    node.platform.act(NEXT)
    node.sensors[0].act(NEXT)
    print(np.ravel(node.platform.position).tolist(), float(node.sensors[0].dwell_centre[0, 0]))
print(manager.last_result.elements.tolist(), manager.last_result.lower)
"""


def test_actions_do_not_depend_on_the_hash_seed() -> None:
    folder = str(Path(__file__).parents[2])
    said = {
        subprocess.run(
            [sys.executable, "-c", PROGRAM.format(folder=folder)],
            env=os.environ | {"PYTHONHASHSEED": str(seed)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in (1, 2, 3)
    }
    assert len(said) == 1
    assert said.pop().count("\n") == 5


def test_lists_keep_their_order_and_sets_are_ordered_by_their_attributes() -> None:
    platforms = team(6)
    given = RobustSensorManager(platforms=platforms[::-1], predictor=PREDICTOR)
    assert [node.platform for node in given.nodes] == platforms[::-1]
    ordered = RobustSensorManager(platforms=OrderedSet(platforms[::-1]), predictor=PREDICTOR)
    assert [node.platform for node in ordered.nodes] == platforms[::-1]
    by_place = sorted(platforms, key=lambda platform: platform.position.ravel().tolist())
    sets = RobustSensorManager(platforms=set(platforms), predictor=PREDICTOR)
    assert [node.platform for node in sets.nodes] == by_place


def test_a_proof_is_written_if_asked_for(tmp_path: Path) -> None:
    manager = RobustSensorManager(
        platforms=team(7, 3), predictor=PREDICTOR, method="maxmin", proof=tmp_path / "step{step}.json"
    )
    for step in (1, 2):
        manager.choose_actions(tracks(7), NEXT)
        verified = verify_certificate(tmp_path / f"step{step}.json")
        assert float(verified.upper) >= manager.last_result.upper
        assert manager.last_certificate.path == tmp_path / f"step{step}.json"


def test_equal_and_dominated_elements_are_left_out() -> None:
    rng = np.random.default_rng(53)
    one = radar(rng, WHERE, 4, fov=60.0, dwells=24)
    manager = RobustSensorManager(
        platforms=[grid_platform(rng, [one], n_steps=0)], predictor=PREDICTOR, alpha_s=0, method="ratt"
    )
    manager.choose_actions(tracks(8), NEXT)
    assert manager.last_problem.objective.n < 13
    assert manager.last_problem.objective.dimension == 2  # positions, of states with velocities


def test_without_tracks_everyone_does_the_default() -> None:
    platforms = team(9)
    (config,) = RobustSensorManager(platforms=platforms, predictor=PREDICTOR).choose_actions(set(), NEXT)
    for actionable, actions in config.items():
        actionable.add_actions(actions)
        actionable.act(NEXT)
    assert len(config) == 8


def test_a_star_of_stone_soups_own_nodes_says_who_is_linked() -> None:
    pytest.importorskip(
        "graphviz", reason="the extra of Stone Soup is not installed: pip install stonesoup[architectures]"
    )
    from stonesoup.architecture import InformationArchitecture
    from stonesoup.architecture.edge import Edge, Edges
    from stonesoup.architecture.node import FusionNode, SensorNode

    platforms = team(10, 3, n_steps=0, fov=360.0)
    sensors = [SensorNode(platform.sensors[0], label=str(i)) for i, platform in enumerate(platforms)]
    centre = FusionNode(tracker_of(ExtendedKalmanUpdater(None), jpda=False), label="centre")
    edges = Edges([Edge((node, centre)) for node in sensors])
    assert len(InformationArchitecture(edges, current_time=START).all_nodes) == 4
    for platform in platforms:
        platform.sensors[0].max_range = 500.0
        platform.sensors[0].act(NEXT)
    manager = RobustSensorManager(platforms=platforms, predictor=PREDICTOR, graph=edges, alpha_s=0, alpha_c=2)
    aftermath = WorstCaseAttacker(manager).attack(tracks(10), NEXT)
    assert [len(group.sensors) for group in aftermath.groups] == [1, 1, 1]
    assert [len(group.members) for group in aftermath.groups].count(2) == 1  # one sensor and the centre
    assert all(pair[1] is centre for pair in aftermath.cut)
    (config,) = manager.choose_actions(tracks(10), NEXT)
    assert set(config) == {*platforms, *(platform.sensors[0] for platform in platforms)}


def refusal(**changes: Any) -> str:
    parts: dict[str, Any] = {"platforms": team(11, 3), "predictor": PREDICTOR} | changes
    known = parts.pop("tracks", tracks(11))
    nchoose = parts.pop("nchoose", 1)
    with pytest.raises(InputError) as refused:
        RobustSensorManager(**parts).choose_actions(known, NEXT, nchoose)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def still() -> FixedPlatform:
    sensor = PositionSensor(ndim_state=4, mapping=WHERE, noise_covar=np.eye(2))
    return FixedPlatform(
        states=[State(StateVector([0.0, 0]), timestamp=START)], position_mapping=(0, 1), sensors=[sensor]
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"alpha_s": 4}, "alpha_s (platforms and sensors that may be blinded, of 3) must be an integer in [0, 3]"),
        ({"alpha_c": 4}, "alpha_c (links that may be cut, of 3) must be an integer in [0, 3]; got 4"),
        ({"alpha_c": 3, "graph": nx.path_graph(3)}, "(links that may be cut, of 2) must be an integer in [0, 2]"),
        ({"graph": nx.path_graph(4)}, "unknown node; got 3"),
        ({"graph": [(0, "nobody")]}, "unknown node; got nobody"),
        ({"graph": [0]}, "must hold pairs of nodes, as Edge((sender, recipient)); got 0"),
        ({"graph": 7}, "graph must be a networkx graph, or edges of Stone Soup's network classes; got int"),
        ({"platforms": set()}, "platforms and sensors must hold a sensor"),
        ({"platforms": [still()]}, "must have actions: use a sensor that turns"),
        ({"method": "best"}, "method must be ratt, refined or maxmin; got best"),
        ({"criterion": "area"}, "must be trace, logdet or maxeig; got area"),
        ({"proof": "x.json"}, "proof needs method='maxmin'; got refined"),
        ({"nchoose": 2}, "nchoose must be 1"),
        ({"coordinates": (0, 9)}, "coordinates (of the tracks' states) must be an integer in [0, 3]; got 9"),
        ({"coordinates": (0,), "criterion": "logdet"}, "coordinates must be None with the criterion logdet"),
        (
            {"tracks": [Track([StatePrediction(np.zeros(4), timestamp=START)])], "predictor": None},
            "tracks must have states with a mean and a covariance (covar), as GaussianState; got StatePrediction",
        ),
        (
            {"tracks": [Track([GaussianState(np.full(4, np.nan), np.eye(4), timestamp=START)])]},
            "tracks must have finite means and covariances",
        ),
        (
            {"tracks": [Track([GaussianState(np.full(4, 30.0), 0 * np.eye(4), timestamp=START)])], "predictor": None},
            "tracks must have positive definite covariances where sensors measure; got 0.0",
        ),
        (
            {"tracks": [Track([GaussianState(np.zeros(2), np.eye(2), timestamp=START)])], "predictor": None},
            "tracks must have more than 2 dimensions, as the mapping of RadarRotatingBearingRange at",
        ),
    ],
)  # fmt: skip
def test_bad_input_gets_one_line_in_stone_soups_terms(changes: dict[str, Any], words: str) -> None:
    assert words in refusal(**changes)


def test_sensors_that_cannot_be_planned_for_are_named() -> None:
    loose = radar(np.random.default_rng(0), WHERE, 4)
    assert "sensors must have a position" in refusal(platforms=[], sensors=[loose], alpha_s=0)
    (one,) = team(12, 1)
    one.add_sensor(SensorSuite([radar(np.random.default_rng(0), WHERE, 4)], set()))
    assert "sensors must have a measurement model" in refusal(platforms=[one], alpha_s=0)
    (fine,) = team(13, 1)
    fine.add_sensor(radar(np.random.default_rng(0), WHERE, 4, dwells=100_000))
    assert "must have at most 100000 combinations of actions" in refusal(platforms=[fine], alpha_s=0)
    (singular,) = team(14, 1)
    singular.sensors[0].noise_covar = np.zeros((2, 2))
    assert "noise_covar of RadarRotatingBearingRange must be invertible" in refusal(platforms=[singular], alpha_s=0)
    with pytest.raises(InputError, match="reward_function must be given"):
        SequentialGreedySensorManager(platforms=team(15))


def test_a_model_without_a_jacobian_is_differentiated_numerically() -> None:
    class NoJacobian:
        ndim_state, mapping = 4, WHERE

        def function(self, state: Any, noise: Any = False) -> Any:  # noqa: ARG002
            return np.asarray(state.state_vector[list(WHERE), :], dtype=float) ** 2 / 10

        def covar(self) -> Any:
            return np.eye(2)

    class Squares(PositionSensor):
        @property
        def measurement_model(self) -> Any:
            return NoJacobian()

    platform = still()
    platform.add_sensor(Squares(ndim_state=4, mapping=WHERE, noise_covar=np.eye(2), radius=500.0))
    platform.pop_sensor(0)
    (track,) = tracks(16, 1)
    reward = CriterionReward()
    x, y = np.asarray(track.state_vector[list(WHERE), 0], dtype=float)
    prior = track.covar[np.ix_(WHERE, WHERE)]
    after = np.linalg.inv(np.linalg.inv(prior) + np.diag([x / 5, y / 5]) ** 2)
    value = reward({platform: (), platform.sensors[0]: ()}, [track], START)
    assert value == pytest.approx(np.trace(prior - after), rel=1e-6)
    team_of_one = RobustSensorManager(platforms=[platform, *team(16, 1)], method="ratt", alpha_s=0)
    team_of_one.choose_actions([track], NEXT)
    assert team_of_one.last_step.notes == ("NoJacobian of Squares states no Jacobian: differentiated numerically",)
    assert (
        CriterionReward(updater=UnscentedKalmanUpdater(None))
        .step(team_of_one.nodes[1:], (((None,), (None,)),), [track], NEXT)
        .notes
        == ()
    )


@pytest.mark.parametrize("kind", ["particles", "square roots", "information"])
def test_tracks_may_be_of_any_state_with_a_covariance(kind: str) -> None:
    model, rng = PREDICTOR.transition_model, np.random.default_rng(55)
    mean, spread = np.array([30.0, 0, 30, 0]), np.diag([4.0, 1, 4, 1])
    if kind == "particles":
        drawn = StateVectors(rng.multivariate_normal(mean, spread, 500).T)
        state, predictor = ParticleState(drawn, weight=np.full(500, 1 / 500), timestamp=START), ParticlePredictor(model)
    elif kind == "square roots":
        state = SqrtGaussianState(mean, np.sqrt(spread), timestamp=START)
        predictor = SqrtKalmanPredictor(model)
    else:
        precision = np.linalg.inv(spread)
        state = InformationState(precision @ mean, precision, timestamp=START)
        predictor = InformationKalmanPredictor(model)
    known = {Track([state])}
    manager = RobustSensorManager(platforms=team(1, fov=360.0), predictor=predictor, method="ratt", alpha_s=0)
    manager.choose_actions(known, NEXT)
    usual = RobustSensorManager(platforms=team(1, fov=360.0), predictor=PREDICTOR, method="ratt", alpha_s=0)
    usual.choose_actions({Track([GaussianState(mean, spread, timestamp=START)])}, NEXT)
    values = [m.last_problem.objective(m.last_result.elements) for m in (manager, usual)]
    assert values[0] == pytest.approx(values[1], rel=0.2 if kind == "particles" else 1e-9)


def test_targets_that_nobody_sees_are_planned_for_all_the_same() -> None:
    far = [Track([GaussianState([1000.0, 0, 1000, 0], np.eye(4), timestamp=START)])]
    for method in ("ratt", "refined", "maxmin"):
        manager = RobustSensorManager(platforms=team(1), predictor=PREDICTOR, method=method)
        assert len(manager.choose_actions(far, NEXT)[0]) == 8
        assert WorstCaseAttacker(manager).attack(far, NEXT).best.value == 0


def test_predictors_may_be_any() -> None:
    known = tracks(17)
    moved = [Track([KalmanPredictor(PREDICTOR.transition_model).predict(track, timestamp=NEXT)]) for track in known]
    with_predictor = RobustSensorManager(platforms=team(17), predictor=PREDICTOR, method="ratt")
    without = RobustSensorManager(platforms=team(17), method="ratt")
    with_predictor.choose_actions(known, NEXT)
    without.choose_actions(moved, NEXT)
    np.testing.assert_array_equal(with_predictor.last_result.elements, without.last_result.elements)


def test_a_step_is_model_free_input_whose_payload_says_what_to_do(tmp_path: Path) -> None:
    manager = RobustSensorManager(platforms=team(18), predictor=PREDICTOR, graph=nx.path_graph(4), alpha_c=1)
    (config,) = manager.choose_actions(tracks(18), NEXT)
    step = manager.last_step
    given = step.to_information()
    assert {a: actions for e in manager.last_result.elements for a, actions in given.payload[e].items()} == config
    plan = manager.last_result.elements
    for blinded in range(4):
        attack = Attack({blinded}, {(1, 2)})
        assert given.problem().team_value(plan, attack) == manager.last_problem.team_value(plan, attack)
    save_scenario(given, tmp_path / "step.json")
    part = RobustSensorManager(platforms=team(18), predictor=PREDICTOR, coordinates=(0,))
    part.choose_actions(tracks(18), NEXT)
    assert part.last_problem.objective.output.shape == (3, 1, 2)
    with pytest.raises(InputError, match="coordinates must be None"):
        part.last_step.to_information()


def test_a_radar_with_a_probability_of_detection_sees_what_is_likelier_than_not() -> None:
    model = CartesianToElevationBearingRange(ndim_state=6, mapping=[0, 2, 4], noise_covar=np.diag([1e-4, 1e-4, 1.0]))
    platform = FixedPlatform(states=[State(StateVector([0.0, 0, 0]), timestamp=START)], position_mapping=(0, 1, 2))
    beam = StationaryBeam(centre=[0.0, 0.0])
    aesa = AESARadar(
        measurement_model=model,
        position_mapping=(0, 2, 4),
        beam_shape=Beam2DGaussian(peak_power=50e3),
        beam_transition_model=beam,
        duty_cycle=0.2,
        band_width=30e3,
        receiver_noise=5,
        frequency=1e9,
        antenna_gain=30,
        beam_width=np.radians(10),
        rcs=10.0,
    )
    platform.add_sensor(aesa)
    reward, seen = CriterionReward(), []
    for bearing in np.radians([0.0, 2.0, 90.0]):
        mean = [1000 * np.cos(bearing), 0, 1000 * np.sin(bearing), 0, 0, 0]
        track = Track([GaussianState(mean, 25 * np.eye(6), timestamp=START)])
        truth = GroundTruthState(mean, timestamp=START)
        seen.append((reward({platform: (), aesa: ()}, [track], START) > 0, aesa.gen_probability(truth)[0] >= 0.5))
    assert seen == [(True, True), (True, True), (False, False)]
