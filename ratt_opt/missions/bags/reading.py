"""Poses and detections of ROS 1 and ROS 2 bags (MCAP too), read without ROS; the extra ``bags``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.errors import FileFormatError, InputError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

    from ratt_opt._validation import FloatArray

__all__ = ["Detection", "PoseMessage", "read_bag"]

DEFINITIONS = {
    "vision_msgs/msg/ObjectHypothesis": "string class_id\nfloat64 score\n",
    "vision_msgs/msg/ObjectHypothesisWithPose": "vision_msgs/ObjectHypothesis hypothesis\n"
    "geometry_msgs/PoseWithCovariance pose\n",
    "vision_msgs/msg/BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size\n",
    "vision_msgs/msg/Detection3D": "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
    "vision_msgs/BoundingBox3D bbox\nstring id\n",
    "vision_msgs/msg/Detection3DArray": "std_msgs/Header header\nvision_msgs/Detection3D[] detections\n",
    "derived_object_msgs/msg/ObjectWithCovariance": "std_msgs/Header header\nuint32 id\nuint8 detection_level\n"
    "bool object_classified\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"
    "geometry_msgs/AccelWithCovariance accel\ngeometry_msgs/Polygon polygon\nshape_msgs/SolidPrimitive shape\n"
    "uint8 classification\nuint8 classification_certainty\nuint32 classification_age\n",
    "derived_object_msgs/msg/ObjectWithCovarianceArray": "std_msgs/Header header\n"
    "derived_object_msgs/ObjectWithCovariance[] objects\n",
}
"""Message types that are no part of ROS itself, for bags that do not carry them (``sqlite3``)."""


@dataclass(frozen=True, slots=True, eq=False)
class PoseMessage:
    """A robot's pose at ``time`` [s]: ``pose`` (4,) x, y [m], heading [rad], height [m]; ``covariance`` (4, 4)."""

    topic: str
    time: float
    pose: FloatArray
    covariance: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Detection:
    """An object at ``time`` [s], in the frame of its message: ``place`` (3,) [m], ``velocity`` (3,) [m/s] or ``None``.

    ``covariance`` : (3, 3) of the place [m^2], zero if the message does not say.
    """

    topic: str
    time: float
    object: str
    place: FloatArray
    velocity: FloatArray | None
    covariance: FloatArray


def read_bag(path: Path, topics: Collection[str]) -> Iterator[PoseMessage | Detection]:
    """Poses and detections on these topics, in the order of their recording.

    Raises
    ------
    FileFormatError : the bag cannot be read, has no such topic, or a message of another type there.
    InputError : the library ``rosbags`` is not installed.
    """
    alone = path.suffix == ".mcap" and not path.is_dir()
    for topic, kind, message in (_mcap_messages if alone else _bag_messages)(path, topics):
        yield from _told(path, topic, kind, message)


def _store(path: Path, release: str = "ROS2_HUMBLE") -> Any:
    """The message types of a release and those of detections. InputError : ``rosbags`` is not installed."""
    try:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    except ImportError:
        raise InputError("bag", "needs the extra bags (pip install ratt-opt[bags])", path.name) from None
    store = get_typestore(Stores[release])
    for name, text in DEFINITIONS.items():
        store.register(get_types_from_msg(text, name))
    return store


def _bag_messages(path: Path, topics: Collection[str]) -> Iterator[tuple[str, str, Any]]:
    """Topic, type and message of a bag with its metadata."""
    store = _store(path)
    from rosbags.highlevel import AnyReader, AnyReaderError

    try:
        with AnyReader([path], default_typestore=store) as reader:
            chosen = [one for one in reader.connections if one.topic in topics]
            _check_topics(path, topics, reader.topics)
            for connection, _, raw in reader.messages(connections=chosen):
                yield connection.topic, connection.msgtype, reader.deserialize(raw, connection.msgtype)
    except (AnyReaderError, OSError) as error:
        raise FileFormatError(str(path), "must be a ROS bag", error) from None


