"""Scans of a laser that turns while the robot moves: how it moved, and each beam carried back."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..poses.motions import between, compose, inverse, twist, wrap
from ._scans import LaserScan
from .causes import Cause, Finding

#: A robot stands where it has moved by less since a scan, metres: poses of matches err by as much.
ROBOT_STANDS_M = 0.01
#: A robot stands where it has turned by less since a scan, radians: matches err by as much.
ROBOT_STANDS_RAD = np.radians(0.2)
#: Two scans show the same where half of the beams differ by less, metres.
SAME_BEAM_M = 0.1
#: Looks from one place that are drawn: more add noise and no wall.
MOST_LOOKS_FROM_ONE_PLACE = 20
#: Between scans that are farther apart than this nobody knows how the robot moved, seconds.
LONGEST_GAP_S = 1.0


def is_timed(scans: Iterable[LaserScan]) -> bool:
    """Whether any scan has a time for each beam."""
    return any(scan.delays is not None for scan in scans)


def velocities(times: Array, poses: Array) -> Array:
    """How the robot moved at each scan, `(k, 3)`, metres and radians a second; 0 where unknown.

    Poses `(k, 3)` that scans were matched at lie in the middle of each scan, so the difference is
    that from the scan before to the one after; at the ends, and beside a gap, it is one-sided.
    A laser turns evenly where the stamps of a computer do not: scans lie whole turns apart.
    """
    usable, steps = np.isfinite(poses).all(1) & np.isfinite(times), np.diff(times)
    close = usable[:-1] & usable[1:] & (steps > 0) & (steps <= LONGEST_GAP_S)
    turn = np.median(steps[close]) if close.any() else 1.0
    turns = np.where(close, np.maximum(np.rint(np.where(close, steps, 0.0) / turn), 1), 0)
    clock, here = np.r_[0.0, np.cumsum(turns * turn)], np.arange(len(times))
    before, after = here - np.r_[False, close], here + np.r_[close, False]
    apart = clock[after] - clock[before]
    motion = twist(between(poses[before], poses[after]))
    return np.where(apart[:, None] > 0, motion / np.where(apart > 0, apart, 1.0)[:, None], 0.0)


def motion_compensated(scan: LaserScan, motions: Array) -> LaserScan:
    """The scan as if all beams had been measured at its `time`.

    `motions`, `(n, 3)` or `(3,)`, says where the robot was at each beam, in its frame at `time`.
    Valid beams stay valid, for `max_range` grows with the longest, and no other becomes so.
    """
    ranges, angles, valid = scan.ranges, scan.angles, scan.valid
    poses = compose(inverse(scan.sensor_pose), compose(motions, scan.sensor_pose))
    lengths = np.where(valid, ranges, 0.0)
    aim = angles + poses[..., 2]
    x, y = poses[..., 0] + lengths * np.cos(aim), poses[..., 1] + lengths * np.sin(aim)
    is_far = np.isfinite(ranges) & (ranges >= scan.max_range)
    new_ranges = np.where(valid, np.hypot(x, y), np.where(is_far, np.inf, ranges))
    new_angles = np.where(valid, aim + wrap(np.arctan2(y, x) - aim), aim)
    limit = max(scan.max_range, float(np.nextafter(new_ranges[valid].max(initial=0.0), np.inf)))
    return replace(scan, ranges=new_ranges, angles=new_angles, max_range=limit, delays=None)


def repeats_place(scans: Sequence[LaserScan], poses: Array) -> NDArray[np.bool_]:
    """Scans, `(k,)`, that add nothing, since the robot stands where it was at an earlier one.

    They are those behind the first 20 of a stay, and equal ones. Poses `(k, 3)`, metres and
    radians. A robot that creeps does not stand: it is compared with the first scan of the stay.
    """
    stands, first, looks = np.zeros(len(poses), bool), 0, 1
    step = np.abs(between(poses[:-1], poses[1:]))
    near = (np.hypot(step[:, 0], step[:, 1]) < ROBOT_STANDS_M) & (step[:, 2] < ROBOT_STANDS_RAD)
    for k in (np.flatnonzero(near) + 1).tolist():
        if not near[k - 2] or k == 1:  # the stay begins at the scan before
            first, looks = k - 1, 1
        x, y, turn = np.abs(between(poses[first], poses[k]))
        if not (
            np.hypot(x, y) < ROBOT_STANDS_M
            and turn < ROBOT_STANDS_RAD
            and _measure_the_same(scans[first], scans[k])
        ):
            first, looks = k, 1
            continue
        twice = np.array_equal(scans[k - 1].ranges, scans[k].ranges, equal_nan=True)
        stands[k] = twice or looks >= MOST_LOOKS_FROM_ONE_PLACE
        looks += not twice
    return stands


def _measure_the_same(a: LaserScan, b: LaserScan) -> bool:
    """Whether half of the beams of two scans measure the same."""
    if len(a) != len(b):
        return False
    both = a.valid & b.valid
    return bool(both.any() and np.median(np.abs(a.ranges[both] - b.ranges[both])) < SAME_BEAM_M)


def rests(scans: Sequence[LaserScan], poses: Array) -> list[Finding]:
    """At how many scans of a log the robot stands, poses `(k, 3)`, and what becomes of them."""
    count = int(repeats_place(scans, poses).sum())
    words = f"at {count} of {len(poses)} scans the robot stands, and they add nothing: not drawn"
    return [Finding(Cause.STANDS, count, words)] if count >= MOST_LOOKS_FROM_ONE_PLACE else []


def skew_warning(scans: Sequence[LaserScan], poses: Array) -> list[Finding]:
    """In how many scans beams err by more than their spacing, if the robot moved as it measured.

    Their times are not used: whether it stood, `alignment.deskew` finds.
    """
    if not is_timed(scans):
        return []
    motions = velocities(np.array([scan.time for scan in scans]), poses)
    many, turn, way = 0, 0.0, 0.0
    for scan, motion in zip(scans, motions, strict=True):
        if scan.delays is None or len(scan) < 2 or not scan.valid.any():
            continue
        x, y, heading = np.abs(motion) * scan.delays.max()
        half, spacing = np.median(scan.ranges[scan.valid]), np.median(np.abs(np.diff(scan.angles)))
        if heading * half + np.hypot(x, y) > half * spacing:
            many, turn, way = many + 1, max(turn, heading), max(way, float(np.hypot(x, y)))
    most = f"up to {np.degrees(turn):.1f} degrees and {way:.2f} m"
    moved = "the robot moved by more than the spacing of the beams"
    words = f"in {many} of {len(scans)} scans {moved}, {most}, unless it stood to measure"
    return [Finding(Cause.SKEW, many, words)] if many else []
