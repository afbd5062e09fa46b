"""A bag is written with rosbags, replayed by the command, and its beliefs are those of a tracker fed by hand."""

from __future__ import annotations

import csv
import json
import math

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import Measurement, MissionModel, PositionSensor, Robot, Scenario, Target, Tracker
from ratt_opt.cli import run

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
START = 1000.0
HEADING = 0.5


def heard(rng):
    """Detections (time, topic, object, place in the map): object 7 moves, 8 appears later, one of 7 is a wild one."""
    rows = []
    for k in range(15):
        time = START + 0.2 * k + 0.05
        place = np.array([10.0 + 0.2 * k, 20.0]) + rng.normal(size=2) * 0.5
        rows.append((time, "/ada/objects", "7", place + np.array([300.0, 0.0]) if k == 9 else place))
        if k >= 5:
            rows.append((time, "/bob/objects", "8", np.array([25.0, 5.0]) + rng.normal(size=2) * 0.5))
    return rows


def write(path, kind, rows):
    """A bag of one kind: ``ros1``, ``sqlite3`` or ``mcap``."""
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    from ratt_opt.missions.bags.reading import DEFINITIONS

    old = kind == "ros1"
    store = get_typestore(Stores.ROS1_NOETIC if old else Stores.ROS2_HUMBLE)
    for name, text in DEFINITIONS.items():
        store.register(get_types_from_msg(text, name))
    types = store.types
    Stamp, Header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
    Point, Quaternion = types["geometry_msgs/msg/Point"], types["geometry_msgs/msg/Quaternion"]
    Pose, Spread = types["geometry_msgs/msg/Pose"], types["geometry_msgs/msg/PoseWithCovariance"]
    Vector, Twist = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Twist"]
    TwistSpread, Acc = types["geometry_msgs/msg/TwistWithCovariance"], types["geometry_msgs/msg/Accel"]

    def header(time):
        stamp = Stamp(sec=int(time), nanosec=round((time - int(time)) * 1e9))
        return Header(seq=0, stamp=stamp, frame_id="map") if old else Header(stamp=stamp, frame_id="map")

    def pose(x, y, heading=0.0, variance=0.0):
        turn = Quaternion(x=0.0, y=0.0, z=math.sin(heading / 2), w=math.cos(heading / 2))
        place = Pose(position=Point(x=x, y=y, z=0.0), orientation=turn)
        return Spread(pose=place, covariance=np.eye(6).ravel() * variance)

    still = Vector(x=0.0, y=0.0, z=0.0)
    twist = TwistSpread(twist=Twist(linear=still, angular=still), covariance=np.zeros(36))

    def odometry(time):
        kind = types["nav_msgs/msg/Odometry"]
        return kind(header=header(time), child_frame_id="ada", pose=pose(0.0, 0.0, HEADING, 0.01), twist=twist)

    def stamped(time):
        return types["geometry_msgs/msg/PoseStamped"](header=header(time), pose=pose(30.0, 0.0).pose)

    def vision(time, name, place):
        one = types["vision_msgs/msg/ObjectHypothesisWithPose"](
            hypothesis=types["vision_msgs/msg/ObjectHypothesis"](class_id="boat", score=0.9),
            pose=pose(*place, 0.0, 0.25),
        )
        box = types["vision_msgs/msg/BoundingBox3D"](center=one.pose.pose, size=still)
        found = types["vision_msgs/msg/Detection3D"](header=header(time), results=[one], bbox=box, id=name)
        return types["vision_msgs/msg/Detection3DArray"](header=header(time), detections=[found])

    def derived(time, name, place):
        acc = types["geometry_msgs/msg/AccelWithCovariance"](
            accel=Acc(linear=still, angular=still), covariance=np.zeros(36)
        )
        solid = types["shape_msgs/msg/SolidPrimitive"]
        fields = {"polygon": types["geometry_msgs/msg/Polygon"](points=[])} if not old else {"polygon": None}
        shape = solid(type=1, dimensions=np.zeros(3), **({} if old else fields))
        one = types["derived_object_msgs/msg/ObjectWithCovariance"](
            header=header(time),
            id=int(name),
            detection_level=0,
            object_classified=False,
            pose=pose(*place, 0.0, 0.25),
            twist=twist,
            accel=acc,
            polygon=types["geometry_msgs/msg/Polygon"](points=[]),
            shape=shape,
            classification=0,
            classification_certainty=0,
            classification_age=0,
        )
        return types["derived_object_msgs/msg/ObjectWithCovarianceArray"](header=header(time), objects=[one])

    cosine, sine = math.cos(HEADING), math.sin(HEADING)
    events = [(START + 0.2 * k, "/ada/odom", "nav_msgs/msg/Odometry", odometry(START + 0.2 * k)) for k in range(16)]
    events += [(t, "/bob/pose", "geometry_msgs/msg/PoseStamped", stamped(t)) for t, *_ in events]
    for time, topic, name, (x, y) in rows:
        if topic == "/ada/objects":
            body = (cosine * x + sine * y, -sine * x + cosine * y)
            events.append((time, topic, "vision_msgs/msg/Detection3DArray", vision(time, name, body)))
        else:
            kind2 = "derived_object_msgs/msg/ObjectWithCovarianceArray"
            events.append((time, topic, kind2, derived(time, name, (x, y))))
    plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
    with Writer1(path) if old else Writer2(path, version=9, storage_plugin=plugin) as writer:
        known = {}
        for time, topic, name, message in sorted(events, key=lambda event: event[0]):
            if topic not in known:
                known[topic] = writer.add_connection(topic, name, typestore=store)
            raw = store.serialize_ros1(message, name) if old else store.serialize_cdr(message, name)
            writer.write(known[topic], round(time * 1e9), raw)


@pytest.mark.parametrize("kind", ["sqlite3", "mcap", "ros1"])
def test_a_bag_in_and_plans_out(kind: str, tmp_path, capsys) -> None:
    rows = heard(np.random.default_rng(0))
    bag = tmp_path / ("run.bag" if kind == "ros1" else "run")
    write(bag, kind, rows)
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
        now, made = START + 0.2 * k, []
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
    assert not list(out.glob("*")) if out.exists() else True
