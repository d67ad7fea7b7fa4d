"""Points from afar, where the laser is noisy, draw no wall that was seen from near."""

from __future__ import annotations

from copy import copy

import numpy as np

from ..arrays import Array
from ..poses.motions import compose
from ..scans import Log
from ..scans.noise import SensorNoise
from ..threads import Rows

#: Points with no more noise are not from afar, metres: at 0.03 an RPLidar A2 rounds jogs off, and
#: at 0.015 no wall is seen from near.
FAR_SIGMA_M = 0.02
#: A point with no more than so many times the least noise in and beside its square is near too.
FAR_FACTOR = 1.5
#: Side of the squares in which the least noise is kept, metres.
SEEN_SQUARE_M = 0.1
#: Squares of one row at most: no coordinate is beyond 1e7 m.
SQUARES_A_ROW = 1 << 28


def without_far_points(log: Log, poses: Array, scan_numbers: Rows, sensor: SensorNoise) -> Log:
    """The log without points from afar of what its scans, of known poses, saw from near."""
    scans = [log.scans[k] for k in scan_numbers]
    if sensor.range_share == 0.0 or not scans:
        return log
    sizes = [len(scan) for scan in scans]
    ranges, angles, valid = (
        np.concatenate(rows)
        for rows in zip(*((scan.ranges, scan.angles, scan.valid) for scan in scans), strict=True)
    )
    sigma, measured = sensor.sigma(ranges), np.where(valid, ranges, 0.0)
    places = compose(poses[scan_numbers], np.array([scan.sensor_pose for scan in scans]))
    x, y, turn = np.repeat(places, sizes, axis=0).T
    squares, of = np.unique(
        np.rint((x + measured * np.cos(angles + turn)) / SEEN_SQUARE_M) * SQUARES_A_ROW
        + np.rint((y + measured * np.sin(angles + turn)) / SEEN_SQUARE_M),
        return_inverse=True,
    )
    least = np.full(len(squares), np.inf)
    np.minimum.at(least, of[valid], sigma[valid])
    around = least.copy()
    for step in (a * SQUARES_A_ROW + b for a in (-1, 0, 1) for b in (-1, 0, 1)):
        beside = np.searchsorted(squares, squares + step) % len(squares)
        near = squares[beside] == squares + step
        around[near] = np.minimum(around[near], least[beside[near]])
    far = valid & (sigma > np.maximum(FAR_SIGMA_M, FAR_FACTOR * around[of]))
    thinned = list(log.scans)
    for k, own in zip(
        scan_numbers, np.split(np.where(far, np.nan, ranges), np.cumsum(sizes)[:-1]), strict=True
    ):
        thinned[k] = copy(thinned[k])  # its beams were checked
        object.__setattr__(thinned[k], "ranges", own)
    part = copy(log)  # and so were its poses
    object.__setattr__(part, "scans", tuple(thinned))
    return part
