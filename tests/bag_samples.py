"""Bags of ROS 1 and ROS 2, written with `rosbags`: the room of log_samples, and other stories."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
from log_samples import ODOMETRY, TIMES
from rosbags import rosbag1, rosbag2
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORES = {1: get_typestore(Stores.ROS1_NOETIC), 2: get_typestore(Stores.ROS2_HUMBLE)}
STORES[1].register(
    get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
)
RANGES = (1.5, 2.0, 2.5, np.inf, 3.0)
LEVEL = (0.0, 0.0, 0.0)
#: Name of a kind, and the file in it that holds the messages.
KINDS = {"ros1": "it.bag", "db3": "it/it.db3", "mcap": "it/it.mcap"}


class Messages:
    """Messages of one generation of ROS, each with its type."""

    def __init__(self, version: int) -> None:
        self.version, self.store = version, STORES[version]

    def make(self, kind: str, *fields):
        return self.store.types[kind](*fields)

    def header(self, time, frame):
        sec = int(np.floor(time))
        stamp = self.make("builtin_interfaces/msg/Time", sec, round((time - sec) * 1e9))
        return self.make("std_msgs/msg/Header", *([0] * (self.version == 1)), stamp, frame)

    def scan(self, time, ranges=RANGES, frame="laser", first=-np.pi / 2, step=np.pi / 4, **other):
        given = {"least": 0.1, "most": 30.0, "strength": (), "apart": 0.001} | other
        kept = np.array(ranges, np.float32), np.array(given["strength"], np.float32)
        angles = first, first + step * (len(ranges) - 1), step
        limits = given["least"], given["most"]
        made = self.make("sensor_msgs/msg/LaserScan", self.header(time, frame), *angles,
                         given["apart"], 0.1, *limits, *kept)  # fmt: skip
        return "sensor_msgs/msg/LaserScan", made

    def turn(self, roll, pitch, yaw):
        (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a / 2), np.sin(a / 2)) for a in (roll, pitch, yaw))
        return self.make(
            "geometry_msgs/msg/Quaternion",
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        )

    def odometry(self, time, pose, frame="odom", child="base_link"):
        x, y, heading = pose
        zero = self.make("geometry_msgs/msg/Vector3", *LEVEL)
        where = self.make("geometry_msgs/msg/Point", x, y, 0.0), self.turn(0.0, 0.0, heading)
        placed = self.make("geometry_msgs/msg/Pose", *where)
        speed = self.make("geometry_msgs/msg/Twist", zero, zero)
        placed = self.make("geometry_msgs/msg/PoseWithCovariance", placed, np.zeros(36))
        speed = self.make("geometry_msgs/msg/TwistWithCovariance", speed, np.zeros(36))
        made = self.make("nav_msgs/msg/Odometry", self.header(time, frame), child, placed, speed)
        return "nav_msgs/msg/Odometry", made

    def frames(self, time, *links):
        """Links are parent, child, (x, y, z), (roll, pitch, yaw)."""
        made = []
        for parent, child, place, turn in links:
            pose = self.make("geometry_msgs/msg/Vector3", *place), self.turn(*turn)
            pose = self.make("geometry_msgs/msg/Transform", *pose)
            stamped = self.header(time, parent), child, pose
            made.append(self.make("geometry_msgs/msg/TransformStamped", *stamped))
        return "tf2_msgs/msg/TFMessage", self.make("tf2_msgs/msg/TFMessage", made)


LASER = ("base_link", "laser", (0.3, 0.1, 0.5), LEVEL)


def standard(m):
    """The room of log_samples: topic, time of recording, type and message."""
    yield "/tf_static", TIMES[0] - 1, *m.frames(TIMES[0] - 1, LASER)
    for time, pose in zip(TIMES, ODOMETRY, strict=True):
        yield "/odom", time + 0.01, *m.odometry(time, pose)
        yield "/scan", time + 0.02, *m.scan(time)


def write(folder: Path, kind: str, story=standard, **options) -> Path:
    """A bag of a kind in a folder; its messages are what `story` yields."""
    m = Messages(1 if kind == "ros1" else 2)
    path = folder / ("it.bag" if kind == "ros1" else "it")
    with _writer(path, kind, options) as writer:
        connections: dict[str, SimpleNamespace] = {}
        for topic, time, name, message in story(m):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=m.store)
            serialize = m.store.serialize_ros1 if m.version == 1 else m.store.serialize_cdr
            data = bytes(serialize(message, name))
            writer.write(connections[topic], round(time * 1e9), data)
    return path


def _writer(path, kind, options):
    if kind == "ros1":
        writer = rosbag1.Writer(path)
        if "compression" in options:
            writer.set_compression(getattr(writer.CompressionFormat, options["compression"]))
        return writer
    plugin = {"db3": StoragePlugin.SQLITE3, "mcap": StoragePlugin.MCAP}[kind]
    writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
    if "compression" in options:
        mode = getattr(CompressionMode, options["compression"])
        writer.set_compression(mode, CompressionFormat.ZSTD)
    return writer
