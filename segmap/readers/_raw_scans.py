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
NOWHERE = np.array(NO_POSE)
#: Poses closer than this, in metres and radians, are one: logs print three decimals or more.
SAME = 1e-3


class RawScan(NamedTuple):
    """A scan as one line of a log states it.

    Parameters
    ----------
    laser : str
        Which of the robot's.
    ranges : (n,) array, metres
    angles : (n,) array, radians
        Directions of the beams in the frame of the laser.
    time : float, seconds, or None
    odometry, pose : (3,) array, metres and radians
        The robot's by its wheels, and the pose that the line holds; NaN where it holds none.
    limit : float, metres
        Longest range that the line states.
    codes : (n,) int array or None
        Of beams without a range, see `segmap.scans.error_codes`; 0 where there is one.
    """

    laser: str
    ranges: Array
    angles: Array
    time: float | None = None
    odometry: Array = NOWHERE
    pose: Array = NOWHERE
    limit: float = np.inf
    codes: NDArray[np.int64] | None = None


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
    """The range from which on the sensor met nothing, metres, from all `(n,)` ranges of a log.

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
    """Ranges `(n,)`, metres, with `inf` where nothing was met, NaN where the value is no distance.

    Examples
    --------
    >>> clean(np.array([1.0, 81.83, -1.0, 0.0]), 50.0)
    array([ 1., inf, nan, nan])
    """
    return np.where(ranges >= limit, np.inf, np.where(ranges > 0, ranges, np.nan))


def centred(count: int, step: float) -> Array:
    """Directions of beams `step` apart, as many left as right: (count,) array, radians.

    Examples
    --------
    >>> centred(3, 0.5)
    array([-0.5,  0. ,  0.5])
    """
    return (np.arange(count, dtype=float) - (count - 1) / 2) * step


# ------------------------------------------------------------------------------ poses
class Track:
    """Poses and their times, in any order; lines without a pose are left out."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.poses: list[Array] = []

    def add(self, time: float, pose: Array) -> None:
        """Note one pose, (3,) array, metres and radians, and its time in seconds."""
        if np.isfinite(pose).all():
            self.times.append(time)
            self.poses.append(pose)

    def at(self, times: ArrayLike) -> Array:
        """Poses between the noted ones, `(m, 3)`, metres and radians; NaN outside of them."""
        when = np.asarray(times, float)
        if not self.times:
            return np.full((len(when), 3), NO_POSE)
        return interpolate(*self.ordered(), when)

    def ordered(self) -> tuple[Array, Array]:
        """Times `(k,)`, seconds, ascending, and poses `(k, 3)`, metres and radians."""
        order = np.argsort(self.times, kind="stable")
        return np.array(self.times)[order], np.array(self.poses)[order]


def with_odometry(scans: Sequence[RawScan], track: Track) -> list[RawScan]:
    """The scans, those without odometry with what the track says at their time.

    Odometry is a (3,) array, metres and radians, NaN where nothing is known; times in seconds.
    """
    times = [np.nan if scan.time is None else scan.time for scan in scans]
    return [
        scan._replace(odometry=pose) if np.isnan(scan.odometry).any() else scan
        for scan, pose in zip(scans, track.at(times), strict=True)
    ]


def same_poses(a: Array, b: Array) -> bool:
    """Whether poses `(k, 3)`, metres and radians, agree in all rows; rows of NaN tell nothing."""
    step = arrays.trailing(a, "a", 3) - arrays.trailing(b, "b", 3)
    step[..., 2] = wrap(step[..., 2])
    return not bool((np.abs(step) > SAME).any())


def uncorrected(scans: Sequence[RawScan], place: Array) -> Extrinsic:
    """The laser sits at `place`, (3,) array, metres and radians, and no pose was corrected."""
    return Extrinsic(place, np.full((len(scans), 3), np.nan))


def extrinsic_by_offset(scans: Sequence[RawScan], offset: Array) -> Extrinsic:
    """The laser sits at `offset`, (3,) array, metres and radians, and its poses were corrected."""
    poses = np.array([scan.pose for scan in scans])
    return Extrinsic(offset, compose(poses, inverse(offset)))


def extrinsic_by_poses(scans: Sequence[RawScan], offset: Array) -> Extrinsic:
    """Each line holds a pose of the laser and one of the robot: what lies between them decides.

    Where it is the same in all lines it is the laser's place on the robot. Where it varies, the
    laser's poses have been corrected and the robot's not; likewise where the robot has none. Then
    the laser sits at `offset`, (3,) array, metres and radians.
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
    """Scans and corrected poses `(k, 3)`, metres and radians, of all lasers in the file's order.

    `extrinsic` tells from all scans of a laser where it sits on the robot.
    """
    lasers = np.array([scan.laser for scan in raw])
    places, truth = np.empty((len(raw), 3)), np.empty((len(raw), 3))
    for laser in np.unique(lasers):
        mine = np.flatnonzero(lasers == laser)
        places[mine], truth[mine] = extrinsic(str(laser), [raw[k] for k in mine.tolist()])
    limit = no_return(scan.ranges for scan in raw)
    scans = [_scan(scan, k, places[k], limit) for k, scan in enumerate(raw)]
    return scans, truth if np.isfinite(truth).any() else None


def _scan(raw: RawScan, number: int, place: Array, limit: float) -> LaserScan:
    limit = min(raw.limit, limit)
    when = number if raw.time is None else raw.time
    odometry = None if np.isnan(raw.odometry).any() else raw.odometry
    ranges = clean(raw.ranges, limit)
    return LaserScan(ranges, raw.angles, when, odometry, limit, place, raw.codes)
