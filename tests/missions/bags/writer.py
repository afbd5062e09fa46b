"""Bags for tests, written with rosbags: poses of ada and bob, detections by ada in her frame, by bob in the map."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ratt_opt.missions.bags.reading import DEFINITIONS

__all__ = ["HEADING", "PERIOD", "START", "write"]

START, PERIOD, HEADING = 1000.0, 0.2, 0.5
"""First stamp [s], time between poses [s], heading of ada, who stands at the origin; bob stands at (30, 0)."""
OBJECT = {"detection_level": 0, "object_classified": False, "classification": 0}
OBJECT |= {"classification_certainty": 0, "classification_age": 0}


@dataclass(frozen=True)
class Messages:
    """Messages of ROS 1 (``old``) or ROS 2."""

    old: bool

    @cached_property
    def store(self) -> Any:
        """The types of the release, with those of detections."""
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        store = get_typestore(Stores.ROS1_NOETIC if self.old else Stores.ROS2_HUMBLE)
        for name, text in DEFINITIONS.items():
            store.register(get_types_from_msg(text, name))
        return store

    def make(self, kind: str, **fields: Any) -> Any:
        """A message of ``package/Name``."""
        return self.store.types[kind.replace("/", "/msg/")](**fields)

    def header(self, time: float) -> Any:
        stamp = self.make("builtin_interfaces/Time", sec=int(time), nanosec=round((time - int(time)) * 1e9))
        return self.make("std_msgs/Header", stamp=stamp, frame_id="map", **({"seq": 0} if self.old else {}))

    @cached_property
    def still(self) -> Any:
        return self.make("geometry_msgs/Vector3", x=0.0, y=0.0, z=0.0)

    @cached_property
    def twist(self) -> Any:
        speeds = self.make("geometry_msgs/Twist", linear=self.still, angular=self.still)
        return self.make("geometry_msgs/TwistWithCovariance", twist=speeds, covariance=np.zeros(36))

    def pose(self, x: float, y: float, heading: float = 0.0, variance: float = 0.0) -> Any:
        z, w = math.sin(heading / 2), math.cos(heading / 2)
        turn = self.make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=z, w=w)
        place = self.make("geometry_msgs/Point", x=x, y=y, z=0.0)
        pose = self.make("geometry_msgs/Pose", position=place, orientation=turn)
        return self.make("geometry_msgs/PoseWithCovariance", pose=pose, covariance=np.eye(6).ravel() * variance)

    def odometry(self, time: float) -> Any:
        where = {"child_frame_id": "ada", "pose": self.pose(0.0, 0.0, HEADING, 0.01), "twist": self.twist}
        return self.make("nav_msgs/Odometry", header=self.header(time), **where)

    def stamped(self, time: float) -> Any:
        return self.make("geometry_msgs/PoseStamped", header=self.header(time), pose=self.pose(30.0, 0.0).pose)

    def vision(self, time: float, name: str, place: tuple[float, float]) -> Any:
        sort = self.make("vision_msgs/ObjectHypothesis", class_id="boat", score=0.9)
        one = self.make("vision_msgs/ObjectHypothesisWithPose", hypothesis=sort, pose=self.pose(*place, 0.0, 0.25))
        box = self.make("vision_msgs/BoundingBox3D", center=one.pose.pose, size=self.still)
        found = self.make("vision_msgs/Detection3D", header=self.header(time), results=[one], bbox=box, id=name)
        return self.make("vision_msgs/Detection3DArray", header=self.header(time), detections=[found])

    def derived(self, time: float, name: str, place: tuple[float, float]) -> Any:
        acceleration = self.make("geometry_msgs/Accel", linear=self.still, angular=self.still)
        polygon = self.make("geometry_msgs/Polygon", points=[])
        shape = self.make(
            "shape_msgs/SolidPrimitive", type=1, dimensions=np.zeros(3), **({} if self.old else {"polygon": polygon})
        )
        one = self.make(
            "derived_object_msgs/ObjectWithCovariance",
            header=self.header(time),
            id=int(name),
            pose=self.pose(*place, 0.0, 0.25),
            twist=self.twist,
            accel=self.make("geometry_msgs/AccelWithCovariance", accel=acceleration, covariance=np.zeros(36)),
            polygon=polygon,
            shape=shape,
            **OBJECT,
        )
        return self.make("derived_object_msgs/ObjectWithCovarianceArray", header=self.header(time), objects=[one])


def write(path: Any, kind: str, rows: list[tuple[float, str, str, Any]]) -> None:
    """Write a bag of one kind (``ros1``, ``sqlite3`` or ``mcap``) with detections (time, topic, object, place)."""
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2

    made = Messages(kind == "ros1")
    plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
    with Writer1(path) if made.old else Writer2(path, version=9, storage_plugin=plugin) as writer:
        known: dict[str, Any] = {}
        for time, topic, message in sorted(_events(made, rows), key=lambda event: event[0]):
            name = message.__msgtype__
            if topic not in known:
                known[topic] = writer.add_connection(topic, name, typestore=made.store)
            raw = made.store.serialize_ros1(message, name) if made.old else made.store.serialize_cdr(message, name)
            writer.write(known[topic], round(time * 1e9), raw)


def _events(made: Messages, rows: list[tuple[float, str, str, Any]]) -> list[tuple[float, str, Any]]:
    """Messages with their times and topics; ada's detections in her own frame."""
    times = [START + PERIOD * k for k in range(16)]
    events = [(time, "/ada/odom", made.odometry(time)) for time in times]
    events += [(time, "/bob/pose", made.stamped(time)) for time in times]
    cosine, sine = math.cos(HEADING), math.sin(HEADING)
    for time, topic, name, (x, y) in rows:
        if topic == "/ada/objects":
            events.append((time, topic, made.vision(time, name, (cosine * x + sine * y, -sine * x + cosine * y))))
        else:
            events.append((time, topic, made.derived(time, name, (x, y))))
    return events
