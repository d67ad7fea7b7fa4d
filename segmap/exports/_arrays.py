"""A log as arrays in an NPZ file of numpy's: for scripts of one's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .. import arrays
from ..files import write_npz
from ..scans import Log


def write_arrays(path: str | Path, log: Log) -> None:
    """Write a log as arrays by name, as `read` takes it in.

    They are `ranges` and `angles`, `(k, n)`, so that all scans must have one number of beams;
    `times` and `max_range`, `(k,)`; `sensor_pose`, `(k, 3)`, of the laser on the robot; and where
    the log has them `odometry` and `truth`, `(k, 3)`, of the robot, NaN where a scan has none,
    `codes` and `delays`, `(k, n)`, with `order_known`, and the odometry's `track`, `(m, 4)`. The
    name must end in `.npz`. Beams that met nothing are infinite, those with an error NaN.

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
        "ranges": np.array(  # those beyond the sensor's reach are no measurement
            [np.where(s.valid | ~(s.ranges >= s.max_range), s.ranges, np.inf) for s in log]
        ),
        "angles": np.array([scan.angles for scan in log]),
        "times": log.times,
        "max_range": np.array([scan.max_range for scan in log]),
        "sensor_pose": np.array([scan.sensor_pose for scan in log]),
    }
    for name, poses in (("odometry", log.odometry), ("truth", log.truth)):
        if poses is not None and np.isfinite(poses).all(1).any():
            held[name] = poses
    if all(scan.codes is not None for scan in log):
        held["codes"] = np.array([scan.codes for scan in log])
    if any(scan.delays is not None for scan in log):
        none = np.full(counts[0], np.nan)
        held["delays"] = np.array([none if s.delays is None else s.delays for s in log])
        held["order_known"] = np.array(log.order_known)
    if log.track is not None:
        held["track"] = log.track
    write_npz(place, "log of segmap 1", held)
