"""The loop inside a real system: pure state, deadlines, clocks, bad input."""

import json
import pickle
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import InputError, Measurement, MissionModel, Tracker, TrackerState, random_scenario, ratt, run_mission
from ratt_opt.missions import run as mission_run


def team(n_robots=4, **options):
    return random_scenario(n_robots, 3, **({"alpha_s": 1, "alpha_c": 3, "seed": 3} | options))


@pytest.mark.parametrize("linearisation", ["first order", "second order", "iterated"])
def test_it_is_the_missions_loop(monkeypatch, linearisation: str) -> None:
    """Fed with a mission's measurements it believes what the mission does, and plans what it plans."""
    taken = []
    simulate = mission_run.simulated_readings
    monkeypatch.setattr(mission_run, "simulated_readings", lambda *a: taken.append(simulate(*a)) or taken[-1])
    scenario, model = team(), MissionModel(linearisation=linearisation)
    mission = run_mission(scenario, steps=6, attacker="none", model=model)
    tracker = Tracker(scenario, model=model, gate=None)
    measured: list[Measurement] = []
    for k, ((elements, _), step) in enumerate(zip(mission.decisions, mission.steps, strict=True)):
        plan = tracker.step(measured)
        assert np.array_equal(plan.elements, elements)
        assert np.array_equal(tracker.controls, step.controls)
        assert np.array_equal(tracker.state.poses, step.poses)
        measured = [
            Measurement(i, j, tuple(reading.values[j]))
            for i, reading in enumerate(taken[k])
            for j in np.flatnonzero(reading.seen).tolist()
        ]
    tracker.step(measured)
    last = mission.steps[-1].team.belief
    np.testing.assert_allclose(tracker.beliefs.mean, last.mean, rtol=1e-9)
    np.testing.assert_allclose(tracker.beliefs.covariance, last.covariance, rtol=1e-9, atol=1e-12)


def test_the_first_plan_is_the_one_step_plan() -> None:
    scenario = team()
    assert np.array_equal(Tracker(scenario).step().elements, ratt(scenario.problem()).elements)


@pytest.mark.parametrize("horizon", [1, 2])
def test_another_tracker_goes_on_from_a_state(horizon: int) -> None:
    scenario = team(n_robots=3, alpha_c=1, controls=((1.0, 0.0), (3.0, 1.0)))
    first = Tracker(scenario, horizon=horizon)
    first.step(now=10.0)
    first.step([Measurement(0, 1, (20.0, 0.3))], now=11.0)
    text = json.dumps(first.state.to_dict(), allow_nan=False)
    heirs = [
        Tracker(scenario, horizon=horizon, state=TrackerState.from_dict(json.loads(text))),
        Tracker(scenario, horizon=horizon, state=pickle.loads(pickle.dumps(first.state))),
        pickle.loads(pickle.dumps(first)),
    ]
    plan = first.step([Measurement(2, 0, (15.0, -0.2))], now=12.5)
    for heir in heirs:
        assert np.array_equal(heir.step([Measurement(2, 0, (15.0, -0.2))], now=12.5).elements, plan.elements)
        assert heir.state == first.state


def test_time_that_passes_makes_beliefs_uncertain() -> None:
    tracker = Tracker(team())
    tracker.step(now=0.0)
    before = tracker.beliefs.trace
    tracker.step(now=2.5)
    assert tracker.beliefs.trace == pytest.approx(before + 3 * 2 * 0.25 * 2.5)
    assert tracker.state.time == pytest.approx(2.5)
    tracker.step()
    assert tracker.state.now == pytest.approx(3.5)


def test_late_plans_are_counted_and_ratts_is_used() -> None:
    slow = {"seconds": 0.0}

    def planner(problem):
        time.sleep(slow["seconds"])
        return np.array([choice[-1] for choice in problem.choices])

    controls = ((1.0, 0.0), (2.0, 0.5))
    tracker = Tracker(team(n_robots=2, alpha_c=1, controls=controls), planner=planner, horizon=2, time_limit=0.2)
    tracker.step()
    assert tracker.state.missed == 0
    slow["seconds"] = 0.5
    ratts = Tracker(tracker.scenario, horizon=2, state=tracker.state).step().elements
    plan = tracker.step()
    assert tracker.state.missed == 1
    assert np.array_equal(plan.elements, ratts)
    tracker.step()  # the thread is still busy
    assert tracker.state.missed == 2
    time.sleep(0.5)
    slow["seconds"] = 0.0
    tracker.step()
    assert tracker.state.missed == 2
    assert len(plan.elements) == 2


