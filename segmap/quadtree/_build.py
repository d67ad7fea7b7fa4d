"""A quadtree of an aligned log, people who passed left out, and the part worth looking at."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import LIMIT, Array, Poses, Quantity, Share, checked
from ..poses.motions import compose, transform
from ..scans import LaserScan, Log
from ..scans.pose_argument import checked_poses, warn_if_empty_map
from ._map import QuadtreeMap, Resolution

#: Side of the squares in which rays are counted that saw through, metres: half a leg's width, and
#: more than walls scatter.
PASSING_M = 0.1


@checked
def build_map(
    log: Log, poses: Poses, *, resolution: Resolution = 0.05, free: bool = False, **options: Any
) -> QuadtreeMap:
    """Insert every scan of a log from its pose, in the frame of the poses (B 4.2 to 4.4).

    Parameters
    ----------
    poses : (k, 3) array, metres and radians, or Alignment
        One a scan; scans with NaN in their pose are left out.
    free : bool
        Whether beams that met nothing count as free up to the sensor's largest range, where the
        log knows that. So it is in simulated rooms; a real sensor answers the same for a dark or
        slanted wall, which such rays then erase.
    **options
        Of `QuadtreeMap`; without a corner the map begins around the first pose.

    Warns
    -----
    UserWarning
        Saying why, where no beam of any scan ends in the map.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("room")
    >>> build_map(log, log.truth, resolution=0.05)
    QuadtreeMap(25.6 m, 4279 leaves of 0.05 m and more, 61 scans)
    """
    where = checked_poses(log, poses)
    used = np.flatnonzero(np.isfinite(where).all(1)).tolist()
    map = QuadtreeMap(resolution=resolution, **options)
    if "corner" not in options and used:
        cells = np.floor(where[used[0], :2] / resolution) - np.round(map.side / resolution / 2)
        map = QuadtreeMap(resolution=resolution, corner=cells * resolution, **options)
    for k in used:
        sensor = compose(where[k], log[k].sensor_pose)
        ends = transform(where[k], log[k].points())
        try:
            map.insert_scan(sensor[:2], ends, free_ends(log[k], sensor) if free else None)
        except ValueError as error:
            raise ValueError(f"scan {k}: {error}") from error
    empty = not any(log[k].valid.any() for k in used)
    warn_if_empty_map(empty, log, where, "without an end point")
    return map


@checked
def without_passers(log: Log, poses: Poses, *, seen_through: Share = 0.2) -> Log:
    """The log without beams that met what is gone: people who walked through.

    A quadtree of all scans counts for each square of `PASSING_M` the rays that crossed it and those
    that ended in it (B 4.1). Ends of beams become NaN where at most the share `seen_through` of
    these rays ended: the others saw through. They came later, since a square counts from the first
    beam that ends near it: who stood still remains, and who came at the end. Of the
    beams on ten people who walk past a robot in a simulated office 0.8 and more go, and 0.005 of
    those on walls.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians, or Alignment
        One a scan; scans with NaN in their pose are kept as they are.

    Examples
    --------
    >>> wall, person = LaserScan([4.05], [0.0]), LaserScan([2.05], [0.0])
    >>> log = without_passers(Log("it", [person] + [wall] * 20), np.zeros((21, 3)))
    >>> log[0].ranges, log[20].ranges
    (array([nan]), array([4.05]))
    """
    where = checked_poses(log, poses)
    map, scans = build_map(log, where, resolution=PASSING_M), list(log)
    for k in np.flatnonzero(np.isfinite(where).all(1)).tolist():
        ranges, seen = log[k].ranges.copy(), np.flatnonzero(log[k].valid)
        ends = transform(where[k], log[k].points())
        ranges[seen[map.occupancy(ends) <= seen_through]] = np.nan
        scans[k] = replace(log[k], ranges=ranges)
    return replace(log, scans=tuple(scans))


def free_ends(scan: LaserScan, sensor: ArrayLike) -> Array:
    """Where beams that met nothing leave the sensor's range, `(m, 2)`, metres, in the map.

    None do where the largest range is not known. `sensor` is its pose in the map, `(3,)`, in metres
    and radians.

    Examples
    --------
    >>> free_ends(LaserScan([1.0, np.inf], [0.0, 0.0], max_range=4.0), (2, 1, 0))
    array([[6., 1.]])
    """
    arrays.instance(scan, "scan", LaserScan)
    x, y, heading = arrays.pose(sensor, "sensor")
    if not np.isfinite(scan.max_range):
        return np.empty((0, 2))
    angle = heading + scan.angles[scan.ranges >= scan.max_range]
    return np.array([x, y]) + scan.max_range * np.stack([np.cos(angle), np.sin(angle)], -1)


@checked
def extent(
    map: QuadtreeMap, *, margin: Annotated[float, Quantity("", least=0, most=LIMIT)] = 0.08
) -> tuple[float, float, float, float]:
    """Left, low, right and high edge, metres, of where beams ended; the whole root where none did.

    The margin around it is a part of the larger of width and height.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.5)
    >>> tree.insert_scan((0, 0), [(10, 2)])
    >>> extent(tree, margin=1)
    (9.5, 1.5, 11.0, 3.0)
    """
    with arrays.instance(map, "map", QuadtreeMap).lock:
        leaves, bounds = map.leaves(), map.bounds
    hit = leaves.occ > 0
    if not hit.any():
        return bounds
    x, y, side = leaves.x[hit], leaves.y[hit], leaves.side[hit]
    x_min, y_min, x_max, y_max = x.min(), y.min(), (x + side).max(), (y + side).max()
    space = margin * max(x_max - x_min, y_max - y_min)
    return float(x_min - space), float(y_min - space), float(x_max + space), float(y_max + space)
