"""Bags of ROS 1 and ROS 2: scans, odometry, and where the laser sits.

    sensor_msgs/LaserScan     the scans of one topic, time of the header; messages that are parts of
                              one turn are joined; of a MultiEchoLaserScan the first echo counts
    nav_msgs/Odometry         of one topic, interpolated at the times of the scans, heading along
                              the shorter way; a scan before the first and after the last has none
    tf2_msgs/TFMessage        /tf_static and /tf: the laser's place on the robot; and the odometry,
                              how the robot's frame moves in the one above, where no topic has any

Topics are those of one robot: the odometry is the one whose frame carries the laser, by tf or by
its name. A laser that hangs upside down is honoured: its beams turn the other way. One that is
tilted, or that moves on the robot, is refused. The robot's frame is the one that the odometry
names. A topic with scans of several lasers is refused.

Ranges from `range_max` on and `inf` met nothing; those below `range_min`, `-inf` and NaN are
errors. Angles are `angle_min` plus multiples of `angle_increment`, which may be negative. Beam k is
measured k times `time_increment` after the first, or in the other order: drivers state either with
a positive increment, and `Log.order_known` says that nobody knows; 0 is no time. A message
without a time in its header has that of the recorder. Dropped are intensities, speeds and
covariances.

Assumed: without a transform the laser sits at the robot's centre.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from segmap import arrays
from segmap.angles import wrap
from segmap.arrays import Array, checked
from segmap.display import plural
from segmap.poses import interpolate
from segmap.progress import announce
from segmap.readers.lines import LATEST_TIME_S, LogError, OnError, Reading, UnknownFormat, stem
from segmap.readers.mounting import in_space, level, planar
from segmap.readers.packed import log_file
from segmap.readers.raw_scans import Track, known_truth, or_none, place_of
from segmap.scans import LaserScan, Log

from ._files import PART, kind_of, parts_of, recordings
from ._frames import Frames
from ._lasers import (
    SCAN_TYPES,
    ScanMessage,
    beams_of,
    how_to_read,
    named_topic,
    scan_topics,
    time_between,
    topics_text,
    turn_of_parts,
    turns,
    warn_of_bag,
)
from ._open import FRAMES, Bag, open_bag

ODOMETRY_TYPES = ("nav_msgs/msg/Odometry",)
#: Poses that are odometry or truth where they are named.
POSE_TYPES = (
    *ODOMETRY_TYPES,
    *(f"geometry_msgs/msg/{kind}Stamped" for kind in ("Pose", "PoseWithCovariance", "Transform")),
)
STATIC = "tf_static"


@checked
def read_bag(
    path: str | Path | Sequence[str | Path],
    *,
    scan: str | Sequence[str] | None = None,
    odometry: str | None = None,
    truth: str | None = None,
    on_error: OnError = "raise",
) -> Log:
    """Read a bag of ROS 1 or ROS 2, with the package `rosbags` (`pip install rosbags`).

    Scans are those of a topic of `sensor_msgs/LaserScan` or MultiEchoLaserScan. Odometry is that of
    a topic of `nav_msgs/Odometry`, interpolated at the times of the scans, or else how the robot's
    frame moves in the one above it; scans before its beginning and after its end have none. Where
    the laser sits, upside down or not, is what `/tf_static` and `/tf` say. Ranges from `range_max`
    on met nothing, those below `range_min` are errors. Beams have their times, whose order
    `alignment.deskew` finds.

    Parameters
    ----------
    path : str, Path or list of them
        A `.bag`; a folder with a metadata.yaml, or with one bag alone; a `.db3` or an `.mcap`; or
        the parts of one: `["it_0.bag", "it_1.bag"]`.
    scan : str, list of str or None
        A topic, or several: then their scans make one log, each with its laser's place on the
        robot. None takes `/scan`, or else the topic with most messages, and warns of others.
    odometry, truth : str or None
        A topic of Odometry, PoseStamped, PoseWithCovarianceStamped or TransformStamped. None takes
        the Odometry of the robot that carries the laser, and no truth.
    on_error : "raise" or "skip"
        As in `read`: a message that is damaged is left out, of a bag that is cut off what is whole
        is read.

    Raises
    ------
    LogError
        What is no bag, or a damaged one; no such topic; a laser that is tilted, or moves on the
        robot; several lasers in one topic, or odometries of which no tf tells whose they are;
        where `rosbags` is missing.

    Warns
    -----
    UserWarning
        Where there are several topics, nothing tells where the laser sits, or no scan lies within
        the time of the odometry.

    Examples
    --------
    >>> log = read_bag("office.bag", scan=["/front/scan", "/rear/scan"])  # doctest: +SKIP
    """
    scans = [scan] if isinstance(scan, str) else scan
    for name, topics in (("scan", scans), ("odometry", [odometry]), ("truth", [truth])):
        listed = topics is None or isinstance(topics, list | tuple)
        if not listed or not all(isinstance(t, str | None) for t in topics or ()):
            raise ValueError(f"{name} must be the name of a topic, got {arrays.brief(topics)}")
    with ExitStack() as stack:
        paths: Sequence[Any] = path if isinstance(path, list | tuple) else [path]
        places = [stack.enter_context(log_file(each, folders=True)) for each in paths]
        for place in places:
            if not kind_of(place):
                expected = "expected a .bag, .mcap, .db3 or a folder"
                raise UnknownFormat(place, f"is no bag of ROS, {expected}")
        parts, name = parts_of(places[0]), stem(places[0])
        if len(places) > 1:
            groups = recordings(places)
            parts, name = groups[0], PART.sub(r"\1", places[0].stem)
            if len(groups) > 1:
                names = ", ".join(place.name for place in places)
                reason = f"{names} are no parts of one bag, expected it_0.bag, it_1.bag and so on"
                raise LogError(places[0], reason)
        return _read_parts(parts, name, on_error, scans, odometry, truth)


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """A bag: a file, or a folder."""
    return _read_parts(parts_of(path), name, on_error)


def _read_parts(
    parts: Sequence[Path],
    name: str,
    on_error: str,
    scans: Sequence[str] | None = None,
    odometry: str | None = None,
    truth: str | None = None,
) -> Log:
    """Scans and odometry, then as much of the transforms as is needed."""
    with open_bag(parts) as bag:
        recording = _Recording(bag, Reading(parts[0], on_error))
        lasers = scan_topics(bag, scans)
        if not lasers:
            raise LogError(bag.path, f"holds no sensor_msgs/LaserScan, but {topics_text(bag)}")
        named = {
            word: named_topic(bag, POSE_TYPES, topic, word)
            for word, topic in (("odometry", odometry), ("truth", truth))
            if topic is not None
        }
        wheels = {named["odometry"]} if odometry else bag.topics(*ODOMETRY_TYPES)
        recording.take_all({*lasers, *named.values(), *wheels, *recording.frames_in(static=True)})
        if not recording.messages:
            reason = f"holds no scan in {', '.join(lasers)}{recording.reading.why()}"
            raise LogError(bag.path, reason)
        recording.choose(named.get("odometry"), {*wheels} - {named.get("truth")})
        return recording.log(name, named.get("truth"))


class Way(NamedTuple):
    """Poses of one topic, and the frame that moved."""

    track: Track
    child: str


class _Recording:
    """What the messages of one bag said so far."""

    def __init__(self, bag: Bag, reading: Reading) -> None:
        self.bag, self.path, self.reading = bag, bag.path, reading
        self.messages: list[ScanMessage] = []
        self.ways: dict[str, Way] = {}
        self.frames, self.odometry = Frames(), Way(Track(), "")
        self.assumed: list[str] = []

    def take_all(self, topics: set[str], *, ordered: bool = True) -> None:
        """Take in each message of these topics; a damaged one is told or counted.

        Where they are not `ordered`, scans were taken in before.
        """
        kinds = {c.topic: c.msgtype for c in self.bag.connections if c.topic in topics}
        counts = Counter[str]()
        count = max(sum(self.bag.topics(*kinds.values()).get(topic, 0) for topic in kinds), 1)
        for topic, received_ns, data in self.bag.messages(kinds):
            announce(counts.total() / count, f"reading message {counts[topic] + 1} of {topic}")
            counts[topic] += 1
            try:
                message = self.bag.decode(data, kinds[topic])
                with np.errstate(all="ignore"):
                    self._take(topic, kinds[topic], message, received_ns / 1e9, ordered)
            except ValueError as fault:
                reason = f"{topic}, message {counts[topic]}: {fault}"
            else:
                continue
            self.reading.leave_out(LogError(self.path, reason))

    def _take(self, topic: str, kind: str, message: Any, received: float, ordered: bool) -> None:
        number, after = len(self.messages), len(self.messages) if ordered else None
        if kind in FRAMES:
            for transform in message.transforms:
                self.frames.take(transform, _header_time(transform.header, received), after)
            return
        when = _header_time(message.header, received)
        if kind in SCAN_TYPES:
            laser, beams = message.header.frame_id, beams_of(message)
            self.messages.append(ScanMessage(number, topic, laser, when, beams))
            return
        child = str(getattr(message, "child_frame_id", ""))
        way = self.ways.setdefault(topic, Way(Track(), child))
        way.track.add(when, _planar_pose(message), after)

    def frames_in(self, *, static: bool) -> set[str]:
        """Topics of transforms: of those that stand still, or of the others."""
        return {t for t in self.bag.topics(*FRAMES) if t.endswith(STATIC) == static}

    # ----------------------------------------------------------------- odometry
    def choose(self, named: str | None, wheels: set[str]) -> None:
        """Take the odometry of the robot that carries the laser, or else what frames tell."""
        laser = self.messages[0].frame
        ways = {t: way for t, way in self.ways.items() if t in wheels and way.track.times}
        if len(ways) == 1:
            (self.odometry,) = ways.values()
        if not self.odometry.track.times or self.place(laser) is None:
            self.take_all(self.frames_in(static=False), ordered=False)
        if named:
            return
        carried = {topic: self.frames.carries(way.child, laser) for topic, way in ways.items()}
        ranked = sorted(ways, key=lambda topic: (-len(ways[topic].track.times), topic))
        mine = [topic for topic in ranked if carried[topic]] or [t for t in ways if len(ways) == 1]
        counts = ", ".join(f"{topic} ({len(ways[topic].track.times)})" for topic in ranked)
        if len(ranked) > 1 and not mine:
            how = how_to_read("odometry", ranked[0])
            raise LogError(self.path, f"{counts}: no tf tells which carries {laser}, {how}")
        if mine and carried[mine[0]] is not False:
            self.odometry = ways[mine[0]]
            if len(ranked) > 1:
                other = next(topic for topic in ranked if topic != mine[0])
                how = how_to_read("odometry", other)
                warn_of_bag(f"{self.path}: {counts}: {mine[0]} is read, {how}")
            return
        if mine:
            how = how_to_read("odometry", mine[0])
            self.assumed.append(f"{mine[0]} is of another robot than {laser} by tf, {how}")
        base, above, track = self.frames.drive(laser)
        self.odometry = Way(track, base)
        if base and not above.split("/")[-1].startswith("odom"):
            self.assumed.append(f"the odometry is how {base} moves in {above}")

    def place(self, laser: str) -> Array | None:
        """The laser's pose on the robot, in space."""
        try:
            return self.frames.place(laser, self.odometry.child or self.frames.base_of(laser))
        except ValueError as fault:
            raise LogError(self.path, str(fault)) from fault

    # ---------------------------------------------------------------------- log
    def log(self, name: str, truth: str | None) -> Log:
        """All scans with their odometry."""
        rows, ordered = [], True
        topics = dict.fromkeys(message.topic for message in self.messages)
        for topic in topics:
            mine = [message for message in self.messages if message.topic == topic]
            lasers = ", ".join(dict.fromkeys(message.frame for message in mine))
            if ", " in lasers:
                reason = f"{topic} holds the scans of several lasers, {lasers}: write one of them"
                raise LogError(self.path, f"{reason} to a topic of its own, and name it")
            place, mirrored = self._mount(mine[0].frame, alone=len(topics) == 1)
            groups = turns(mine)
            usual = time_between(groups)
            if usual:
                count = f"{plural(len(mine), 'message')} of {topic}"
                self.assumed.append(f"{count} are parts of {plural(len(groups), 'turn')}")
            for parts in groups:
                beams = turn_of_parts(parts, usual)
                ordered &= bool(usual) or beams.delays is None
                rows.append((parts[0].number, parts[0].time, beams, place, mirrored))
        rows.sort(key=lambda row: row[0])
        firsts, track = [row[0] for row in rows], self.odometry.track
        track.after = np.searchsorted(firsts, track.after).tolist()
        times, poses, causes = track.synchronise([row[1] for row in rows])
        if track.times and np.isnan(poses).all():
            warn_of_bag(f"{self.path}: no scan lies within the time of the odometry")
        poses[:, 2] = wrap(poses[:, 2])
        scans = []
        for (*_, beams, place, mirrored), time, pose in zip(rows, times, poses, strict=True):
            angles = -beams.angles if mirrored else beams.angles
            sensor = beams.max_range, place, None, beams.delays
            scans.append(LaserScan(beams.ranges, angles, time, or_none(pose), *sensor))
        right = None
        if truth:
            right = known_truth(interpolate(*self.ways[truth].track.in_order(), times))
        skipped = self.reading.skipped
        return Log(name, scans, right, skipped, ordered, causes, self.assumed)

    def _mount(self, laser: str, *, alone: bool) -> tuple[Array, bool]:
        """Where a laser sits on the robot, and whether it hangs upside down."""
        space = self.place(laser)
        base = self.odometry.child or "the robot"
        if space is None and not alone:
            raise LogError(self.path, f"no tf tells where {laser} sits: read its topic alone")
        if space is None:
            words = f"no tf tells where {laser} sits on {base}; it is taken to be at its centre"
            warn_of_bag(f"{self.path}: {words}")
            space = np.eye(4)
            self.assumed.append(place_of(np.zeros(3)))
        try:
            return planar(space)
        except ValueError as fault:
            raise LogError(self.path, str(fault)) from fault


def _planar_pose(message: Any) -> Array:
    """x, y, heading of a message with a pose, however deep it lies in it."""
    if hasattr(message, "transform"):
        place, turn = message.transform.translation, message.transform.rotation
    else:
        pose = message.pose
        while hasattr(pose, "pose"):
            pose = pose.pose
        place, turn = pose.position, pose.orientation
    return level(in_space((place.x, place.y, place.z), (turn.w, turn.x, turn.y, turn.z)))


def _header_time(header: Any, received: float) -> float:
    """Seconds of a header, or those of the recorder where it has none."""
    stamp = header.stamp
    time = stamp.sec + stamp.nanosec / 1e9 or received
    if not abs(time) <= LATEST_TIME_S:
        raise ValueError(f"expected a time, got {time:.6g} s")
    return time
