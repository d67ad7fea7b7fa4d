"""Poses of a robot with their times, in a file of their own: odometry or truth of any log.

    t x y z qx qy qz qw                       TUM
    t, x, y, theta                            with or without a head
    t, x, y, theta, 9 covariances             Rawseeds, the truth
    t, counter, ticks, ticks, x, y, theta     Rawseeds, ODOMETRY_XYT.csv
    #timestamp [ns], p_x [m], p_y [m], ..., q_w [], q_x [], ...      a head that names them

Metres, radians and seconds where no name says another unit; times since 1970 may be in any, and may
be texts.

Assumed: poses are the robot's.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ... import arrays
from ...arrays import Array, checked
from ...poses import interpolate
from ...scans import Log
from .._lines import Lines, LogError, OnError, float_fields, is_number, pose_fields, time
from .._mounting import in_space, level
from .._raw_scans import Track, known, known_truth
from ..packed import log_file
from ._columns import COLUMN_UNITS, SINCE_1970
from ._fields import decimal, moment, sample, separator_of, split

#: Where time, x, y and heading, or a quaternion x, y, z, w, stand in lines of so many fields.
POSE_LINES = {4: (0, 1, 2, 3), 7: (0, 4, 5, 6), 8: (0, 1, 2, 4, 5, 6, 7), 13: (0, 1, 2, 3)}
#: How columns of a head are called, by their last words.
POSE_WORDS = {
    "time": "time timestamp stamp t secs",
    "x": "x px tx",
    "y": "y py ty",
    "heading": "theta yaw heading phi psi angle th rz",
    **{f"q{axis}": rf"q(_\w+)?_?{axis}" for axis in "xyzw"},
}
#: True poses farther apart than this, in usual steps, say nothing between; nor in seconds.
LONGEST_TRUTH_GAP_STEPS = 3
LONGEST_TRUTH_GAP_S = 1.0


class PoseLine(NamedTuple):
    """Where in a line time, x, y, and the heading or a quaternion stand; the line of the head."""

    separator: str | None
    places: tuple[int, ...]
    line: int = 0
    second: float = 1.0  #: of the times
    radian: float = 1.0  #: of the heading
    length: int = 0  #: how many fields, where no head says what they are


def pose_line_of(path: Path) -> PoseLine:
    """How a file of poses is written: by its head, or by how many fields most lines have."""
    lines = [(k, text) for k, text in sample(path) if text.strip("#, ")]
    rows = [text for _, text in lines if not text.startswith("#")]
    separator = separator_of(rows)
    for number, text in lines[:20]:
        names = split(text.lstrip("# "), separator_of([text]) or separator)
        if (found := _by_names(names)) is not None:
            return found._replace(separator=separator, line=number)
    counts = [len(split(text, separator)) for text in rows]
    count = max(set(counts), key=counts.count, default=0)
    if count not in POSE_LINES:
        count = 13
    first = [split(text, separator) for text in rows if len(split(text, separator)) == count]
    when = [float(row[0]) for row in first if is_number(row[0])]
    second = next((f for least, f in SINCE_1970 if when and least <= min(when)), 1.0)
    return PoseLine(separator, POSE_LINES[count], 0, second, length=count)


def _by_names(names: Sequence[str]) -> PoseLine | None:
    """What a head says; None of another line."""
    places: dict[str, int] = {}
    units: dict[str, list[str]] = {}
    for place, name in enumerate(names):
        bare = re.sub(r"[\[(].*", "", name).strip().lower()
        units_said = re.findall(r"[a-zµ°]+", name.lower())[1:]
        for role, words in POSE_WORDS.items():
            if any(
                re.fullmatch(rf"(.*[._/ ])?{word}(_(s|ms|us|ns|m|rad|deg))?", bare)
                for word in words.split()
            ):
                places.setdefault(role, place)
                units.setdefault(role, units_said)
    turned = ("heading",) if "heading" in places else ("qx", "qy", "qz", "qw")
    wanted = ("time", "x", "y", *turned)
    if not {*wanted} <= {*places}:
        return None
    second, radian = (
        next((f for word, f in COLUMN_UNITS[kind].items() if word in units.get(role, [])), 1.0)
        for role, kind in (("time", "time"), ("heading", "angle"))
    )
    return PoseLine(None, tuple(places[role] for role in wanted), 0, second, radian)


def track_in(path: Path, on_error: str) -> tuple[Track, Lines]:
    """The poses of a file, and what of it was left out."""
    lines, track = Lines(path, on_error, "\n"), Track()
    form = pose_line_of(path)

    def pose_of(fields: list[str]) -> tuple[float, Array] | None:
        if lines.number <= form.line:
            return None
        found = [*map(decimal, split(fields[0], form.separator))]
        if len(found) <= max(form.places) or (form.length and len(found) != form.length):
            raise ValueError(
                f"expected 13 columns of ground truth, 7 of odometry, 4 of t, x, y, theta or 8 of "
                f"TUM, got {len(found)}"
            )
        when, x, y, *turn = (found[k] for k in form.places)
        seconds = time(when, unit=form.second) if is_number(when) else moment(when)
        if not np.isfinite(seconds):
            raise ValueError(f"expected a time, got {when[:40]!r}")
        if len(turn) == 1:
            (heading,) = float_fields(turn, "the heading") * form.radian
            return seconds, pose_fields([x, y, repr(float(heading))], "the pose")
        place = float_fields([x, y], "the pose")
        qx, qy, qz, qw = float_fields(turn, "the quaternion")
        return seconds, level(in_space((*place, 0.0), (qw, qx, qy, qz)))

    for pose in lines.each(pose_of):
        if pose is not None:
            track.add(*pose)
    if not track.times:
        raise LogError(path, "holds no pose, expected lines t, x, y, theta or t x y z qx qy qz qw")
    return track, lines


@checked
def read_trajectory(path: str | Path, *, on_error: OnError = "raise") -> tuple[Array, Array]:
    """Read a file of poses: of TUM, of t, x, y, theta, with a head, or one of Rawseeds.

    Damage is as in `read`. Returned are times `(k,)`, ascending, and poses `(k, 3)`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "GROUNDTRUTH.csv"
    ...     _ = path.write_text("10.5, 1, 2, 0.5" + ", 0" * 9)
    ...     read_trajectory(path)
    (array([10.5]), array([[1. , 2. , 0.5]]))
    """
    with log_file(path) as place:
        return track_in(place, on_error)[0].ordered()


@checked
def with_trajectories(
    log: Log, *, odometry: str | Path | None = None, truth: str | Path | None = None
) -> Log:
    """A log with the odometry or the truth that a file of poses holds, at the times of its scans.

    Parameters
    ----------
    odometry, truth : str, Path or None
        A file that `read_trajectory` reads, with the clock of the log. None leaves what it has.

    Raises
    ------
    LogError
        Such a file is damaged, or none of its times lies near those of the scans.

    Examples
    --------
    >>> import tempfile
    >>> from segmap import LaserScan
    >>> log = Log("it", [LaserScan([1.0], [0.0], time=1.5)])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "it.tum"
    ...     _ = path.write_text("1 0 0 0 0 0 0 1\\n2 2 0 0 0 0 0 1\\n")
    ...     with_trajectories(log, truth=path).truth
    array([[1., 0., 0.]])
    """
    arrays.instance(log, "log", Log)
    given = {"odometry": odometry, "truth": truth}
    files = {word: arrays.file(path, word) for word, path in given.items() if path is not None}
    scans, right, assumed = list(log), log.truth, list(log.assumed)
    track, causes, times = log.track, list(log.causes), log.times
    if "odometry" in files:
        met = _track_of(files["odometry"], log).met(times)
        pairs = zip(log, met.times.tolist(), met.poses, strict=True)
        scans = [replace(scan, time=when, odometry=known(pose)) for scan, when, pose in pairs]
        dense = len(met.track) > len(scans) or np.isnan(met.poses).any()
        track, times = met.track if dense else None, met.times
        causes += met.causes
    if "truth" in files:
        known_times, poses = _track_of(files["truth"], log).ordered()
        usual = float(np.median(np.diff(known_times))) if len(known_times) > 1 else 0.0
        gap = max(LONGEST_TRUTH_GAP_S, LONGEST_TRUTH_GAP_STEPS * usual)
        right = known_truth(interpolate(known_times, poses, times, max_gap=gap))
    assumed += [f"poses of {path.name} are the robot's" for path in files.values()]
    return Log(log.name, scans, right, log.skipped, track, log.order_known, causes, assumed)


def _track_of(path: Path, log: Log) -> Track:
    """The poses of a file, some of which lie within the time of the scans."""
    with log_file(path) as place:
        found, _ = track_in(place, "raise")
        scans = log.times[np.isfinite(log.times)]
        if not len(scans):
            raise LogError(place, "cannot be used: the scans of the log have no times")
        first, last = min(found.times), max(found.times)
        if not ((first <= scans) & (scans <= last)).any():
            raise LogError(
                place,
                f"its poses are from {first:.3f} to {last:.3f} s, and the scans from "
                f"{scans.min():.3f} to {scans.max():.3f} s: it has another clock",
            )
        return found
