"""Bags of ROS 1 and ROS 2: scans, odometry, and where the laser sits.

    sensor_msgs/LaserScan     the scans of one topic, time of the header
    nav_msgs/Odometry         of one topic, interpolated at the times of the scans, heading along
                              the shorter way; a scan before the first and after the last has none
    tf2_msgs/TFMessage        /tf_static and /tf: the laser's place on the robot; and the odometry,
                              from the frame odom to the one below it, where no topic has any

A laser that hangs upside down is honoured: its beams turn the other way. One that is tilted, or
that moves on the robot, is refused. The robot's frame is the one that the odometry names.

Ranges from `range_max` on and `inf` met nothing; those below `range_min`, `-inf` and NaN are
errors. Angles are `angle_min` plus multiples of `angle_increment`, which may be negative. Beam k is
measured k times `time_increment` after the first, or in the other order: drivers state either with
a positive increment, and `Log.order_known` says that nobody knows; 0 is no time. Odometry that
comes more often than scans, or at other times, is the `track`: it may have another clock. A
message without a time in its header has that of the recorder. Dropped are intensities, speeds and
covariances.

Assumed: without a transform the laser sits at the robot's centre.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ... import arrays
from ...angles import wrap
from ...arrays import Array, checked, unit_checks
from ...files import shown
from ...progress import announce
from ...scans import LaserScan, Log
from .._lines import LATEST_TIME_S, LogError, OnError, Reading, UnknownFormat, stem
from .._mounting import flat, in_space, level
from .._raw_scans import Track, beams_of_message, known, place_of
from ..packed import log_file
from ._files import FRAMES, Bag, kind_of, opened
from ._frames import Frames

SCAN_TYPE = "sensor_msgs/msg/LaserScan"
ODOMETRY_TYPE = "nav_msgs/msg/Odometry"
STATIC = "tf_static"


@checked
def read_bag(
    path: str | Path,
    *,
    scan: str | None = None,
    odometry: str | None = None,
    on_error: OnError = "raise",
) -> Log:
    """Read a bag of ROS 1 or ROS 2, with the package `rosbags` (`pip install rosbags`).

    Scans are those of a topic of `sensor_msgs/LaserScan`. Odometry is that of a topic of
    `nav_msgs/Odometry`, interpolated at the times of the scans, or else the way of the frame below
    `odom`; scans before its beginning and after its end have none. Where the laser sits, upside
    down or not, is what `/tf_static` and `/tf` say. Ranges from `range_max` on met nothing, those
    below `range_min` are errors. Beams have their times, whose order `alignment.deskew` finds.

    Parameters
    ----------
    path : str or Path
        A `.bag`; a folder with a metadata.yaml, or with one bag alone; a `.db3` or an `.mcap`.
    scan, odometry : str or None
        Names of topics; None takes the one with most messages, and warns where there are others.
    on_error : "raise" or "skip"
        As in `read`: a message that is damaged is left out, a bag that is broken ends there.

    Raises
    ------
    LogError
        What is no bag, or a damaged one; no such topic; a laser that is tilted, or moves on the
        robot; more than 256 MB and 50 times the size unpacked; where `rosbags` is missing.

    Warns
    -----
    UserWarning
        Where there are several topics, nothing tells where the laser sits, or no scan lies within
        the time of the odometry.

    Examples
    --------
    >>> log = read_bag("office.bag", scan="/front/scan")  # doctest: +SKIP
    """
    for name, topic in (("scan", scan), ("odometry", odometry)):
        if not isinstance(topic, str | None):
            raise ValueError(f"{name} must be the name of a topic, got {arrays.brief(topic)}")
    with log_file(path, folders=True) as place:
        if not kind_of(place):
            raise UnknownFormat(place, "is no bag of ROS, expected a .bag, .mcap, .db3 or a folder")
        return read(place, stem(place), on_error, scan, odometry)


def read(
    path: Path,
    name: str,
    on_error: str = "raise",
    scan: str | None = None,
    odometry: str | None = None,
) -> Log:
    """Scans and odometry, then as much of the transforms as is needed; no truth."""
    with opened(path) as bag:
        said = _Recording(bag, on_error)
        scan = _chosen_topic(bag, SCAN_TYPE, scan, "scan")
        if scan is None:
            raise LogError(bag.path, f"holds no sensor_msgs/LaserScan, but {_topics_text(bag)}")
        odometry = _chosen_topic(bag, ODOMETRY_TYPE, odometry, "odometry")
        wheels = {odometry: ODOMETRY_TYPE} if odometry else said.frames_in(static=False)
        said.each({scan: SCAN_TYPE, **wheels, **said.frames_in(static=True)})
        if not said.scans:
            raise LogError(bag.path, f"holds no scan in {scan}{said.why()}")
        said.know_frames(odometry is None)
        return said.log(name)


class _Recording(Reading):
    """What the messages of one bag said so far."""

    def __init__(self, bag: Bag, on_error: str) -> None:
        super().__init__(bag.path, on_error)
        self.bag, self.track, self.frames = bag, Track(), Frames()
        self.scans: list[tuple[float, LaserScan]] = []
        self.laser, self.base = "", ""

    def each(self, kinds: Mapping[str, str]) -> None:
        """Take in each message of topics of these kinds; a damaged one is told or counted."""
        takes: dict[str, Callable[[Any, float], None]] = {
            SCAN_TYPE: self.take_scan,
            ODOMETRY_TYPE: self.take_odometry,
        }
        counts = Counter[str]()
        count = max(sum(self.bag.topics(kind).get(topic, 0) for topic, kind in kinds.items()), 1)
        for topic, received, data in self._to_the_break(self.bag.messages(kinds)):
            announce(counts.total() / count, f"reading message {counts[topic] + 1} of {topic}")
            counts[topic] += 1
            try:
                message = self.bag.decoded(data, kinds[topic])
                with np.errstate(all="ignore"):
                    takes.get(kinds[topic], self.take_frames)(message, received / 1e9)
            except ValueError as fault:
                reason = f"{topic}, message {counts[topic]}: {fault}"
            else:
                continue
            self.damaged(LogError(self.path, reason))

    def _to_the_break(self, found: Iterator[Any]) -> Iterator[Any]:
        try:
            yield from found
        except LogError as fault:
            self.damaged(fault)

    def take_scan(self, message: Any, received: float) -> None:
        laser = message.header.frame_id
        if self.scans and laser != self.laser:
            raise ValueError(f"expected a scan of {self.laser}, got one of {laser}")
        self.scans.append((_header_time(message.header, received), beams_of_message(message)))
        self.laser = laser

    def take_odometry(self, message: Any, received: float) -> None:
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        pose = in_space((place.x, place.y, place.z), (turn.w, turn.x, turn.y, turn.z))
        self.track.add(_header_time(message.header, received), level(pose), len(self.scans))
        self.base = self.base or message.child_frame_id

    def take_frames(self, message: Any, received: float) -> None:
        for transform in message.transforms:
            self.frames.take(transform, _header_time(transform.header, received), len(self.scans))

    def frames_in(self, *, static: bool) -> dict[str, str]:
        """Topics of transforms and their kinds: of those that stand still, or of the others."""
        found = {topic: kind for kind in FRAMES for topic in self.bag.topics(kind)}
        return {topic: k for topic, k in found.items() if topic.endswith(STATIC) == static}

    def know_frames(self, moved: bool) -> None:
        """What moved is the odometry, or is read only where something is still not known."""
        if moved:
            self.base, self.track = self.frames.driven()
        elif not self.base or self.place() is None:
            self.each(self.frames_in(static=False))

    def place(self) -> Array | None:
        """The laser's pose on the robot, in space."""
        try:
            return self.frames.place(self.laser, self.base or self.frames.base_of(self.laser))
        except ValueError as fault:
            raise LogError(self.path, str(fault)) from fault

    def log(self, name: str) -> Log:
        assumed: list[str] = []
        if (space := self.place()) is None:
            _warn(
                f"{self.path}: no tf tells where {self.laser} sits on {self.base}; "
                "it is taken to be at its centre"
            )
            space, assumed = np.eye(4), [place_of(np.zeros(3))]
        try:
            place, mirrored = flat(space)
        except ValueError as fault:
            raise LogError(self.path, str(fault)) from fault
        met = self.track.met([time for time, _ in self.scans])
        poses = met.poses
        if self.track.times and np.isnan(poses).all():
            _warn(f"{self.path}: no scan lies within the time of the odometry")
        poses[:, 2] = wrap(poses[:, 2])
        scans = []
        for (_, beams), time, pose in zip(self.scans, met.times, poses, strict=True):
            angles = -beams.angles if mirrored else beams.angles
            sensor = beams.max_range, place, None, beams.delays
            scans.append(LaserScan(beams.ranges, angles, time, known(pose), *sensor))
        is_whole = len(met.track) <= len(scans) and np.isfinite(poses).all()
        track = None if is_whole or not len(met.track) else met.track
        ordered = all(scan.delays is None for scan in scans)
        return Log(name, scans, None, self.skipped, track, ordered, met.causes, assumed)


