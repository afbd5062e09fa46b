"""Plans against brute force over Stone Soup's own configurations; other managers on the same reward."""

import copy
from importlib import import_module
from itertools import combinations
from typing import Any

import networkx as nx
import numpy as np
import pytest

pytest.importorskip("stonesoup", reason="Stone Soup is not installed: pip install ratt-opt[stonesoup]")

from stonesoup.sensormanager.base import BruteForceSensorManager, GreedySensorManager
from stonesoup.sensormanager.optimise import OptimizeBruteSensorManager
from stonesoup.sensormanager.tree_search import MCTSRolloutSensorManager, MonteCarloTreeSearchSensorManager
from stonesoup.types.groundtruth import GroundTruthState

from ratt_opt.interop.stonesoup import CriterionReward, RobustSensorManager, SequentialGreedySensorManager
from tests.interop.teams import NEXT, PositionSensor, grid_platform, predictor_of, radar, random_track
from tests.interop.teams import PLANAR as MODELS

WHERE = (0, 2)


class WorstCase:
    """A reward from the definition: Stone Soup's objects say what each node tells, all attacks are tried."""

    def __init__(self, manager: RobustSensorManager, graph: nx.Graph | None) -> None:
        self.manager, self.names = manager, [node.name for node in manager.nodes]
        self.graph = nx.complete_graph(len(self.names)) if graph is None else graph

    def __call__(self, config: dict[Any, Any], tracks: Any, timestamp: Any) -> float:
        predictions = [self.manager.predictor.predict(track, timestamp=timestamp) for track in tracks]
        priors = [np.asarray(p.covar)[np.ix_(WHERE, WHERE)] for p in predictions]
        told = self.told(config, predictions, timestamp)
        worst = np.inf
        for blinded in combinations(range(len(self.names)), self.manager.alpha_s):
            for cut in combinations(list(self.graph.edges), self.manager.alpha_c):
                left = self.graph.copy()
                left.remove_edges_from(cut)
                groups = [sorted(group - set(blinded)) for group in nx.connected_components(left)]
                worst = min(worst, max(self.value(priors, told[group].sum(axis=0)) for group in groups))
        return worst

    def told(self, config: dict[Any, Any], predictions: list[Any], timestamp: Any) -> np.ndarray:
        memo: dict[int, Any] = {}
        replicas = {actionable: copy.deepcopy(actionable, memo) for actionable in config}
        for actionable, actions in config.items():
            replicas[actionable].add_actions(actions)
            replicas[actionable].act(timestamp)
        told = np.zeros((len(self.names), len(predictions), 2, 2))
        for i, node in enumerate(self.manager.nodes):
            for sensor in node.sensors:
                model = replicas[sensor].measurement_model
                for j, prediction in enumerate(predictions):
                    if replicas[sensor].is_detectable(GroundTruthState(prediction.mean, timestamp=timestamp), model):
                        matrix = model.jacobian(prediction)[:, WHERE]
                        told[i, j] += matrix.T @ np.linalg.inv(np.asarray(model.covar())) @ matrix
        return told

    def value(self, priors: list[np.ndarray], told: np.ndarray) -> float:
        before, after = priors, [np.linalg.inv(np.linalg.inv(p) + x) for p, x in zip(priors, told, strict=True)]
        if self.manager.criterion == "trace":
            return sum(float(np.trace(p - q)) for p, q in zip(before, after, strict=True))
        if self.manager.criterion == "logdet":
            return sum(float(np.log(np.linalg.det(p) / np.linalg.det(q))) for p, q in zip(before, after, strict=True))
        return max(np.linalg.eigvalsh(p)[-1] for p in before) - max(np.linalg.eigvalsh(q)[-1] for q in after)


def small_case(rng: np.random.Generator, **more: Any) -> tuple[RobustSensorManager, list[Any], Any]:
    """Two or three nodes of at most four options each."""
    platforms: list[Any] = []
    sensors: list[Any] = []
    n = int(rng.integers(2, 4))
    for _ in range(n):
        turning = radar(rng, WHERE, 4, fov=float(rng.choice([60, 120])), dwells=3)
        if rng.random() < 0.3:
            sensors.append(radar(rng, WHERE, 4, fov=120.0, dwells=3, position=rng.uniform(0, 60, (2, 1))))
        elif rng.random() < 0.4:
            still = radar(rng, WHERE, 4, fov=150.0, dwells=1)
            still.rpm = 0.0
            platforms.append(grid_platform(rng, [still]))
        else:
            platforms.append(grid_platform(rng, [turning], n_steps=0))
    graph = nx.gnp_random_graph(n, 0.7, seed=int(rng.integers(1000))) if rng.random() < 0.6 else None
    links = n * (n - 1) // 2 if graph is None else graph.number_of_edges()
    manager = RobustSensorManager(
        platforms=platforms,
        sensors=sensors,
        predictor=predictor_of(MODELS["velocity"][0]),
        graph=graph,
        alpha_s=int(rng.integers(0, n)),
        alpha_c=int(rng.integers(0, min(links, 2) + 1)),
        criterion=str(rng.choice(["trace", "logdet", "maxeig"])),
        **more,
    )
    return manager, [random_track(rng, 4, WHERE) for _ in range(int(rng.integers(1, 4)))], graph


