"""A log as arrays in an NPZ file of numpy's, for scripts of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..files import write_npz
from ..scans import Log


def write_arrays(path: str | Path, log: Log) -> None:
    """Write a log as arrays by name, as `read` takes it in.

    They are `ranges` and `angles`, `(k, n)`, where scans with fewer beams than the longest are
    filled up, and then `beams`, `(k,)`, counts those of each; `max_range`, `(k,)`; `sensor_pose`,
    `(k, 3)`, of the laser on the robot; and where the log has them `times`, `(k,)`, `odometry` and
    `truth`, `(k, 3)`, of the robot, NaN where a scan has none, `codes` and `delays`, `(k, n)`, with
    `order_known`, and what is `assumed`. The name must end in `.npz`. Beams that met nothing are
    infinite, those with an error NaN.

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
    write_npz(place, "log of segmap 1", log_arrays(log))


def log_arrays(log: Log) -> dict[str, NDArray[Any]]:
    """What a log holds, by the names of `write_arrays`; scans with fewer beams are filled up."""
    if not len(arrays.instance(log, "log", Log)):
        raise ValueError(f"log {log.name!r} must hold a scan")
    counts = np.array([len(scan) for scan in log])
    there = np.arange(counts.max()) < counts[:, None]

    def table(rows: list[Any], fill: float) -> NDArray[Any]:
        array = np.full(there.shape, fill)
        array[there] = np.concatenate(rows)
        return array

    far = [s.ranges >= s.max_range for s in log]  # beyond the sensor's reach: no measurement
    beams = [np.where(s.valid | ~f, s.ranges, np.inf) for s, f in zip(log, far, strict=True)]
    by_name: dict[str, NDArray[Any]] = {
        "ranges": table(beams, np.nan),
        "angles": table([scan.angles for scan in log], 0.0),
        "max_range": np.array([scan.max_range for scan in log]),
        "sensor_pose": np.array([scan.sensor_pose for scan in log]),
    }
    if not there.all():
        by_name["beams"] = counts
    for name, poses in (("odometry", log.odometry), ("truth", log.truth)):
        if poses is not None and np.isfinite(poses).all(1).any():
            by_name[name] = poses
    if all(scan.codes is not None for scan in log):
        by_name["codes"] = table([scan.codes for scan in log], 0)
    if any(scan.delays is not None for scan in log):
        rows = [np.full(len(s), np.nan) if s.delays is None else s.delays for s in log]
        by_name["delays"] = table(rows, np.nan)
        by_name["order_known"] = np.array(log.order_known)
    if np.isfinite(log.times).any():
        by_name["times"] = log.times
    if log.assumed:
        by_name["assumed"] = np.array(log.assumed)
    return by_name
