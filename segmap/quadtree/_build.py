"""A quadtree of an aligned log."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..poses import compose, transform
from ..scans import LaserScan, Log
from ._map import QuadtreeMap


def build_map(
    log: Log, poses: ArrayLike, *, resolution: float = 0.05, free: bool = False, **options: Any
) -> QuadtreeMap:
    """Insert every scan of a log from its pose, in the frame of the poses (B 4.2 to 4.4).

    Parameters
    ----------
    log : Log
    poses : (k, 3) array, metres and radians
        One a scan; scans with NaN in their pose are left out.
    resolution : float, metres
    free : bool
        Whether beams that met nothing count as free up to the sensor's largest range, where the
        log knows that. So it is in simulated rooms; a real sensor answers the same for a dark or
        slanted wall, which such rays then erase.
    **options
        Of `QuadtreeMap`; without a corner the map begins around the first pose.

    Returns
    -------
    QuadtreeMap

    Raises
    ------
    ValueError
        Where shapes disagree or a pose is infinite; naming the scan, where one is not finite or
        reaches beyond `max_size`.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("room")
    >>> build_map(log, log.truth, resolution=0.05)
    QuadtreeMap(25.6 m, 4279 leaves of 0.05 m and more, 61 scans)
    """
    where = _numbers(poses)
    if where.shape != (len(log), 3):
        raise ValueError(f"poses must have shape ({len(log)}, 3), one a scan, got {where.shape}")
    if np.isinf(where).any():
        raise ValueError(
            f"poses must not be infinite, got one at {np.isinf(where).any(1).argmax()}"
        )
    used = np.flatnonzero(np.isfinite(where).all(1)).tolist()
    map = QuadtreeMap(resolution=resolution, **options)
    if "corner" not in options and used:
        cells = np.floor(where[used[0], :2] / resolution) - np.round(map.side / resolution / 2)
        map = QuadtreeMap(resolution=resolution, corner=cells * resolution, **options)
    for k in used:
        sensor = compose(where[k], log[k].sensor_pose)
        ends = transform(where[k], log[k].points())
        try:
            map.insert_scan(sensor[:2], ends, unmet(log[k], sensor) if free else None)
        except ValueError as error:
            raise ValueError(f"scan {k}: {error}") from error
    return map


def _numbers(poses: ArrayLike) -> Array:
    """Poses as an array of floats."""
    try:
        return np.asarray(poses, float)
    except TypeError:
        kind = type(poses).__name__
        raise ValueError(
            f"poses must be an array (k, 3), got {kind}: of an alignment give `.poses`"
        ) from None


def unmet(scan: LaserScan, sensor: Array) -> Array:
    """Where beams that met nothing leave the sensor's range, `(m, 2)`, metres, in the map.

    Empty where the largest range is not known. `sensor` is the sensor's pose in the map.
    """
    if not np.isfinite(scan.max_range):
        return np.empty((0, 2))
    angle = sensor[2] + scan.angles[scan.ranges >= scan.max_range]
    return sensor[:2] + scan.max_range * np.stack([np.cos(angle), np.sin(angle)], -1)