@pytest.mark.parametrize("block", range(10))
def test_the_best_plan_is_the_one_of_brute_force(block: int) -> None:
    rng = np.random.default_rng([45, block])
    for _ in range(50):
        manager, tracks, graph = small_case(rng, method="maxmin")
        reward = WorstCase(manager, graph)
        brute = BruteForceSensorManager(
            platforms=set(manager.platforms), sensors=set(manager.sensors), reward_function=reward
        )
        _, (best,) = brute.choose_actions(tracks, NEXT, return_reward=True)
        (config,) = manager.choose_actions(tracks, NEXT)
        assert set(config) == brute.actionables
        value = reward(config, tracks, NEXT)
        assert value == pytest.approx(best, rel=1e-6, abs=1e-6)
        assert manager.last_result.lower <= value + 1e-6 * (1 + abs(value))


def test_quick_plans_are_never_better_and_seldom_much_worse() -> None:
    rng = np.random.default_rng(46)
    ratios = []
    for _ in range(40):
        manager, tracks, graph = small_case(rng, method="maxmin")
        reward, values = WorstCase(manager, graph), {}
        for method in ("ratt", "refined", "maxmin"):
            manager.method = method
            values[method] = reward(manager.choose_actions(tracks, NEXT)[0], tracks, NEXT)
        slack = 1e-6 * (1 + abs(values["maxmin"]))
        assert values["ratt"] <= values["refined"] + slack <= values["maxmin"] + 2 * slack
        ratios.append((values["refined"] + slack) / (values["maxmin"] + slack))
    assert np.mean(ratios) > 0.98


@pytest.mark.parametrize("seed", range(5))
def test_stone_soups_managers_run_on_the_same_reward(seed: int) -> None:
    rng = np.random.default_rng([47, seed])
    manager, tracks, graph = small_case(rng, method="maxmin")
    parts = {"predictor": manager.predictor, "criterion": manager.criterion}
    team = {"platforms": set(manager.platforms), "sensors": set(manager.sensors)}
    plain, budgets = CriterionReward(**parts), {"alpha_s": manager.alpha_s, "alpha_c": manager.alpha_c}
    oracle = WorstCase(RobustSensorManager(**team | parts, alpha_s=0, alpha_c=0), None)
    _, (best,) = BruteForceSensorManager(**team, reward_function=plain).choose_actions(tracks, NEXT, return_reward=True)
    for other in (
        GreedySensorManager(**team, reward_function=plain),
        SequentialGreedySensorManager(**team, reward_function=plain),
        MonteCarloTreeSearchSensorManager(**team, reward_function=CriterionReward(**parts, return_tracks=True)),
        MCTSRolloutSensorManager(
            **team, reward_function=CriterionReward(**parts, return_tracks=True), rollout_depth=1, niterations=20
        ),
    ):
        (config,) = other.choose_actions(tracks, NEXT)
        assert plain(config, tracks, NEXT) <= best + 1e-9 * (1 + abs(best))
        assert plain(config, tracks, NEXT) == pytest.approx(oracle(config, tracks, NEXT), rel=1e-6, abs=1e-6)
    graph = None if graph is None else nx.relabel_nodes(graph, dict(enumerate(n.name for n in manager.nodes)))
    robust = CriterionReward(**parts, **budgets, graph=graph)
    (config,) = BruteForceSensorManager(**team, reward_function=robust).choose_actions(tracks, NEXT)
    manager.choose_actions(tracks, NEXT)
    assert robust(config, tracks, NEXT) == pytest.approx(manager.last_result.lower, rel=1e-6, abs=1e-6)


