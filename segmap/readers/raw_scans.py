"""Scans as a line of a log states them, what it leaves unsaid, and the log that is made of them.

Where the beams of a SICK point, and which of its ranges are none, was confirmed on the logs of the
Intel Research Lab, Freiburg building 079 and others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..angles import wrap
from ..arrays import Array, unit_checks
from ..poses import between, compose, interpolate, inverse
from ..scans import LONGEST_TURN_S, NO_POSE, LaserScan
from ..scans.causes import Cause, Finding
from ._clock import on_one_clock, stands

#: Top of the scale of each measuring mode and the range from which it means "nothing met", metres.
#: In the last mode the sensor can tell up to 81.91, but answers of 50 m and more are none.
RANGE_MODES = ((8.2, 8.18), (32.77, 32.76), (np.inf, 50.0))
#: Turn from one beam of an URG-04LX to the next, radians, and how far it sees, metres.
URG_STEP = 2 * np.pi / 1024
URG_REACH = 5.6
#: Its mirror turns once in this time, seconds.
URG_TURN = 0.1
#: Said of a log whose format is that of such a sensor, and whose file does not say it.
URG_ASSUMED = f"a URG-04LX, which sees {URG_REACH} m and turns in {URG_TURN} s"
NOWHERE = np.array(NO_POSE)
#: Poses closer than this, in metres and radians, are one: logs print three decimals or more.
SAME_POSE = 1e-3
#: No laser waits longer from beam to beam, seconds.
MOST_APART = 1.0


class RawScan(NamedTuple):
    """A scan as one line of a log states it."""

    laser: str  #: name of the laser on the robot
    ranges: Array  #: (n,)
    angles: Array  #: (n,), in the frame of the laser
    time: float | None = None
    odometry: Array = NOWHERE  #: pose of the robot by its wheels; NaN where the line holds none
    pose: Array = NOWHERE  #: a second pose that the line holds; NaN where it holds none
    limit: float = np.inf  #: longest range that the line states
    codes: NDArray[np.int64] | None = None  #: see `segmap.scans.error_codes`
    delays: Array | None = None  #: (n,), as those of a `LaserScan`
    assumed: tuple[str, ...] = ()  #: what the line leaves unsaid


class Extrinsic(NamedTuple):
    """Where a laser sits, and what its scans say of the robot."""

    sensor_pose: Array  #: pose of the laser on the robot, (3,)
    is_stated: bool = False  #: whether the file says where the laser sits
    truth: Array | float = np.nan  #: the robot's corrected poses, (k, 3), or none


# ------------------------------------------------------------------------------ beams
def half_turn(count: int) -> Array:
    """Directions of the beams of a sensor that looks over half a turn, (count,) array, radians.

    An even number starts at -90 degrees and leaves the end point out; an odd one holds both ends.

    Examples
    --------
    >>> np.degrees(half_turn(5)), np.degrees(half_turn(4))
    (array([-90., -45.,   0.,  45.,  90.]), array([-90., -45.,   0.,  45.]))
    """
    count = arrays.whole(count, "count", least=0, most=1_000_000)
    if count == 1:
        return np.zeros(1)
    return np.linspace(-np.pi / 2, np.pi / 2, count, endpoint=count % 2 == 1)


def no_return(ranges: Iterable[Array]) -> float:
    """The range from which on the sensor met nothing, from all `(n,)` ranges of a log.

    It depends on the measuring mode, which the largest finite range of the whole log tells: 8.18 m
    is a wall in a log that also holds 40 m. Infinite where all beams met something nearer.

    Examples
    --------
    >>> near, far = np.array([1.0, 8.19]), np.array([20.0])
    >>> no_return([near]), no_return([near, 2 * far]), no_return([near, 4 * far])
    (8.18, inf, 50.0)
    """
    largest = max((float(r[np.isfinite(r)].max(initial=0.0)) for r in ranges), default=0.0)
    limit = next(limit for top, limit in RANGE_MODES if largest <= top)
    return limit if largest >= limit else np.inf


def clean(ranges: Array, limit: float) -> Array:
    """Ranges `(n,)`, with `inf` where nothing was met and NaN where the value is no distance."""
    unit_checks.check_ranges(ranges, limit)
    return np.where(ranges >= limit, np.inf, np.where(ranges > 0, ranges, np.nan))


def beams_of_message(message: Any, time: float = 0.0, odometry: Array | None = None) -> LaserScan:
    """Ranges and directions of a `sensor_msgs/LaserScan`, in the frame of the laser."""
    ranges = np.asarray(message.ranges, float)
    first, step = float(message.angle_min), float(message.angle_increment)
    if not len(ranges):
        raise ValueError("expected ranges, got a scan without")
    if not (np.isfinite([first, step]).all() and (step or len(ranges) == 1)):
        raise ValueError(f"expected angles in radians, got {first:.6g} and steps of {step:.6g}")
    least, most = float(message.range_min), float(message.range_max)
    most = most if most > 0 else np.inf
    clean_ranges = clean(np.where(ranges < least, np.nan, ranges), most)
    count, apart = np.arange(len(ranges)), abs(float(message.time_increment))
    delays = count * apart if 0 < apart <= min(MOST_APART, LONGEST_TURN_S / len(count)) else None
    angles = first + step * count
    return LaserScan(clean_ranges, angles, time, odometry, most, delays=delays)


def directions(count: int, step: float) -> Array:
    """Directions of beams `step` apart, as many left as right: (count,) array, radians."""
    return (np.arange(count, dtype=float) - (count - 1) / 2) * step


def urg_delays(angles: Array) -> Array:
    """How long after the first beam an URG-04LX measures each: its mirror turns to the left."""
    return (angles - angles.min(initial=np.inf)) / (2 * np.pi) * URG_TURN


# ------------------------------------------------------------------------------ poses
class Track:
    """Poses and their times, in the order of a file; lines without a pose are left out."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.poses: list[Array] = []
        self.after: list[int] = []

    def add(self, time: float, pose: Array, after: int | None = None) -> None:
        """Note one pose, (3,) array, and its time; `after` so many scans, where these are with it.

        A file holds poses after scans everywhere, or nowhere.
        """
        if np.isfinite(pose).all():
            self.times.append(time)
            self.poses.append(pose)
            self.after += [] if after is None else [after]

    def synchronise(self, times: ArrayLike) -> Synchronised:
        """The poses at the times of scans, `(k,)`; a clock that was set back goes on in both."""
        when, noted = np.asarray(times, float), np.array(self.times)
        if not (len(noted) and len(when)):
            return Synchronised(when, np.full((len(when), 3), NO_POSE), ())
        after = np.array(self.after, int) if self.after else None
        if after is not None and stands(when) | stands(noted):
            last = np.searchsorted(after, np.arange(len(when)), side="right")
            words = "a clock stands still: the order in the file counts"
            poses = np.array([NO_POSE, *self.poses])[last]
            when = np.full(len(when), np.nan) if stands(when) else when
            return Synchronised(when, poses, [Finding(Cause.CLOCK, 0.0, words)])
        when, noted, causes = on_one_clock(when, noted, after)
        return Synchronised(when, interpolate(*self.in_order(noted), when), causes)

    def in_order(self, times: Array | None = None) -> tuple[Array, Array]:
        """Times `(k,)`, ascending, the own ones or others, and poses `(k, 3)`."""
        noted = np.array(self.times) if times is None else times
        order = np.argsort(noted, kind="stable")
        return noted[order], np.reshape(self.poses, (-1, 3))[order]


