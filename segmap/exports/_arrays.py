"""A log as arrays in an NPZ file of numpy's: for scripts of one's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .. import arrays
from ..arrays import Array
from ..files import write_npz
from ..poses import compose
from ..scans import LaserScan, Log


def write_arrays(path: str | Path, log: Log) -> None:
    """Write a log as `ranges`, `angles`, `times`, `odometry` and `truth`, as `read` takes it in.

    Ranges and angles are `(k, n)`, metres and radians, times `(k,)`, seconds. The format does not
    tell where the laser sits on the robot: the poses, `(k, 3)`, NaN where a scan has none, become
    those of the laser. Beams that met nothing are infinite, those with an error NaN.

    Parameters
    ----------
    path : str or Path
        Ends in `.npz`.
    log : Log

    Raises
    ------
    ValueError
        For another name; a log without scans, or whose scans differ in their number of beams.
    OSError
        A folder that does not exist, or cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> from segmap import load, read
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_arrays(Path(folder) / "it.npz", load("room"))
    ...     read(Path(folder) / "it.npz")
    Log('it', 61 scans, odometry, truth)
    """
    place = arrays.file(path)
    if place.suffix != ".npz":
        raise ValueError(f"path: the name must end in .npz, got {place.name!r}")
    counts = sorted({len(scan) for scan in arrays.instance(log, "log", Log)})
    if len(counts) != 1:
        raise ValueError(
            f"log {log.name!r} must have scans of one number of beams, got {counts or 'no scan'}"
        )
    held = {
        "ranges": np.array([_ranges(scan) for scan in log]),
        "angles": np.array([scan.angles for scan in log]),
        "times": log.times,
    }
    for name, poses in (("odometry", log.odometry), ("truth", log.truth)):
        if poses is not None and np.isfinite(poses).all(1).any():
            held[name] = compose(poses, np.array([scan.sensor_pose for scan in log]))
    write_npz(place, "log of segmap 1", held)


def _ranges(scan: LaserScan) -> Array:
    """Ranges, metres: those beyond the sensor's reach are no measurement."""
    return np.where(scan.valid | ~(scan.ranges >= scan.max_range), scan.ranges, np.inf)
