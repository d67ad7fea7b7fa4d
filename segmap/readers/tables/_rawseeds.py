"""Rawseeds folders: a file a sensor, comma-separated, metres, radians and seconds.

    SICK_FRONT.csv, SICK_REAR.csv       t, count, offset [quarter degrees], 181 ranges
    HOKUYO_FRONT.csv, HOKUYO_REAR.csv   t, 681 ranges
    ODOMETRY_XYT.csv                    t, rolling counter, ticks right, ticks left, x, y, theta
    GROUNDTRUTH.csv                     t, x, y, theta, 9 covariances

A name may have more before it (`bicocca-2009-02-25b-SICK_FRONT.csv`), and `.gz` after it. One laser
is read: the first that the folder has of the order above, so the front SICK where there is one.

The SICK's beams are one degree apart from -90 degrees plus the offset on; the Hokuyo's 360/1024
degree, the middle one straight ahead; values below 20 mm are its error codes.
Odometry and truth are interpolated at the time of each scan; outside of what they cover, and for
the truth in gaps longer than a second, a scan has none.

A file of a laser may be read alone: scans without odometry and truth.

Assumed: a laser sits at the robot's centre, rear ones face backwards; a Hokuyo is a URG-04LX.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...arrays import LIMIT
from ...poses import interpolate
from ...scans import Log
from ...scans.error_codes import as_ranges
from .._lines import (
    Lines,
    LogError,
    counted_fields,
    float_fields,
    is_number,
    merged_skipped,
    time,
)
from .._raw_scans import (
    NOWHERE,
    URG_ASSUMED,
    URG_REACH,
    URG_STEP,
    Extrinsic,
    RawScan,
    centred,
    half_turn,
    known_truth,
    uncorrected,
    urg_delays,
)
from .._text import TextFormat
from ._trajectories import track_in

RAWSEEDS_LASERS = ("SICK_FRONT", "HOKUYO_FRONT", "SICK_REAR", "HOKUYO_REAR")
#: What the name of the file of odometry holds.
RAWSEEDS_ODOMETRY = "ODOMETRY_XYT"
#: What the name of the file of the truth holds.
RAWSEEDS_TRUTH = "GROUNDTRUTH"
PATTERN = re.compile(
    rf"({'|'.join((*RAWSEEDS_LASERS, RAWSEEDS_ODOMETRY, RAWSEEDS_TRUTH))})\.csv(\.gz)?$",
    re.IGNORECASE,
)
#: Columns before the ranges in a file of a SICK.
SICK_HEAD_COLUMNS = 3
#: Columns of a file of a Hokuyo.
HOKUYO_COLUMNS = 682
#: Columns of the file of odometry.
ODOMETRY_COLUMNS = 7
#: Columns of the file of the truth.
TRUTH_COLUMNS = 13
#: Ground truth is not interpolated over more seconds than this: it exists only in some places.
TRUTH_GAP = 1.0


class Rawseeds(TextFormat):
    """The file of one laser; with it odometry and truth, where its folder is read."""

    by_shape = True
    name, separator = "Rawseeds", ","
    expected = "lines of a SICK or Hokuyo file"

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line, split at commas, is one of these files."""
        return is_number(fields[0]) and (
            len(fields) in (ODOMETRY_COLUMNS, TRUTH_COLUMNS, HOKUYO_COLUMNS)
            or fields[1:2] == [f" {len(fields) - SICK_HEAD_COLUMNS}"]
            or fields[1:2] == [str(len(fields) - SICK_HEAD_COLUMNS)]
        )

    def _take(self, fields: list[str]) -> None:
        self.scans.append(_rawseeds_scan([field.strip() for field in fields]))

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        backwards = np.pi if "REAR" in self.lines.path.name.upper() else 0.0
        return uncorrected(scans, np.array([0.0, 0.0, backwards]))


def files_of(folder: Path) -> dict[str, Path]:
    """The files of a recording in a folder, by sensor."""
    found = ((PATTERN.search(path.name), path) for path in sorted(folder.iterdir()))
    return {match[1].upper(): path for match, path in found if match}


def read_folder(folder: Path, name: str, on_error: str = "raise") -> Log:
    """Read a recording: of its first laser, with odometry and truth at the times of the scans."""
    files = files_of(folder)
    lasers = [laser for laser in RAWSEEDS_LASERS if laser in files]
    if not lasers:
        raise LogError(
            folder, f"holds no scans, expected {RAWSEEDS_LASERS[0]}.csv or {RAWSEEDS_LASERS[1]}.csv"
        )
    found = Rawseeds(Lines(files[lasers[0]], on_error, ",")).walked()
    times = np.array([scan.time for scan in found.scans])
    truth = np.full((len(times), 3), np.nan)
    if RAWSEEDS_ODOMETRY in files:
        found.track, reading = track_in(files[RAWSEEDS_ODOMETRY], on_error)
        found.unknown = merged_skipped(found.unknown, reading.skipped)
    if RAWSEEDS_TRUTH in files:
        track, reading = track_in(files[RAWSEEDS_TRUTH], on_error)
        truth = interpolate(*track.ordered(), times, max_gap=TRUTH_GAP)
        found.unknown = merged_skipped(found.unknown, reading.skipped)
    return replace(found._log(name), truth=known_truth(truth))


def _rawseeds_scan(columns: list[str]) -> RawScan:
    if len(columns) == HOKUYO_COLUMNS:
        metres = np.clip(float_fields(columns[1:], "ranges"), -LIMIT, LIMIT)
        found, codes = as_ranges(1000 * metres)
        angles, when = centred(len(found), URG_STEP), time(columns[0])
        turn = codes, urg_delays(angles), (URG_ASSUMED,)
        return RawScan("hokuyo", found, angles, when, NOWHERE, NOWHERE, URG_REACH, *turn)
    if len(columns) in (ODOMETRY_COLUMNS, TRUTH_COLUMNS):
        raise ValueError(
            "holds poses and no scan: read its folder, or the poses by --truth and read_trajectory"
        )
    if len(columns) < SICK_HEAD_COLUMNS:
        raise ValueError(f"expected t, count, offset and ranges, got {len(columns)} columns")
    ranges, rest = counted_fields([columns[1], *columns[SICK_HEAD_COLUMNS:]], "ranges")
    if rest:
        raise ValueError(f"announces {len(ranges)} ranges, but {len(ranges) + len(rest)} follow")
    (quarters,) = float_fields(columns[2:3], "the offset")
    if not abs(quarters) <= 720:
        raise ValueError(f"expected an offset in quarter degrees, got {columns[2][:40]}")
    angles = half_turn(len(ranges)) + np.radians(quarters / 4)
    return RawScan("sick", float_fields(ranges, "ranges"), angles, time(columns[0]))
