"""A bag is written with rosbags, replayed by the command, and its beliefs are those of a tracker fed by hand."""

import csv
import json

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import Measurement, MissionModel, PositionSensor, Robot, Scenario, Target, Tracker
from ratt_opt.cli import run
from tests.missions.bags.writer import HEADING, PERIOD, START, write

rosbags = pytest.importorskip("rosbags")
pytest.importorskip("mcap")

STILL = ((0.0, 0.0), (1.0, 0.0))
TEAM = Scenario(
    robots=[Robot(x=0.0, y=0.0, controls=STILL, name="ada"), Robot(x=30.0, y=0.0, controls=STILL)],
    targets=[Target(x=10.0, y=20.0, process_noise=0.1, covariance=((4.0, 0.0), (0.0, 4.0)))],
    sensor=PositionSensor(0.5),
    alpha_s=1,
    alpha_c=0,
    sampling_period=0.2,
)
MAPPING = {
    "format": "ratt-opt replay mapping",
    "version": 1,
    "scenario": "team.json",
    "poses": {"/ada/odom": 0, "/bob/pose": 1},
    "detections": {"/ada/objects": {"robot": 0, "frame": "robot"}, "/bob/objects": {"robot": 1}},
    "targets": {"7": 0},
}


def heard(rng):
    """Detections (time, topic, object, place in the map): object 7 moves, 8 appears later, one of 7 is a wild one."""
    rows = []
    for k in range(15):
        time = START + PERIOD * k + 0.05
        place = np.array([10.0 + 0.2 * k, 20.0]) + rng.normal(size=2) * 0.5
        rows.append((time, "/ada/objects", "7", place + np.array([300.0, 0.0]) if k == 9 else place))
        if k >= 5:
            rows.append((time, "/bob/objects", "8", np.array([25.0, 5.0]) + rng.normal(size=2) * 0.5))
    return rows


@pytest.mark.parametrize("kind", ["sqlite3", "mcap", "ros1", "mcap alone"])
def test_a_bag_in_and_plans_out(kind: str, tmp_path, capsys) -> None:
    rows = heard(np.random.default_rng(0))
    bag = tmp_path / ("run.bag" if kind == "ros1" else "run")
    write(bag, kind.removesuffix(" alone"), rows)
    if kind == "mcap alone":  # a recorder that was killed, or another tool, leaves no metadata
        (bag,) = bag.glob("*.mcap")
        bag = bag.rename(tmp_path / "alone.mcap")
    ro.save_scenario(TEAM, tmp_path / "team.json")
    (tmp_path / "map.json").write_text(json.dumps(MAPPING), encoding="utf-8")
    out = tmp_path / "out"
    assert run(["replay", str(bag), "--map", str(tmp_path / "map.json"), "--out", str(out)]) == 0
    assert "outlier 1" in capsys.readouterr().out
    tracker, waiting, steps, known = (
        Tracker(TEAM, model=MissionModel(motion="constant velocity")),
        list(rows),
        0,
        {"7": 0},
    )
    poses, unsure = [[0.0, 0.0, HEADING], [30.0, 0.0, 0.0]], np.zeros((2, 3, 3))
    unsure[0] = np.eye(3) * 0.01
    tracks = list(csv.DictReader((out / "tracks.csv").read_text(encoding="utf-8").splitlines()))
    for k in range(16):
        now, made = START + PERIOD * k, []
        while waiting and waiting[0][0] <= now:
            time, topic, name, place = waiting.pop(0)
            if name not in known:
                spread = ((0.25, 0.0), (0.0, 0.25))
                known[name] = tracker.add_target(Target(x=place[0], y=place[1], covariance=spread))
                continue
            made.append(Measurement(int(topic == "/bob/objects"), known[name], tuple(place), time))
        plan = tracker.step(made, now=now, poses=poses, pose_covariances=unsure)
        own = [row for row in tracks if abs(float(row["time"]) - now) < 1e-6]
        got = np.array([[float(row["x"]), float(row["y"])] for row in own])
        np.testing.assert_allclose(got, tracker.beliefs.positions, rtol=1e-6, atol=1e-6)
        steps += 1
        assert len(plan.elements) == 2
    assert steps == len(json.loads((out / "replay.json").read_text())["steps"])
    with (out / "replay.mcap").open("rb") as stream:
        from mcap.reader import make_reader

        topics = {channel.topic for _, channel, _ in make_reader(stream).iter_messages()}
    assert {"/scene", "/robots", "/targets/estimate", "/mission"} <= topics
    assert {path.name for path in out.iterdir()} >= {"plans.csv", "skipped.csv", "replay.png", "replay.svg"}


def test_bad_mappings_and_bags_are_one_line(tmp_path, capsys) -> None:
    ro.save_scenario(TEAM, tmp_path / "team.json")
    file, out = tmp_path / "map.json", tmp_path / "out"
    write(tmp_path / "run", "sqlite3", [])
    cases = (
        ({"poses": {"/ada/odom": 5}}, "must be in [0, 1]; got 5"),
        ({"targets": {"7": 3}}, "must be in [0, 0]; got 3"),
        ({"wheels": 4}, "wheels is not a field"),
        ({"poses": {"/lost": 0}, "detections": {}}, "must have the topic /lost"),
    )
    for change, text in cases:
        file.write_text(json.dumps(MAPPING | change), encoding="utf-8")
        assert run(["replay", str(tmp_path / "run"), "--map", str(file), "--out", str(out)]) == 2
        error = capsys.readouterr().err.strip()
        assert text in error, error
        assert "\n" not in error
    file.write_text(json.dumps(MAPPING), encoding="utf-8")
    assert run(["replay", str(tmp_path / "none"), "--map", str(file), "--out", str(out)]) == 2
    assert "must be a ROS bag" in capsys.readouterr().err
    (tmp_path / "torn.mcap").write_bytes(b"\x89MCAP0\r\nrubbish")
    assert run(["replay", str(tmp_path / "torn.mcap"), "--map", str(file), "--out", str(out)]) == 2
    assert "must be a ROS bag" in capsys.readouterr().err
    assert not list(out.glob("*")) if out.exists() else True