def _header_time(header: Any, received: float) -> float:
    """Seconds of a header, or those of the recorder where it has none."""
    stamp = header.stamp
    time = stamp.sec + stamp.nanosec / 1e9 or received
    if not abs(time) <= LATEST_TIME_S:
        raise ValueError(f"expected a time, got {time:.6g} s")
    return time


def _chosen_topic(bag: Bag, kind: str, named: str | None, argument: str) -> str | None:
    """The topic that is named, or else the one with most messages; None where there is none."""
    topics = {topic: count for topic, count in bag.topics(kind).items() if count > 0}
    if named is not None:
        if (found := next((t for t in topics if t.strip("/") == named.strip("/")), None)) is None:
            reason = f"{argument} must be a topic of {kind.replace('/msg', '')} in the bag"
            raise LogError(bag.path, f"{reason}, got {named!r}, but {_topics_text(bag)}")
        return found
    ranked = sorted(topics, key=lambda topic: (-topics[topic], topic))
    if len(ranked) > 1:
        counts = ", ".join(f"{topic} ({topics[topic]})" for topic in ranked)
        _warn(f"{bag.path}: {counts}: {ranked[0]} is read, "
              f"readers.read_bag(path, {argument}={ranked[1]!r}) reads another")  # fmt: skip
    return ranked[0] if ranked else None


def _topics_text(bag: Bag) -> str:
    found = dict.fromkeys(f"{c.topic} ({c.msgtype.replace('/msg', '')})" for c in bag.connections)
    return f"the bag holds {', '.join(found)[:1000] or 'nothing'}"


def _warn(text: str) -> None:
    unit_checks.warn(shown(text))
