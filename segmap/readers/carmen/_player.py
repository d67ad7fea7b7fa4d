"""Text logs of Player, as the robotics data set repository (Radish) holds them.

Each line is a message, comments start with `#`. What `writelog` wrote (times in seconds, lengths in
metres, angles in radians):

    Player 1:  time host port interface index datatime PAYLOAD      (the host may be empty)
        position    x y heading vx vy turn stall
        laser       min_angle max_angle resolution n [range intensity] * n
    Player 2 and 3:  time host robot interface index type subtype PAYLOAD
        position2d  1 1  x y heading vx vy turn stall
        laser       1 1  id min_angle max_angle resolution max_range n [range intensity] * n
        laser       1 2  id x y heading min_angle max_angle resolution max_range n [...] * n
        laser       4 1  x y heading length width     where the laser sits on the robot

Lines may also start with the interface (`laser index ...`, `position index ...`), the time, if any,
after the index. What a field means is decided by how many there are: `datatime`, and all but x, y,
heading of a position may be missing; so may the intensities, and the angles of a laser.

Odometry is the pose between the position lines around the time of the scan; outside of them, and
where lines have no time, the last one before the scan. Of several position devices the one with the
lowest index counts. A pose within a laser line (1 2) goes before. There is no truth. Other
interfaces are skipped.

Assumed: a laser without angles follows the rule of `half_turn`; without a line that says where it
sits, that is the robot's centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Array, unit_checks
from .._lines import Lines, float_fields, is_count, is_number, pose_fields, time
from .._raw_scans import NOWHERE, Extrinsic, RawScan, Track, half_turn, uncorrected, view_of
from .._text import TextFormat

POSITION = ("position ", "position2d ")
PLAYER_OTHERS = frozenset(
    ("sync", "gps", "wifi", "sonar", "ptz", "truth", "power", "camera", "fiducial", "joystick")
    + ("blobfinder", "position3d", "player", "aio", "dio", "imu", "opaque", "localize", "ranger")
    + ("actarray", "wsn", "rfid", "pointcloud3d", "bumper", "ir", "gripper", "simulation", "log")
)
INTERFACES = frozenset(("laser", "position", "position2d")) | PLAYER_OTHERS
#: Fields of a laser message before the number of ranges, by its type and subtype: with and without
#: time and angles in Player 1, which has no types.
LASER_HEADS: dict[tuple[int, ...], tuple[int, ...]] = {
    (): (0, 1, 3, 4), (1, 1): (5,), (1, 2): (8,),
}  # fmt: skip
GEOMETRY = (4, 1)
#: Fields of a position, without its time.
POSITION_FIELDS = (3, 7)


class Message(NamedTuple):
    """A line taken apart: its body is what follows the index, or type and subtype."""

    device: str
    number: int
    time: float | None
    kind: tuple[int, ...]
    body: list[str]


class Player(TextFormat):
    """A log of Player."""

    name, expected = "Player", "a laser message"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.before: list[Array] = []
        self.tracks: dict[int, Track] = {}
        self.latest: dict[int, Array] = {}
        self.places: dict[str, Array] = {}

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        return _keyword(fields) is not None

    def _take(self, fields: list[str]) -> None:
        message = _message(fields)
        if message.device.startswith("laser"):
            if message.kind == GEOMETRY:
                place = pose_fields(message.body[:3], "the place of the laser")
                unit_checks.check_angles(place[2], "the laser's heading")
                self.places[message.device] = place
            elif message.kind in LASER_HEADS:
                self.scans.append(_parse_laser(message))
                self.before.append(self.latest[min(self.latest)] if self.latest else NOWHERE)
        elif message.device.startswith(POSITION) and message.kind in ((), (1, 1)):
            when, where = _parse_position(message)
            self.latest[message.number] = where
            if when is not None:
                track = self.tracks.setdefault(message.number, Track())
                track.add(when, where, len(self.scans))

    def _finished(self) -> list[RawScan]:
        self.track = self.tracks[min(self.tracks)] if self.tracks else Track()
        return [
            scan._replace(odometry=before) if np.isnan(scan.odometry).any() else scan
            for scan, before in zip(super()._finished(), self.before, strict=True)
        ]

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        place = self.places.get(laser, NOWHERE)
        is_stated = bool(np.isfinite(place).all())
        return uncorrected(scans, place if is_stated else np.zeros(3), is_stated)


def _keyword(fields: Sequence[str]) -> int | None:
    """Where in a line the interface stands."""
    places = (0, 3, 2) if is_number(fields[0]) else (0,)
    return next((k for k in places if k < len(fields) and fields[k] in INTERFACES), None)


def _message(fields: list[str]) -> Message:
    at = _keyword(fields)
    if at is None:
        raise ValueError(f"expected a message of Player, got {' '.join(fields)[:40]!r}")
    index, *body = fields[at + 1 :] or [""]
    if not is_count(index):
        raise ValueError(f"expected the index of the {fields[at]}, got {index[:40]!r}")
    when = time(fields[0]) if at else None
    words = [int(word) for word in body[:2] if is_count(word)] if at else []
    kind = tuple(words) if len(words) == 2 and min(words) > 0 else ()
    return Message(f"{fields[at]} {int(index)}", int(index), when, kind, body[len(kind) :])


def _parse_position(message: Message) -> tuple[float | None, Array]:
    body, when = message.body, message.time
    if not message.kind and len(body) - 1 in POSITION_FIELDS:
        body, when = body[1:], time(body[0])
    if len(body) not in POSITION_FIELDS:
        raise ValueError(f"expected x y heading vx vy turn stall, got {len(body)} fields")
    return when, pose_fields(body[:3], "the odometry")


def _parse_laser(message: Message) -> RawScan:
    body = message.body
    size, ranges = _split_body(body, LASER_HEADS[message.kind])
    head, found = body[:size], float_fields(ranges, "ranges")
    odometry, limit = NOWHERE, np.inf
    if size == 8:
        odometry = pose_fields(head[1:4], "the pose of the robot")
    if size > 4:
        (stated,) = float_fields(head[-1:], "the maximum range")
        limit = float(stated) if stated > 0 else np.inf
    settings = head[-4:-1] if size > 4 else head[-3:]
    angles = half_turn(len(found)) if size < 2 else beam_directions(settings, len(found))
    view = (view_of(angles),) if size < 2 else ()
    when = time(head[0]) if size in (1, 4) else message.time
    return RawScan(message.device, found, angles, when, odometry, limit=limit, assumed=view)


def _split_body(body: list[str], heads: Sequence[int]) -> tuple[int, list[str]]:
    """How many fields lie before the number of ranges, and the ranges without intensities."""
    for size in heads:
        word = body[size] if size < len(body) else ""
        rest, announced = body[size + 1 :], int(word) if is_count(word) else 0
        if announced and len(rest) in (announced, 2 * announced):
            return size, rest[:: len(rest) // announced]
    raise ValueError(
        f"expected min_angle max_angle resolution n and n ranges, each with or each without "
        f"intensity, got {len(body)} fields: {' '.join(body[:9])[:80]}"
    )


def beam_directions(settings: Sequence[str], count: int) -> Array:
    """Directions of beams from their first, last and step, (count,) array, radians.

    The step is often rounded to four decimals, which would add up over a scan: where it agrees with
    beams spread evenly from first to last, these are taken, else where it agrees with beams that
    leave the last out, and only else the step.

    Examples
    --------
    >>> beam_directions(["-1.5708", "1.5708", "0.0087"], 361)[-1].round(4)
    np.float64(1.5708)
    """
    first, last, step = angles = float_fields(settings, "the angles of the beams")
    if not (np.abs(angles) < 10).all():
        raise ValueError(f"expected angles in radians, got {' '.join(settings)[:80]}")
    turn = last - first
    ends = (count - 1, count) if count % 2 else (count, count - 1)
    for tolerance in (1e-6, 6e-5):
        for parts in ends:
            if parts and abs(abs(turn) / parts - abs(step)) <= tolerance:
                return first + turn / parts * np.arange(count)
    angles = first + np.copysign(step, turn) * np.arange(count)
    unit_checks.check_angles(angles, "angles")
    return angles
