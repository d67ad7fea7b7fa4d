"""Scans as they arrive, recorded whole or not at all."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice
from pathlib import Path

import numpy as np

from .. import arrays
from ..arrays import Count, checked
from ..files import shown, writable
from ..scans import LaserScan
from ._host import one_by_one
from ._sensor import UrgSensor

#: Endings of CARMEN logs.
CARMEN = (".log", ".clf", ".carmen")


@checked
def record(
    sensor: UrgSensor | Iterable[LaserScan], path: str | Path, *, count: Count | None = None
) -> int:
    """Append scans to a CARMEN log as they arrive; `segmap.read` takes it in again.

    Its RAWLASER1 lines keep times, ranges to the micrometre, and errors as 0. A scan is written
    when it comes: a recorder that is killed loses the one that it was in.

    Parameters
    ----------
    path : str or Path
        Ends in .log, .clf or .carmen; scans are added to what is there.
    count : int or None
        Stop after so many; None goes on until the scans end, or an interrupt.

    Returns
    -------
    int
        Scans written.

    Raises
    ------
    SensorError
        As `UrgSensor.scans`; what came before is kept.
    ValueError
        For a file of another name, or what is no file; for a scan that `read` would refuse: without
        beams or a time, or with beams that are not evenly spaced.
    OSError
        A folder that does not exist or may not be written to, before a scan is asked for; a full
        disk.

    Examples
    --------
    >>> import tempfile
    >>> from segmap import LaserScan, read
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     record([LaserScan([1.0, 2.0], [0.0, 0.1], max_range=4.0)], folder + "/one.log")
    ...     read(folder + "/one.log")
    1
    Log('one', 1 scan, no odometry, no truth)
    """
    target, written = check_target(path), 0
    scans = one_by_one(sensor.scans() if isinstance(sensor, UrgSensor) else sensor, "sensor")
    for scan in islice(scans, count):
        line = _rawlaser(scan)
        with target.open("a", encoding="ascii", newline="\n") as file:
            file.write(line + "\n")
        written += 1
    return written


def check_target(path: str | Path, count: int | None = None) -> Path:
    """Where a recording goes, tried out: no sensor need be asked for scans that cannot be kept."""
    target = arrays.file(path)
    if count is not None:
        arrays.whole(count, "count")
    if target.suffix.lower() not in CARMEN:
        raise ValueError(f"{shown(target.name)} must end in {', '.join(CARMEN)}")
    writable(target)
    return target


def _rawlaser(scan: LaserScan) -> str:
    """RAWLASER1 type start field step maximum accuracy mode n ranges 0 time host time."""
    if not len(arrays.instance(scan, "scan", LaserScan)):
        raise ValueError("a scan must have at least one beam, got none")
    step = float(scan.angles[-1] - scan.angles[0]) / max(len(scan) - 1, 1)
    even = scan.angles[:1] + step * np.arange(len(scan))
    if step < 0:
        raise ValueError("a CARMEN log holds angles that count up: turn angles and ranges round")
    if np.abs(scan.angles - even).max() > 1e-6:
        raise ValueError("a CARMEN log holds scans of at least one beam, evenly spaced")
    if not np.isfinite(scan.time):
        raise ValueError(f"a CARMEN log holds the time of each scan, in seconds, got {scan.time}")
    limit = scan.max_range if np.isfinite(scan.max_range) else 81.83
    met = np.where(scan.valid, scan.ranges, np.where(np.isnan(scan.ranges), 0.0, limit))
    ranges = " ".join(f"{value:.6f}".rstrip("0").rstrip(".") for value in met)
    turn = f"{float(scan.angles[0])!r} {step * (len(scan) - 1)!r} {step!r} {limit:.6f}"
    stamp = f"{scan.time:.6f}"
    return f"RAWLASER1 0 {turn} 0.010 0 {len(scan)} {ranges} 0 {stamp} segmap {stamp}"
