"""Scans as a line of a log states them, what it leaves unsaid, and the log that is made of them.

Where the beams of a SICK point, and which of its ranges are none, was confirmed on the logs of the
Intel Research Lab, Freiburg building 079 and others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..angles import wrap
from ..arrays import Array
from ..poses import between, compose, interpolate, inverse
from ..scans import NO_POSE, LaserScan

#: Top of the scale of each measuring mode and the range from which it means "nothing met", metres.
#: In the last mode the sensor can tell up to 81.91, but answers of 50 m and more are none.
MODES = ((8.2, 8.18), (32.77, 32.76), (np.inf, 50.0))
#: Turn from one beam of an URG-04LX to the next, radians, and how far it sees, metres.
URG_STEP = 2 * np.pi / 1024
URG_REACH = 5.6
#: Its mirror turns once in this time, seconds.
URG_TURN = 0.1
NOWHERE = np.array(NO_POSE)
#: Poses closer than this, in metres and radians, are one: logs print three decimals or more.
SAME = 1e-3


class RawScan(NamedTuple):
    """A scan as one line of a log states it."""

    laser: str  #: which of the robot's
    ranges: Array  #: (n,)
    angles: Array  #: (n,), in the frame of the laser
    time: float | None = None
    odometry: Array = NOWHERE  #: of the robot by its wheels; NaN where the line holds none
    pose: Array = NOWHERE  #: that the line holds besides
    limit: float = np.inf  #: longest range that the line states
    codes: NDArray[np.int64] | None = None  #: see `segmap.scans.error_codes`
    delays: Array | None = None  #: (n,), as those of a `LaserScan`


class Extrinsic(NamedTuple):
    """The laser's pose on the robot, `(3,)`, and the robot's corrected poses, `(k, 3)`, or NaN."""

    sensor_pose: Array
    truth: Array


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
    is a wall in a log that also holds 20 m.

    Examples
    --------
    >>> no_return([np.array([1.0, 8.19])]), no_return([np.array([1.0, 8.19]), np.array([20.0])])
    (8.18, 32.76)
    """
    largest = max((float(r[np.isfinite(r)].max(initial=0.0)) for r in ranges), default=0.0)
    return next(limit for top, limit in MODES if largest <= top)


def clean(ranges: Array, limit: float) -> Array:
    """Ranges `(n,)`, with `inf` where nothing was met and NaN where the value is no distance."""
    return np.where(ranges >= limit, np.inf, np.where(ranges > 0, ranges, np.nan))


def centred(count: int, step: float) -> Array:
    """Directions of beams `step` apart, as many left as right: (count,) array, radians."""
    return (np.arange(count, dtype=float) - (count - 1) / 2) * step


def urg_delays(angles: Array) -> Array:
    """How long after the first beam an URG-04LX measures each: its mirror turns to the left."""
    return (angles - angles.min(initial=np.inf)) / (2 * np.pi) * URG_TURN


# ------------------------------------------------------------------------------ poses
class Track:
    """Poses and their times, in any order; lines without a pose are left out."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.poses: list[Array] = []

    def add(self, time: float, pose: Array) -> None:
        """Note one pose, (3,) array, and its time."""
        if np.isfinite(pose).all():
            self.times.append(time)
            self.poses.append(pose)

    def at(self, times: ArrayLike) -> Array:
        """Poses between the noted ones, `(m, 3)`; NaN outside of them."""
        when = np.asarray(times, float)
        if not self.times:
            return np.full((len(when), 3), NO_POSE)
        return interpolate(*self.ordered(), when)

    def ordered(self) -> tuple[Array, Array]:
        """Times `(k,)`, ascending, and poses `(k, 3)`."""
        order = np.argsort(self.times, kind="stable")
        return np.array(self.times)[order], np.array(self.poses)[order]


def with_odometry(scans: Sequence[RawScan], track: Track) -> list[RawScan]:
    """The scans, those without odometry with what the track says at their time."""
    times = [np.nan if scan.time is None else scan.time for scan in scans]
    return [
        scan._replace(odometry=pose) if np.isnan(scan.odometry).any() else scan
        for scan, pose in zip(scans, track.at(times), strict=True)
    ]


def same_poses(a: Array, b: Array) -> bool:
    """Whether poses `(k, 3)` agree in all rows; rows of NaN tell nothing."""
    step = a - b
    step[..., 2] = wrap(step[..., 2])
    return not bool((np.abs(step) > SAME).any())


def uncorrected(scans: Sequence[RawScan], place: Array) -> Extrinsic:
    """The laser sits at `place`, (3,) array, and no pose was corrected."""
    return Extrinsic(place, np.full((len(scans), 3), np.nan))


def extrinsic_by_offset(scans: Sequence[RawScan], offset: Array) -> Extrinsic:
    """The laser sits at `offset`, (3,) array, and its poses were corrected."""
    poses = np.array([scan.pose for scan in scans])
    return Extrinsic(offset, compose(poses, inverse(offset)))


def extrinsic_by_poses(scans: Sequence[RawScan], offset: Array) -> Extrinsic:
    """Each line holds a pose of the laser and one of the robot: what lies between them decides.

    Where it is the same in all lines it is the laser's place on the robot. Where it varies, the
    laser's poses have been corrected and the robot's not; likewise where the robot has none. Then
    the laser sits at `offset`, (3,) array.
    """
    poses = np.array([scan.pose for scan in scans])
    relative = between(np.array([scan.odometry for scan in scans]), poses)
    known = relative[np.isfinite(relative).all(1)]
    if not len(known) or not same_poses(known, known[:1]):
        return extrinsic_by_offset(scans, offset)
    return uncorrected(scans, np.round(known[0], 6) + 0.0)


# -------------------------------------------------------------------------------- log
def assemble(
    raw: Sequence[RawScan], extrinsic: Callable[[str, Sequence[RawScan]], Extrinsic]
) -> tuple[list[LaserScan], Array | None]:
    """Scans and corrected poses `(k, 3)` of all lasers in the file's order.

    `extrinsic` tells from all scans of a laser where it sits on the robot.
    """
    lasers = np.array([scan.laser for scan in raw])
    places, truth = np.empty((len(raw), 3)), np.empty((len(raw), 3))
    for laser in np.unique(lasers):
        mine = np.flatnonzero(lasers == laser)
        places[mine], truth[mine] = extrinsic(str(laser), [raw[k] for k in mine.tolist()])
    usual, scans = no_return(scan.ranges for scan in raw), []
    for k, scan in enumerate(raw):
        limit, when = min(scan.limit, usual), k if scan.time is None else scan.time
        odometry, ranges = known(scan.odometry), clean(scan.ranges, limit)
        limits = limit, places[k], scan.codes, scan.delays
        scans.append(LaserScan(ranges, scan.angles, when, odometry, *limits))
    return scans, known_truth(truth)


def known(pose: Array) -> Array | None:
    """A pose, or None where it is not known."""
    return None if np.isnan(pose).any() else pose


def known_truth(truth: Array) -> Array | None:
    """Corrected poses `(k, 3)`, or None where no scan has any."""
    return truth if np.isfinite(truth).any() else None