class Synchronised(NamedTuple):
    """Times of scans and poses on one clock."""

    times: Array  #: (k,), of the scans
    poses: Array  #: (k, 3), at these times; NaN outside of the track
    causes: Sequence[Finding]


def with_odometry(
    scans: Sequence[RawScan], track: Track
) -> tuple[Sequence[RawScan], Sequence[Finding]]:
    """The scans, those without odometry with what the track says at their time; and its causes."""
    if not any(np.isnan(scan.odometry).any() for scan in scans):
        return scans, ()
    times, poses, causes = track.synchronise(
        [np.nan if scan.time is None else scan.time for scan in scans]
    )
    posed_scans = [
        scan._replace(
            time=None if scan.time is None else when,
            odometry=pose if np.isnan(scan.odometry).any() else scan.odometry,
        )
        for scan, when, pose in zip(scans, times.tolist(), poses, strict=True)
    ]
    return posed_scans, causes


def same_poses(a: Array, b: Array) -> bool:
    """Whether poses `(k, 3)` agree in all rows; rows of NaN tell nothing."""
    step = a - b
    step[..., 2] = wrap(step[..., 2])
    return not bool((np.abs(step) > SAME_POSE).any())


def extrinsic_by_offset(
    scans: Sequence[RawScan], offset: Array, is_stated: bool = False
) -> Extrinsic:
    """The laser sits at `offset`, (3,) array, and its poses were corrected."""
    poses = np.array([scan.pose for scan in scans])
    return Extrinsic(offset, is_stated, compose(poses, inverse(offset)))