def test_the_search_for_the_best_plan_keeps_its_time() -> None:
    tracker = Tracker(team(n_robots=6, alpha_c=5), planner="maxmin", time_limit=1.0)
    for _ in range(3):
        began = time.monotonic()
        tracker.step()
        assert time.monotonic() - began < 1.2
    assert tracker.state.steps == 3


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"measurements": [Measurement(9, 0, (1.0, 1.0))]}, r"measurements\[0\].robot must be an integer in \[0, 3\]"),
        ({"measurements": [Measurement(0, 3, (1.0, 1.0))]}, r"measurements\[0\].target must be one of the targets"),
        ({"measurements": [Measurement(0, 0, (-1.0, 1.0))]}, r"measurements\[0\].values must have a range >= 0"),
        (
            {"measurements": [Measurement(0, 0, (1.0, 1.0), 6.5)]},
            r"measurements\[0\].time must not be after this step's 6",
        ),
        (
            {"measurements": [Measurement(0, 0, (1.0, 1.0), 4.9)]},
            r"time must not be before 5 s, the oldest time that is",
        ),
        ({"measurements": [Measurement(0, 0, (1.0, 1.0), np.nan)]}, r"measurements\[0\].time must be a finite number"),
        ({"pose_covariances": np.zeros((4, 2, 2))}, r"pose_covariances must have shape \(4, 3, 3\)"),
        ({"pose_covariances": -np.ones((4, 1, 1)) * np.eye(3)}, r"pose_covariances\[0\] must be symmetric positive"),
        ({"measurements": [Measurement(0, 0, (1.0,))]}, r"measurements\[0\].values must have 2 numbers"),
        ({"measurements": [Measurement(0, 0, (1.0, np.nan))]}, r"measurements\[0\].values must be finite"),
        ({"measurements": [Measurement(0, 0, (1.0, 0.0))] * 2}, r"measurements\[1\] must not repeat"),
        ({"now": 4.0}, "now must not be before the last step's 5 s"),
        ({"now": np.inf}, "now must be a finite number"),
        ({"now": 1e9}, "now must be within 10000 sampling periods of the last step's, by 10005 s"),
        ({"measurements": [None]}, r"measurements\[0\] must be a Measurement"),
        ({"measurements": None}, "measurements must be Measurements; got None"),
        ({"measurements": [Measurement(robot=0, target=1, values=(1e300, 0.0))]}, r"values must stay within 1e\+12"),
        ({"poses": np.full((4, 3), 1e200)}, r"poses must stay within 1e\+12"),
        ({"poses": np.zeros((2, 3))}, "poses must have shape"),
        ({"poses": np.full((4, 3), np.nan)}, "poses must be finite"),
    ],
)
def test_bad_input_leaves_the_state_as_it_was(arguments, text: str) -> None:
    tracker = Tracker(team(), strict=True)
    tracker.step(now=5.0)
    before = tracker.state
    with pytest.raises(InputError, match=text) as caught:
        tracker.step(**arguments)
    assert "\n" not in str(caught.value)
    assert tracker.state is before


def test_bad_states_and_arguments() -> None:
    scenario = team()
    good = Tracker(scenario).state.to_dict()
    changes = {
        "format": "else",
        "version": 4,
        "moments": [],
        "poses": [[0.0, 0.0, 0.0]],
        "steps": -1,
        "targets": [0],
        "attack": {"sensing": [], "links": [[1, 0]]},
        "lost": [[1]],
        "controls": [[[float("nan"), 0.0]]] * 4,
    }
    for name, value in changes.items():
        with pytest.raises(InputError, match=name):
            Tracker(scenario, state=TrackerState.from_dict(good | {name: value}))
    moment = good["moments"][0]
    moments = {
        "covariance": np.zeros((3, 2, 2)).tolist(),
        "mean": [[float("nan"), 0.0]] * 3,
        "pose_covariances": [],
    }
    for name, value in moments.items():
        with pytest.raises(InputError, match=name):
            Tracker(scenario, state=TrackerState.from_dict(good | {"moments": [moment | {name: value}]}))
    with pytest.raises(InputError, match="estimates must stay within"):
        Tracker(scenario, state=TrackerState.from_dict(good | {"moments": [moment | {"mean": [[1e300, 0.0]] * 3}]}))
    with pytest.raises(InputError, match="covariance is missing"):
        TrackerState.from_dict(good | {"moments": [{k: v for k, v in moment.items() if k != "covariance"}]})
    with pytest.raises(InputError, match="born is missing"):
        TrackerState.from_dict({k: v for k, v in good.items() if k != "born"})
    with pytest.raises(InputError, match="state must be a record"):
        TrackerState.from_dict([good])  # type: ignore[arg-type]
    with pytest.raises(InputError, match="state must be a TrackerState"):
        Tracker(scenario, state=good)  # type: ignore[arg-type]
    for limit in (0, -1, float("nan")):
        with pytest.raises(InputError, match="time_limit"):
            Tracker(scenario, time_limit=limit)


def test_the_example_over_a_pipe_keeps_its_deadlines() -> None:
    """In processor time: answers are late by the clock where tests run beside each other."""
    command = [sys.executable, "-m", "analysis.live_loop", "--steps", "15"]
    root = Path(__file__).parents[3]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True, cwd=root)
    pattern = (
        r"15 steps at 10 Hz: answers late \d+, longest \d+ ms \((\d+) ms of the processor at most\); plans missed \d+"
    )
    found = re.match(pattern, done.stdout)
    assert found is not None
    assert int(found[1]) <= 100


@pytest.mark.parametrize("motion", ["known velocity", "constant velocity", "coordinated turn", "constant velocity 3d"])
def test_the_last_target_may_go_and_another_come(motion: str) -> None:
    """Without targets robots go on and sightings are skipped; a new target is tracked as by a tracker of it alone."""
    model = ro.MissionModel(motion=motion)
    team = ro.random_scenario(3, 1, alpha_s=1, alpha_c=1, seed=0)
    tracker = ro.Tracker(team, model=model)
    tracker.step()
    tracker.drop_target(0)
    plan = tracker.step([ro.Measurement(0, 0, (1.0, 0.1))])
    assert [one.reason for one in plan.skipped] == ["unknown target"]
    assert tracker.targets == ()
    kept = json.loads(json.dumps(tracker.state.to_dict()))
    again = ro.Tracker(tracker.scenario, model=model, state=ro.TrackerState.from_dict(kept))
    assert again.state == tracker.state
    fresh = ro.Target(x=3.0, y=4.0, speed=1.0)
    assert [one.add_target(fresh) for one in (tracker, again)] == [1, 1]
    alone = ro.Tracker(team.replace(targets=[fresh]), model=model)
    np.testing.assert_array_equal(tracker.beliefs.mean, alone.beliefs.mean)
    np.testing.assert_array_equal(tracker.step().elements, again.step().elements)
    assert tracker.beliefs == again.beliefs