def test_values_of_different_configurations_are_about_the_same_coordinates() -> None:
    """One sensor measures x, another y: a plan that uses one of them alone must not be about that one alone."""
    (track,) = [random_track(np.random.default_rng(56), 4, WHERE)]
    sensors = [
        PositionSensor(ndim_state=4, mapping=(axis,), noise_covar=np.eye(1), position=np.zeros((2, 1)), radius=1e9)
        for axis in WHERE
    ]
    blind = PositionSensor(ndim_state=4, mapping=(2,), noise_covar=np.eye(1), position=np.zeros((2, 1)), radius=0.0)
    reward = CriterionReward(predictor_of(MODELS["velocity"][0]))
    prediction = reward.predictor.predict(track, timestamp=NEXT)
    prior = np.asarray(prediction.covar)[np.ix_(WHERE, WHERE)]
    after = np.linalg.inv(np.linalg.inv(prior) + np.diag([1.0, 0.0]))
    value = reward({sensors[0]: (), blind: ()}, [track], NEXT)
    assert value == pytest.approx(np.trace(prior - after), rel=1e-9)
    assert value > reward({sensors[0]: ()}, [track], NEXT)  # which is about x alone


def test_greedy_plans_are_ratts_without_an_adversary_and_with_everyone_as_bait() -> None:
    """So the benchmark may represent greedy managers by faster ones."""
    rng = np.random.default_rng(54)
    for _ in range(20):
        manager, tracks, _ = small_case(rng, method="ratt")
        manager.graph, manager.alpha_c = None, 0
        team = {"platforms": set(manager.platforms), "sensors": set(manager.sensors)}
        reward = CriterionReward(manager.predictor, criterion=manager.criterion)
        for alpha_s, kind in ((0, SequentialGreedySensorManager), (len(manager.nodes), GreedySensorManager)):
            manager.alpha_s = alpha_s
            parts = team if alpha_s else {"platforms": manager.platforms, "sensors": manager.sensors}
            (quick,) = manager.choose_actions(tracks, NEXT)
            (slow,) = kind(**parts, reward_function=reward).choose_actions(tracks, NEXT)
            if alpha_s == 0:
                assert reward(quick, tracks, NEXT) == pytest.approx(reward(slow, tracks, NEXT), rel=1e-9, abs=1e-9)
                continue
            for node in manager.nodes:  # greedy scores each alone
                alone = [{a: config[a] for a in node.actionables} for config in (quick, slow)]
                values = [reward(config, tracks, NEXT) for config in alone]
                assert values[0] >= values[1] - 1e-9 * (1 + abs(values[1]))


@pytest.mark.parametrize("kind", ["scipy", "optuna"])
def test_optimisers_of_sensors_run_on_the_same_reward(kind: str) -> None:
    rng = np.random.default_rng(48)
    sensors = [radar(rng, WHERE, 4, fov=60.0, dwells=12, position=rng.uniform(0, 60, (2, 1))) for _ in range(2)]
    tracks = [random_track(rng, 4, WHERE) for _ in range(3)]
    reward = CriterionReward(predictor_of(MODELS["velocity"][0]))
    if kind == "optuna":
        pytest.importorskip("optuna", reason="Optuna is not installed")
        optuna = import_module("stonesoup.sensormanager.optuna")
        optimiser = optuna.OptunaSensorManager(sensors=set(sensors), reward_function=reward, timeout=0.3)
        (config,) = optimiser.choose_actions(tracks, NEXT)
    else:
        optimiser = OptimizeBruteSensorManager(sensors=set(sensors), reward_function=reward, n_grid_points=6)
        ((config,), value) = optimiser.choose_actions(tracks, NEXT, return_reward=True)
        assert value == reward(config, tracks, NEXT)
    brute = BruteForceSensorManager(sensors=set(sensors), reward_function=reward)
    _, (best,) = brute.choose_actions(tracks, NEXT, return_reward=True)
    assert 0 <= reward(config, tracks, NEXT) <= best + 1e-9


def test_sequential_greedy_counts_what_others_tell_already() -> None:
    rng = np.random.default_rng(49)
    radars = [radar(rng, WHERE, 4, fov=40.0, dwells=12) for _ in range(2)]
    for each in radars:
        each.max_range = 100.0
    platforms = [
        grid_platform(rng, [each], n_steps=0, place=(x, 0.0)) for each, x in zip(radars, (0.0, 1.0), strict=True)
    ]
    ahead, behind = random_track(rng, 4, WHERE), random_track(rng, 4, WHERE)
    ahead[0].state_vector[[0, 2], 0] = 30, 0
    behind[0].state_vector[[0, 2], 0] = -30, 0
    ahead[0].covar, behind[0].covar = 9 * np.eye(4), 8 * np.eye(4)
    reward = CriterionReward(predictor_of(MODELS["velocity"][0]))
    both = [ahead, behind]
    greedy = GreedySensorManager(platforms=set(platforms), reward_function=reward).choose_actions(both, NEXT)[0]
    fair = SequentialGreedySensorManager(platforms=platforms, reward_function=reward).choose_actions(both, NEXT)[0]
    assert reward(fair, both, NEXT) > 1.8 * reward(greedy, both, NEXT)
