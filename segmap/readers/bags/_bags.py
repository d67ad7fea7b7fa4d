"""Bags of ROS 1 and ROS 2: scans, odometry, and where the laser sits.

    sensor_msgs/LaserScan     the scans of one topic, time of the header
    nav_msgs/Odometry         of one topic, interpolated at the times of the scans, heading along
                              the shorter way; a scan before the first and after the last has none
    tf2_msgs/TFMessage        /tf_static and /tf: the laser's place on the robot; and the odometry,
                              from the frame odom to the one below it, where no topic has any

A laser that hangs upside down is honoured: its beams turn the other way. One that is tilted, or
that moves on the robot, is refused. The robot's frame is the one that the odometry names.

Ranges from `range_max` on and `inf` met nothing; those below `range_min`, `-inf` and NaN are
errors. Angles are `angle_min` plus multiples of `angle_increment`, which may be negative. Dropped
are the time of each beam (a scan is taken to be measured at once), intensities, speeds and
covariances. A message without a time in its header has that of the recorder.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...angles import wrap
from ...arrays import Array
from ...scans import NOTHING_SKIPPED, LaserScan, Log, Skipped
from .._lines import LATEST, LogError
from .._mounting import flat, in_space, level
from .._raw_scans import Track, clean
from ._files import FRAMES, Bag, kind_of, opened
from ._frames import Frames

SCAN = "sensor_msgs/msg/LaserScan"
ODOMETRY = "nav_msgs/msg/Odometry"
STATIC = "tf_static"
#: What a bag that is read must hold, for an error.
WANTED = "sensor_msgs/LaserScan"


def claims(path: Path) -> bool:
    """Whether a file or a folder is a bag."""
    return kind_of(path) is not None


def read(
    path: Path,
    name: str,
    on_error: str = "raise",
    scan: str | None = None,
    odometry: str | None = None,
) -> Log:
    """Read a bag; `odometry` of the log is `(k, 3)`, metres and radians, without truth."""
    with opened(path) as bag:
        return _Recording(bag, on_error).read(name, scan, odometry)


class _Recording:
    """What the messages of one bag said so far."""

    def __init__(self, bag: Bag, on_error: str) -> None:
        self.bag, self.on_error, self.skipped = bag, on_error, NOTHING_SKIPPED
        self.scans: list[tuple[float, Any]] = []
        self.laser, self.base = "", ""
        self.track, self.frames = Track(), Frames()

    def read(self, name: str, scan: str | None, odometry: str | None) -> Log:
        """Scans, then odometry, then as much of the transforms as is needed."""
        scan = _chosen(self.bag, SCAN, scan, "scan")
        if scan is None:
            raise LogError(self.bag.path, f"holds no {WANTED}, but {_listed(self.bag)}")
        odometry = _chosen(self.bag, ODOMETRY, odometry, "odometry")
        self._each(SCAN, [scan], self._take_scan)
        self._each(ODOMETRY, [odometry] if odometry else [], self._take_odometry)
        if not self.scans:
            raise LogError(self.bag.path, f"holds no scan in {scan}{self._why()}")
        self._take_transforms(odometry is None)
        return self._log(name)

    # ------------------------------------------------------------------------ messages
    def _each(self, kind: str, topics: list[str], take: Callable[[Any, float], None]) -> None:
        """Take in each message of some topics; a damaged one is told or counted."""
        found = self.bag.messages(topics, kind)
        for number, (topic, received, data) in enumerate(self._to_the_break(found)):
            try:
                message = self.bag.decoded(data, kind)
                with np.errstate(all="ignore"):
                    take(message, received / 1e9)
            except ValueError as fault:
                reason = f"{topic}, message {number + 1}: {fault}"
            else:
                continue
            self._damaged(LogError(self.bag.path, reason))

    def _to_the_break(self, found: Iterator[Any]) -> Iterator[Any]:
        try:
            yield from found
        except LogError as fault:
            self._damaged(fault)

    def _damaged(self, fault: LogError) -> None:
        if self.on_error == "raise":
            raise fault
        self.skipped = Skipped(self.skipped.lines + 1, self.skipped.reason or str(fault))

    def _why(self) -> str:
        return f"; {self.skipped.lines} left out: {self.skipped.reason}" if self.skipped else ""

    def _take_scan(self, message: Any, received: float) -> None:
        laser = message.header.frame_id
        if self.scans and laser != self.laser:
            raise ValueError(f"expected a scan of {self.laser}, got one of {laser}")
        self.scans.append((_time(message.header, received), _beams(message)))
        self.laser = laser

    def _take_odometry(self, message: Any, received: float) -> None:
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        pose = in_space((place.x, place.y, place.z), (turn.w, turn.x, turn.y, turn.z))
        self.track.add(_time(message.header, received), level(pose))
        self.base = self.base or message.child_frame_id

    def _take_transforms(self, moved: bool) -> None:
        """Read what stands still, and what moves only where something is still not known."""
        for kind in FRAMES:
            topics = self.bag.topics(kind)
            static = [topic for topic in topics if topic.endswith(STATIC)]
            self._each(kind, static, self._take_frames)
            if moved or not self.base or self._place() is None:
                self._each(kind, [t for t in topics if t not in static], self._take_frames)
        if moved:
            self.base, self.track = self.frames.driven()

    def _take_frames(self, message: Any, received: float) -> None:
        for transform in message.transforms:
            self.frames.take(transform, _time(transform.header, received))

    def _place(self) -> Array | None:
        try:
            return self.frames.place(self.laser, self.base or self.frames.base_of(self.laser))
        except ValueError as fault:
            raise LogError(self.bag.path, str(fault)) from fault

    # ----------------------------------------------------------------------------- log
    def _log(self, name: str) -> Log:
        pose, mirrored = self._mounted()
        times = [time for time, _ in self.scans]
        poses = self.track.at(times)
        if self.track.times and np.isnan(poses).all():
            _warn(f"{self.bag.path}: no scan lies within the time of the odometry")
        poses[:, 2] = wrap(poses[:, 2])
        scans = [
            _laser_scan(beams, time, None if np.isnan(odometry).any() else odometry, pose, mirrored)
            for (time, beams), odometry in zip(self.scans, poses, strict=True)
        ]
        return Log(name, scans, None, self.skipped)

    def _mounted(self) -> tuple[Array, bool]:
        """The laser's place in the plane, and whether it hangs upside down."""
        place = self._place()
        if place is None:
            _warn(
                f"{self.bag.path}: no tf tells where {self.laser} sits on {self.base}; "
                "it is taken to be at its centre"
            )
            place = np.eye(4)
        try:
            return flat(place)
        except ValueError as fault:
            raise LogError(self.bag.path, str(fault)) from fault