def _mcap_messages(path: Path, topics: Collection[str]) -> Iterator[tuple[str, str, Any]]:
    """Topic, type and message of an MCAP file that stands alone, its types as its own schemas define them."""
    stores = {"cdr": _store(path), "ros1": _store(path, "ROS1_NOETIC")}
    from mcap.exceptions import McapError
    from mcap.reader import make_reader
    from rosbags.typesys import TypesysError, get_types_from_msg

    known: set[tuple[str, str]] = set()
    try:
        with path.open("rb") as stream:
            reader = make_reader(stream)
            summary = reader.get_summary()
            _check_topics(path, topics, {one.topic for one in summary.channels.values()} if summary else topics)
            for schema, channel, message in reader.iter_messages(topics=list(topics)):
                coding = channel.message_encoding
                if schema is None or coding not in stores:
                    raise FileFormatError(f"{path}: {channel.topic}", "must have messages of ROS 1 or 2", coding)
                name = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/")
                if (coding, name) not in known and name not in stores[coding].types:
                    stores[coding].register(get_types_from_msg(schema.data.decode(), name))
                known.add((coding, name))
                decode = getattr(stores[coding], f"deserialize_{coding}")
                yield channel.topic, name, decode(message.data, name)
    except (McapError, TypesysError, OSError, UnicodeDecodeError) as error:
        raise FileFormatError(str(path), "must be a ROS bag", error or type(error).__name__) from None


def _check_topics(path: Path, topics: Collection[str], there: Collection[str]) -> None:
    """FileFormatError : a topic is missing."""
    for missing in sorted(set(topics) - set(there)):
        raise FileFormatError(str(path), f"must have the topic {missing}", sorted(there))


def _told(path: Path, topic: str, kind: str, message: Any) -> Iterator[PoseMessage | Detection]:
    """Yield the poses or detections of one message."""
    time = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec if hasattr(message, "header") else 0.0
    if kind.endswith(("/Odometry", "/PoseWithCovarianceStamped")):
        yield PoseMessage(topic, time, _pose(message.pose.pose), _pose_covariance(message.pose.covariance))
    elif kind.endswith("/PoseStamped"):
        yield PoseMessage(topic, time, _pose(message.pose), np.zeros((4, 4)))
    elif kind.endswith("/Detection3DArray"):
        for one in message.detections:
            best = max(one.results, key=_score, default=None)
            centre = one.bbox.center.position if best is None else best.pose.pose.position
            spread = np.zeros((3, 3)) if best is None else np.reshape(best.pose.covariance, (6, 6))[:3, :3]
            name = str(one.id) if getattr(one, "id", "") else ("" if best is None else _class_of(best))
            yield Detection(topic, time, name, _vector(centre), None, spread)
    elif kind.endswith(("/ObjectWithCovarianceArray", "/ObjectWithCovariance")):
        for one in getattr(message, "objects", [message]):
            spread = np.reshape(one.pose.covariance, (6, 6))[:3, :3]
            velocity = _vector(one.twist.twist.linear)
            yield Detection(topic, time, str(one.id), _vector(one.pose.pose.position), velocity, spread)
    else:
        rule = "must be poses (Odometry, PoseStamped, PoseWithCovarianceStamped) or detections (Detection3DArray, "
        raise FileFormatError(f"{path}: {topic}", rule + "ObjectWithCovariance)", kind)


def _score(result: Any) -> float:
    return float(getattr(result, "hypothesis", result).score)


def _class_of(result: Any) -> str:
    """The class of a hypothesis; of ROS 1 a number on the result itself."""
    return str(result.hypothesis.class_id if hasattr(result, "hypothesis") else result.id)


def _vector(v: Any) -> FloatArray:
    return np.array([v.x, v.y, v.z], dtype=np.float64)


def _pose(pose: Any) -> FloatArray:
    q = pose.orientation
    heading = np.arctan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    return np.array([pose.position.x, pose.position.y, heading, pose.position.z], dtype=np.float64)


def _pose_covariance(flat: Any) -> FloatArray:
    """(4, 4) of x, y, heading, height from ROS's (36,) of x, y, z and rotations about x, y, z."""
    order = [0, 1, 5, 2]
    matrix = np.reshape(flat, (6, 6))[np.ix_(order, order)]
    return np.asarray((matrix + matrix.T) / 2, dtype=np.float64)