def extrinsic_by_poses(
    scans: Sequence[RawScan], offset: Array, is_stated: bool = False
) -> Extrinsic:
    """Each line holds a pose of the laser and one of the robot: what lies between them decides.

    Where it is the same in all lines it is the laser's place on the robot. Where it varies, the
    laser's poses have been corrected and the robot's not; likewise where the robot has none. Then
    the laser sits at `offset`, (3,) array.
    """
    poses = np.array([scan.pose for scan in scans])
    relative = between(np.array([scan.odometry for scan in scans]), poses)
    places = relative[np.isfinite(relative).all(1)]
    if not len(places) or not same_poses(places, places[:1]):
        return extrinsic_by_offset(scans, offset, is_stated)
    return Extrinsic(np.round(places[0], 6) + 0.0, is_stated=True)


# ---------------------------------------------------------------------------- assumed
#: Said of a log whose file does not say which way angles grow.
COUNTERCLOCKWISE = "beams counter-clockwise"


def view_of(angles: Array) -> str:
    """That beams `(n,)`, whose directions the file does not say, look over so many degrees."""
    step = float(np.median(np.diff(angles))) if len(angles) > 1 else 0.0
    wide = np.degrees(np.ptp(angles) + step * (len(angles) % 2 == 0))
    return f"{len(angles)} beams look over {wide:.4g} degrees, counter-clockwise"


def place_of(place: Array) -> str:
    """That a laser sits at a place `(3,)` on the robot, which the file does not say."""
    ahead = f"{place[0]:g} m ahead of " if place[0] else "at "
    return f"the laser sits {ahead}the robot's centre"


# -------------------------------------------------------------------------------- log
def assemble(
    raw: Sequence[RawScan], extrinsic: Callable[[str, Sequence[RawScan]], Extrinsic]
) -> tuple[list[LaserScan], Array | None, list[str]]:
    """Scans and corrected poses `(k, 3)` of all lasers in the file's order, and what is assumed.

    `extrinsic` tells from all scans of a laser where it sits on the robot.
    """
    lasers, assumed = np.array([scan.laser for scan in raw]), [*chain(*(s.assumed for s in raw))]
    places, truth = np.empty((len(raw), 3)), np.empty((len(raw), 3))
    for laser in np.unique(lasers):
        mine = np.flatnonzero(lasers == laser)
        these = [raw[k] for k in mine.tolist()]
        places[mine], is_stated, truth[mine] = extrinsic(str(laser), these)
        moved = np.isfinite([scan.odometry for scan in these]) | np.isfinite(truth[mine])
        if moved.any() and not is_stated:
            assumed.append(place_of(places[mine[0]]))
    usual, scans = no_return(scan.ranges for scan in raw), []
    if any(usual < scan.limit for scan in raw):
        assumed.append(f"ranges from {usual:g} m on met nothing, as those of a SICK")
    for place, scan in zip(places, raw, strict=True):
        limit, when = min(scan.limit, usual), np.nan if scan.time is None else scan.time
        odometry, ranges = or_none(scan.odometry), clean(scan.ranges, limit)
        limits = limit, place, scan.codes, scan.delays
        scans.append(LaserScan(ranges, scan.angles, when, odometry, *limits))
    return scans, known_truth(truth), assumed


def or_none(pose: Array) -> Array | None:
    """A pose, or None where it is not known."""
    return None if np.isnan(pose).any() else pose


def known_truth(truth: Array) -> Array | None:
    """Corrected poses `(k, 3)`, or None where no scan has any."""
    return truth if np.isfinite(truth).any() else None
