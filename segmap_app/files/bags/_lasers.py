"""Which topics are read, whose scans one holds, and turns of which each message is a part."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from segmap.arrays import unit_checks
from segmap.files import escape
from segmap.readers.lines import LogError
from segmap.readers.raw_scans import MOST_APART, beams_of_message
from segmap.scans import LaserScan

from ._open import Bag

SCAN_TYPES = ("sensor_msgs/msg/LaserScan", "sensor_msgs/msg/MultiEchoLaserScan")
#: A topic of this name holds the scans as they were measured, not what was made of them.
USUAL_SCAN_TOPIC = "scan"
#: A part begins so many beams beside where the one before ended, at most.
PART_GAP_BEAMS = 1.5
#: From this share of messages on that go on where the one before ended, they are parts of turns.
PARTS_SHARE = 0.4


class ScanMessage(NamedTuple):
    """A message with a scan: which in the bag it is, topic and frame, its time, its beams."""

    number: int
    topic: str
    frame: str
    time: float
    beams: LaserScan

    @property
    def step(self) -> float:
        """Turn from one beam to the next, radians, with its sign."""
        angles = self.beams.angles
        return float(angles[1] - angles[0]) if len(angles) > 1 else 0.0


def beams_of(message: Any) -> LaserScan:
    """The beams of a LaserScan, or of a MultiEchoLaserScan, of which the first echo counts."""
    if len(message.ranges) and hasattr(message.ranges[0], "echoes"):
        echoes = [each.echoes for each in message.ranges]
        message.ranges = np.array([each[0] if len(each) else np.nan for each in echoes], float)
    return beams_of_message(message)


def turns(messages: Sequence[ScanMessage]) -> list[list[ScanMessage]]:
    """Messages of one laser, those that are parts of one turn together.

    They are parts where most go on at the angle at which the one before ended; a turn ends where
    the angle falls back.
    """
    pairs = list(pairwise(messages))
    goes_on = sum(_goes_on(a, b) for a, b in pairs)
    if not pairs or goes_on < PARTS_SHARE * len(pairs):
        return [[each] for each in messages]
    groups = [[messages[0]]]
    for a, b in pairs:
        if _lead(a, b) > 0 and 0 <= b.time - a.time <= MOST_APART:
            groups[-1].append(b)
        else:
            groups.append([b])
    return groups


def turn_of_parts(parts: Sequence[ScanMessage], usual: float) -> LaserScan:
    """The parts of one turn as a scan, each beam with its time; parts are `usual` seconds apart."""
    if len(parts) == 1 and not usual:
        return parts[0].beams
    times = np.array([each.time for each in parts])
    lasts = np.append(np.diff(times), usual)
    delays = [
        time
        - times[0]
        + (np.arange(n := len(b.ranges)) * last / n if b.delays is None else b.delays)
        for time, last, b in zip(times, lasts, (each.beams for each in parts), strict=True)
    ]
    ranges, angles = (
        np.concatenate([getattr(each.beams, name) for each in parts])
        for name in ("ranges", "angles")
    )
    most = parts[0].beams.max_range
    return LaserScan(ranges, angles, max_range=most, delays=np.concatenate(delays))


def time_between(found: Sequence[Sequence[ScanMessage]]) -> float:
    """The usual seconds from part to part; 0 where each message is a turn."""
    steps = [b.time - a.time for parts in found for a, b in pairwise(parts)]
    return float(np.median(steps)) if steps else 0.0


def _lead(a: ScanMessage, b: ScanMessage) -> float:
    """How far the second message begins ahead of the first, in the direction of its turn."""
    return float(np.copysign(1.0, a.step) * (b.beams.angles[0] - a.beams.angles[0]))


def _goes_on(a: ScanMessage, b: ScanMessage) -> bool:
    off = b.beams.angles[0] - a.beams.angles[-1] - a.step
    return _lead(a, b) > 0 and abs(float(off)) <= PART_GAP_BEAMS * abs(a.step)


def scan_topics(bag: Bag, named: Sequence[str] | None) -> list[str]:
    """The topics that are named, or else the usual one, or the one with most messages."""
    if named:
        return [named_topic(bag, SCAN_TYPES, topic, "scan") for topic in named]
    topics = {topic: count for topic, count in bag.topics(*SCAN_TYPES).items() if count > 0}
    usual = {topic: topic.split("/")[-1] == USUAL_SCAN_TOPIC for topic in topics}
    ranked = sorted(topics, key=lambda topic: (not usual[topic], -topics[topic], topic))
    if len(ranked) > 1:
        counts = ", ".join(f"{topic} ({topics[topic]})" for topic in ranked)
        warn_of_bag(f"{bag.path}: {counts}: {ranked[0]} is read, {how_to_read('scan', ranked[1])}")
    return ranked[:1]


def named_topic(bag: Bag, kinds: Sequence[str], named: str, argument: str) -> str:
    """The topic that is named."""
    names = [name for name, count in bag.topics(*kinds).items() if count > 0]
    if (topic := next((n for n in names if n.strip("/") == named.strip("/")), None)) is None:
        reason = f"{argument} must be a topic of {kinds[0].replace('/msg', '')} in the bag"
        raise LogError(bag.path, f"{reason}, got {named!r}, but {topics_text(bag)}")
    return topic


def how_to_read(argument: str, topic: str) -> str:
    """How another topic is read."""
    python = f"files.read_bag(path, {argument}={topic!r})"
    option = "--scan-topic" if argument == "scan" else f"--{argument}"
    return f"{option} {topic} or {python} reads another"


def topics_text(bag: Bag) -> str:
    topics = dict.fromkeys(f"{c.topic} ({c.msgtype.replace('/msg', '')})" for c in bag.connections)
    return f"the bag holds {', '.join(topics)[:1000] or 'nothing'}"


def warn_of_bag(text: str) -> None:
    """Warn, as of an argument."""
    unit_checks.warn(escape(text))