def _laser_scan(
    beams: LaserScan, time: float, odometry: Array | None, place: Array, mirrored: bool
) -> LaserScan:
    angles = -beams.angles if mirrored else beams.angles
    return LaserScan(beams.ranges, angles, time, odometry, beams.max_range, place)


def _beams(message: Any) -> LaserScan:
    """Ranges and directions of a message, in the frame of the laser."""
    ranges = np.asarray(message.ranges, float)
    first, step = float(message.angle_min), float(message.angle_increment)
    if not len(ranges):
        raise ValueError("expected ranges, got a scan without")
    if not (np.isfinite([first, step]).all() and (step or len(ranges) == 1)):
        raise ValueError(f"expected angles in radians, got {first:.6g} and steps of {step:.6g}")
    least, most = float(message.range_min), float(message.range_max)
    most = most if most > 0 else np.inf
    known = clean(np.where(ranges < least, np.nan, ranges), most)
    return LaserScan(known, first + step * np.arange(len(ranges)), max_range=most)


def _time(header: Any, received: float) -> float:
    """Seconds of a header, or those of the recorder where it has none."""
    stamp = header.stamp
    time = stamp.sec + stamp.nanosec / 1e9 or received
    if not abs(time) <= LATEST:
        raise ValueError(f"expected a time, got {time:.6g} s")
    return time


def _chosen(bag: Bag, kind: str, named: str | None, argument: str) -> str | None:
    """The topic that is named, or else the one with most messages; None where there is none."""
    topics = {topic: count for topic, count in bag.topics(kind).items() if count > 0}
    if named is not None:
        if (found := next((t for t in topics if t.strip("/") == named.strip("/")), None)) is None:
            reason = f"{argument} must be a topic of {kind.replace('/msg', '')} in the bag"
            raise LogError(bag.path, f"{reason}, got {named!r}, but {_listed(bag)}")
        return found
    ranked = sorted(topics, key=lambda topic: (-topics[topic], topic))
    if len(ranked) > 1:
        counts = ", ".join(f"{topic} ({topics[topic]})" for topic in ranked)
        _warn(f"{bag.path}: {counts}: {ranked[0]} is read, "
              f"readers.read_bag(path, {argument}={ranked[1]!r}) reads another")  # fmt: skip
    return ranked[0] if ranked else None


def _listed(bag: Bag) -> str:
    found = sorted({f"{c.topic} ({c.msgtype.replace('/msg', '')})" for c in bag.connections})
    return f"the bag holds {', '.join(found[:20]) or 'nothing'}{' ...' if found[20:] else ''}"


def _warn(text: str) -> None:
    warnings.warn(text, UserWarning, stacklevel=2)
