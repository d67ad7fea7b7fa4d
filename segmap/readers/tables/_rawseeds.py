"""Rawseeds folders: a file a sensor, comma-separated, metres, radians and seconds.

    SICK_FRONT.csv, SICK_REAR.csv       t, count, offset [quarter degrees], 181 ranges
    HOKUYO_FRONT.csv, HOKUYO_REAR.csv   t, 681 ranges
    ODOMETRY_XYT.csv                    t, rolling counter, ticks right, ticks left, x, y, theta
    GROUNDTRUTH.csv                     t, x, y, theta, 9 covariances

A name may have more before it (`bicocca-2009-02-25b-SICK_FRONT.csv`), and `.gz` after it. One laser
is read: the first that the folder has of the order above, so the front SICK where there is one.

The SICK's beams are one degree apart from -90 degrees plus the offset on; the Hokuyo's 360/1024
degree, the middle one straight ahead; values below 20 mm are its error codes. The files do not say
where on the robot a laser sits: it is taken to be the robot's centre, rear ones facing backwards.
Odometry and truth are interpolated at the time of each scan; outside of what they cover, and for
the truth in gaps longer than a second, a scan has none.

A file of a laser may be read alone: scans without odometry and truth.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ...arrays import LIMIT, Array
from ...poses import interpolate
from ...scans import NOTHING_SKIPPED, Log, Skipped
from ...scans.error_codes import as_ranges
from .._lines import Lines, LogError, counted, is_number, merged, numbers, pose, time
from .._raw_scans import (
    URG_REACH,
    URG_STEP,
    RawScan,
    Track,
    assemble,
    centred,
    half_turn,
    uncorrected,
)

LASERS = ("SICK_FRONT", "HOKUYO_FRONT", "SICK_REAR", "HOKUYO_REAR")
ODOMETRY, TRUTH = "ODOMETRY_XYT", "GROUNDTRUTH"
PATTERN = re.compile(rf"({'|'.join((*LASERS, ODOMETRY, TRUTH))})\.csv(\.gz)?$", re.IGNORECASE)
#: Columns of the files, by which they are told apart.
SICK_HEAD, HOKUYO_COLUMNS, ODOMETRY_COLUMNS, TRUTH_COLUMNS = 3, 682, 7, 13
#: Ground truth is not interpolated over more seconds than this: it exists only in some places.
TRUTH_GAP = 1.0


def claims(fields: Sequence[str]) -> bool:
    """Whether a line, split at commas, is one of these files."""
    return len(fields) >= ODOMETRY_COLUMNS and is_number(fields[0])


def files_of(folder: Path) -> dict[str, Path]:
    """The files of a recording in a folder, by sensor."""
    found = ((PATTERN.search(path.name), path) for path in sorted(folder.iterdir()))
    return {match[1].upper(): path for match, path in found if match}


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read the file of one laser: times in seconds, no odometry."""
    return _read(path, name, {}, on_error)


def read_folder(files: Mapping[str, Path], name: str, on_error: str = "raise") -> Log:
    """Read the files of a recording, see `files_of`; `truth` is `(k, 3)`, metres and radians."""
    lasers = [laser for laser in LASERS if laser in files]
    if not lasers:
        folder = next(iter(files.values())).parent
        raise LogError(folder, f"holds no scans, expected {LASERS[0]}.csv or {LASERS[1]}.csv")
    return _read(files[lasers[0]], name, files, on_error)


def read_trajectory(path: Path, on_error: str = "raise") -> tuple[Array, Array, Skipped]:
    """Times `(k,)` in seconds, poses `(k, 3)` of a file of poses, and what was skipped."""
    lines, track = Lines(path, on_error, ","), Track()
    for when, where in lines.each(_parse_pose):
        track.add(when, where)
    if not track.times:
        raise LogError(path, "holds no pose, expected lines t, x, y, theta, 9 covariances")
    return *track.ordered(), lines.skipped


def _read(path: Path, name: str, files: Mapping[str, Path], on_error: str) -> Log:
    lines = Lines(path, on_error, ",")
    raw = list(lines.each(_parse_scan))
    if not raw:
        raise lines.no_scan("lines of a SICK or Hokuyo file")
    times = np.array([scan.time for scan in raw], float)
    odometry, skipped = _poses_at(times, files.get(ODOMETRY), on_error)
    truth, more = _poses_at(times, files.get(TRUTH), on_error, TRUTH_GAP)
    raw = [scan._replace(odometry=o) for scan, o in zip(raw, odometry, strict=True)]
    place = np.array([0.0, 0.0, np.pi if "REAR" in path.name.upper() else 0.0])
    scans, _ = assemble(raw, lambda laser, mine: uncorrected(mine, place))
    known = truth if np.isfinite(truth).any() else None
    return Log(name, scans, known, merged(lines.skipped, merged(skipped, more)))


def _poses_at(
    times: Array, path: Path | None, on_error: str, gap: float = np.inf
) -> tuple[Array, Skipped]:
    if path is None:
        return np.full((len(times), 3), np.nan), NOTHING_SKIPPED
    when, poses, skipped = read_trajectory(path, on_error)
    return interpolate(when, poses, times, max_gap=gap), skipped


def _parse_scan(fields: list[str]) -> RawScan:
    columns = [field.strip() for field in fields]
    if len(columns) == HOKUYO_COLUMNS:
        return _parse_hokuyo(columns)
    if len(columns) in (ODOMETRY_COLUMNS, TRUTH_COLUMNS):
        raise ValueError(
            "holds poses and no scan: read its folder, or the poses with read_trajectory"
        )
    if len(columns) < SICK_HEAD:
        raise ValueError(f"expected t, count, offset and ranges, got {len(columns)} columns")
    ranges, rest = counted([columns[1], *columns[SICK_HEAD:]], "ranges")
    if rest:
        raise ValueError(f"announces {len(ranges)} ranges, but {len(ranges) + len(rest)} follow")
    (quarters,) = numbers(columns[2:3], "the offset")
    if not abs(quarters) <= 720:
        raise ValueError(f"expected an offset in quarter degrees, got {columns[2][:40]}")
    angles = half_turn(len(ranges)) + np.radians(quarters / 4)
    return RawScan("sick", numbers(ranges, "ranges"), angles, time(columns[0]))


def _parse_hokuyo(columns: list[str]) -> RawScan:
    ranges, codes = as_ranges(1000 * np.clip(numbers(columns[1:], "ranges"), -LIMIT, LIMIT))
    angles = centred(len(ranges), URG_STEP)
    return RawScan("hokuyo", ranges, angles, time(columns[0]), limit=URG_REACH, codes=codes)


def _parse_pose(fields: list[str]) -> tuple[float, Array]:
    if len(fields) == ODOMETRY_COLUMNS:
        return time(fields[0].strip()), pose(fields[4:7], "the odometry")
    if len(fields) == TRUTH_COLUMNS:
        return time(fields[0].strip()), pose(fields[1:4], "the ground truth")
    raise ValueError(
        f"expected {TRUTH_COLUMNS} columns of ground truth or {ODOMETRY_COLUMNS} of odometry, "
        f"got {len(fields)}"
    )
