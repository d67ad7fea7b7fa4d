"""A quadtree of an aligned log."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..angles import Array
from ..poses import compose, transform
from ..scans import LaserScan, Log
from ._map import QuadtreeMap


def build_map(
    log: Log, poses: ArrayLike, *, resolution: float = 0.05, free: bool = True, **options: Any
) -> QuadtreeMap:
    """Insert every scan of a log from its pose.

    Parameters
    ----------
    log : Log
    poses : (k, 3) array, metres and radians
        One a scan; scans with NaN in their pose are left out.
    resolution : float, metres
    free : bool
        Whether beams that met nothing count as free up to the sensor's largest range, where the
        log knows that.
    **options
        Of `QuadtreeMap`; without a corner the map begins around the first pose.

    Returns
    -------
    QuadtreeMap

    Raises
    ------
    ValueError
        Where shapes disagree, or a scan reaches beyond `max_size`.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("room")
    >>> build_map(log, log.truth, resolution=0.05).nbytes > 0
    True
    """
    where = np.asarray(poses, float)
    if where.shape != (len(log), 3):
        raise ValueError(f"poses must have shape ({len(log)}, 3), a pose a scan, got {where.shape}")
    used = np.flatnonzero(np.isfinite(where).all(1)).tolist()
    start = where[used[0], :2] if len(used) else np.zeros(2)
    corner = np.floor(start / resolution - 256) * resolution
    map = QuadtreeMap(**{"resolution": resolution, "corner": corner, **options})
    for k in used:
        sensor = compose(where[k], log[k].sensor_pose)
        ends = transform(where[k], log[k].points())
        map.insert_scan(sensor[:2], ends, unmet(log[k], sensor) if free else None)
    return map


def unmet(scan: LaserScan, sensor: Array) -> Array:
    """Where beams that met nothing leave the sensor's range, `(m, 2)`, metres, in the map.

    Empty where the largest range is not known. `sensor` is the sensor's pose in the map.
    """
    if not np.isfinite(scan.max_range):
        return np.empty((0, 2))
    angle = sensor[2] + scan.angles[np.isposinf(scan.ranges)]
    return sensor[:2] + scan.max_range * np.stack([np.cos(angle), np.sin(angle)], -1)
