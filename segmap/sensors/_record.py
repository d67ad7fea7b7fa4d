"""Scans as they arrive: recorded, whole or not at all; or only the newest for a slow reader."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Count, checked
from ..files import replacing, shown, writable
from ..scans import LaserScan
from ..scans.error_codes import LOWEST, NOT_MEASURED_CODE, NOTHING_MET_CODE, told_in_a_text
from ._host import one_by_one
from ._sensor import UrgSensor

#: First line of a Hokuyo text, which names its columns.
HOKUYO_HEAD = "# urg_mm angle_rad\n"
#: Endings of CARMEN logs; any other path is a folder of Hokuyo texts.
CARMEN = (".log", ".clf", ".carmen")
#: The texts do not say which sensor they are of; readers take them for those of a URG-04LX, metres.
TEXT_REACH = 5.6


@checked
def record(
    sensor: UrgSensor | Iterable[LaserScan], path: str | Path, *, count: Count | None = None
) -> int:
    """Append scans to a log as they arrive; `segmap.read` takes it in again.

    A path that ends in .log, .clf or .carmen is a CARMEN log of RAWLASER1 lines, which keeps times,
    ranges to the micrometre, and errors as 0. Any other is a folder of Hokuyo texts, a file a scan,
    which keeps millimetres to 5.6 m and error codes, as of a URG-04LX, and no times. A scan is
    written when it comes: a recorder that is killed loses the one that it was in.

    Parameters
    ----------
    path : str or Path
        Scans are added to what is there.
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
        For a packed file, which cannot be added to, or what is neither a file nor a folder; for a
        scan that `read` would refuse: without beams, or without a time or with beams not evenly
        spaced in a CARMEN log; for ranges beyond 5.6 m in a folder.
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
    target = check_target(path)
    scans = one_by_one(sensor.scans() if isinstance(sensor, UrgSensor) else sensor, "sensor")
    written = 0
    if target.suffix.lower() in CARMEN:
        for scan in islice(scans, count):
            line = _rawlaser(scan)
            with target.open("a", encoding="ascii", newline="\n") as file:
                file.write(line + "\n")
            written += 1
        return written
    target.mkdir(exist_ok=True)
    names = (file.stem.removeprefix("scan") for file in target.glob("scan*.txt"))
    before = max((int(name) for name in names if name.isdigit()), default=0)
    for scan in islice(scans, count):
        written += 1
        _write_file(target, before + written, scan)
    return written


def check_target(path: str | Path, count: int | None = None) -> Path:
    """Where a recording goes, tried out: no sensor need be asked for scans that cannot be kept."""
    target = arrays.file(path)
    if count is not None:
        arrays.whole(count, "count")
    if target.suffix.lower() == ".gz":
        raise ValueError(f"{shown(target.name)}: a packed file cannot be added to, leave .gz out")
    if target.suffix.lower() in CARMEN:
        writable(target)
    elif target.exists() and not target.is_dir():
        said = f"{path} is a file: name a folder, or a log that ends in {CARMEN[0]}"
        raise ValueError(shown(said))
    else:
        writable(target / "scan" if target.is_dir() else target)
    return target


def _rawlaser(scan: LaserScan) -> str:
    """RAWLASER1 type start field step maximum accuracy mode n ranges 0 time host time."""
    _check_recordable(scan)
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


def _check_recordable(scan: LaserScan) -> None:
    if not len(arrays.instance(scan, "scan", LaserScan)):
        raise ValueError("a scan must have at least one beam, got none")


def _write_file(folder: Path, number: int, scan: LaserScan) -> None:
    """Write a hidden file beside the place, then move it there."""
    _check_recordable(scan)
    if (far := scan.ranges[scan.valid].max(initial=0.0)) >= TEXT_REACH:
        raise ValueError(
            f"a folder of Hokuyo texts is read as a URG-04LX's, to {TEXT_REACH} m, but a range is "
            f"{far:.3f} m: record to a path that ends in {CARMEN[0]}"
        )
    beams = zip(_millimetres(scan), scan.angles, strict=True)
    with replacing(folder / f"scan{number:06}.txt", sync=False) as target:
        lines = [HOKUYO_HEAD, *(f"{r} {a:.9f}\n" for r, a in beams)]
        target.write("".join(lines).encode("ascii"))


def _millimetres(scan: LaserScan) -> NDArray[np.int64]:
    """Ranges in millimetres as the sensor gave them, and codes for beams without a range."""
    codes = np.zeros(len(scan), np.int64) if scan.codes is None else scan.codes
    met: Array = np.rint(1000 * np.where(np.isposinf(scan.ranges), 0.0, scan.ranges))
    is_range = met >= LOWEST
    instead = np.where(np.isposinf(scan.ranges), NOTHING_MET_CODE, NOT_MEASURED_CODE)
    codes = np.where(told_in_a_text(scan.ranges, codes), codes, instead)
    return np.where(is_range, met, codes).astype(np.int64)
