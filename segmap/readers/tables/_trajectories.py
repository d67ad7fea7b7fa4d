"""Poses of a robot with their times, in a file of their own: odometry or truth of any log.

    t x y z qx qy qz qw                       TUM
    t, x, y, theta                            with or without a head
    t, x, y, theta, 9 covariances             Rawseeds, the truth
    t, counter, ticks, ticks, x, y, theta     Rawseeds, ODOMETRY_XYT.csv
    #timestamp [ns], p_x [m], p_y [m], ..., q_w [], q_x [], ...      a head that names them

    %time,field.header.stamp,field.pose.pose.position.x,...          rostopic echo -p of an Odometry
    sec,nanosec,odom,base_link,x,y,z,qx,qy,qz,qw,...                 ros2 topic echo --csv of one

Metres, radians and seconds where no name says another unit; times since 1970 may be in any, and may
be texts. Headings that span more than a turn, and jump, are degrees.

Assumed: poses are the robot's.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
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
from ._columns import SINCE_1970, named
from ._fields import decimal, moment, sample, separator_of, split

#: Where time, x, y and heading, or a quaternion x, y, z, w, stand in lines of so many fields.
POSE_LINES = {4: (0, 1, 2, 3), 7: (0, 1, 2, 6), 8: (0, 1, 2, 4, 5, 6, 7), 13: (0, 1, 2, 3)}
#: The same of the odometry of Rawseeds, whose first columns are whole numbers.
TICKS_LINE = (0, 4, 5, 6)
#: The same of what `ros2 topic echo --csv` writes of an Odometry: seconds, nanoseconds, two frames.
ODOMETRY_LINE = (0, 4, 5, 7, 8, 9, 10)
#: A part of a quaternion, and whose it is.
QUATERNION = re.compile(r"(.*[._/ ])?(?:q|quat\w*|orientation|rotation)(?:[._/].*)?[._/]?([xyzw])")
#: Of poses of KITTI, and of x, y, theta alone.
NO_TIMES = ": poses without times, a first column of them is needed"
#: So many lines are looked at for a head.
POSE_HEAD_LINES = 20
#: Numbers beyond this tell nothing.
MOST_TOLD = 1e20
#: Columns of a pose that is none of the robot's.
OTHER_POSES = re.compile("twist|linear|angular|vel|covariance|target|goal|cmd|desired|set")
#: True poses farther apart than this, in usual steps, say nothing between; nor in seconds.
LONGEST_TRUTH_GAP_STEPS = 3
LONGEST_TRUTH_GAP_S = 1.0


class PoseLine(NamedTuple):
    """Where in a line time, x, y, and the heading or a quaternion stand; the line of the head."""

    separator: str | None
    places: tuple[int, ...]
    line: int = 0
    factors: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)  #: what makes seconds, metres and radians
    length: int = 0  #: how many fields, where no head says what they are
    told: tuple[str, ...] = ()


def pose_line_of(path: Path) -> PoseLine:
    """How a file of poses is written: by its head, or by how many fields most lines have."""
    lines = [(k, text) for k, text in sample(path) if text.strip("#, ")]
    rows = [text for _, text in lines if not text.startswith("#")]
    separator = separator_of(rows)
    table = [[*map(decimal, split(text, separator))] for text in rows]
    for (number, text), (_, below) in pairwise([*lines[:POSE_HEAD_LINES], (0, "")]):
        mark = separator_of([text]) or separator
        names, units = split(text.lstrip("# "), mark), split(below, mark)
        if len(units) == len(names) and not any(is_number(decimal(unit)) for unit in units):
            names = [f"{name} {unit}" for name, unit in zip(names, units, strict=True)]
            number += 1
        if found := _by_names(names, path):
            places, factors = zip(*found, strict=True)
            return _with_pose_units(PoseLine(separator, places, number), factors, table)
    counts = [len(row) for row in table]
    count = max(set(counts), key=counts.count, default=0)
    first = [row for row in table if len(row) == count]
    if count > max(POSE_LINES) and not any(is_number(field) for field in first[0][2:4]):
        return PoseLine(separator, ODOMETRY_LINE, length=count)
    if count not in POSE_LINES:
        count = 13
    places = POSE_LINES[count]
    if count == 7 and all(is_number(f) and float(f) % 1 == 0 for row in first for f in row[1:4]):
        places = TICKS_LINE
    return _with_pose_units(PoseLine(separator, places, length=count), (None, 1, 1, None), table)


def _with_pose_units(
    form: PoseLine, factors: Sequence[float | None], table: Sequence[Sequence[str]]
) -> PoseLine:
    """What is said of units, and else what the numbers tell: times since 1970, degrees."""
    told, used = [], [factor or 1.0 for factor in factors]
    rows = [row for row in table if len(row) > max(form.places)]
    columns = ([float(r[k]) for r in rows if is_number(r[k])] for k in form.places)
    when, *_, turn = ([v for v in column if abs(v) <= MOST_TOLD] for column in columns)
    if factors[0] is None and when:
        used[0] = next((f for least, f in SINCE_1970 if least <= min(when)), 1.0)
    is_open = len(factors) == 4 and factors[3] is None and bool(turn)
    if is_open and np.ptp(turn) > 2 * np.pi + 0.1 and not _is_unwrapped(turn):
        used[3] = np.pi / 180
        told.append("headings are in degrees, since they span more than 2 pi and jump")
    return form._replace(factors=tuple(used), told=tuple(told))


def _is_unwrapped(turn: Sequence[float]) -> bool:
    """Whether headings in radians count turns: then they never jump, and go on by little."""
    return bool(np.abs(np.diff(turn)).max(initial=0.0) < 1.0)


def _by_names(names: Sequence[str], path: Path) -> list[tuple[int, float | None]] | None:
    """Places and units of time, x, y and heading, or a quaternion, by a head; None of another."""
    held: dict[str, dict[str, tuple[int, float | None]]] = {}
    for place, name in enumerate(names):
        role, whose, factor = _pose_role(name.strip().lower())
        if role and not OTHER_POSES.search(whose):
            held.setdefault(role, {}).setdefault(whose, (place, factor))
    turned = ("heading",) if "heading" in held else ("qx", "qy", "qz", "qw")
    if not {"time", "x", "y", *turned} <= {*held}:
        return None
    poses = [whose for whose in held["x"] if whose in held["y"]]
    if len(poses) != 1 and "" not in poses:
        said = ", ".join(f"{whose}x" for whose in held["x"])
        raise LogError(path, f"its head names several poses ({said}): expected those of one")
    whose = "" if "" in poses else poses[0]
    clock = next(iter(held["time"].values()))
    if names[0] == "%time" and (stamps := [n for n in names if n.endswith("header.stamp")]):
        clock = names.index(stamps[0]), clock[1]
    return [
        clock, held["x"][whose], held["y"][whose],
        *(held[role].get(whose, next(iter(held[role].values()))) for role in turned),
    ]  # fmt: skip


def _pose_role(name: str) -> tuple[str, str, float | None]:
    """What a column is, what stands before that, and its unit: by its last words."""
    if found := QUATERNION.fullmatch(re.split(r"\s*[\[(]", name, maxsplit=1)[0]):
        return f"q{found[2]}", found[1] or "", None
    name = re.sub(r"(?<![a-z])(p|t|pos)(?=[xy](?![a-z]))", "", name)  # px, tx
    for begin in (0, *(found.end() for found in re.finditer(r"[._/ ]", name))):
        for role, column in named([name[begin:]]).by_role.items():
            return {"angle": "heading"}.get(role, role), name[:begin], column.factor
    return "", "", None


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
                f"TUM, got {len(found)}{NO_TIMES if len(found) in (3, 12) else ''}"
            )
        when, x, y, *turn = (found[k] for k in form.places)
        second, metre, metre_y, *radian = form.factors
        seconds = time(when, unit=second) if is_number(when) else moment(when)
        if form.places == ODOMETRY_LINE:
            seconds += time(found[1], unit=1e-9)
        if not np.isfinite(seconds):
            raise ValueError(f"expected a time, got {when[:40]!r}")
        if len(turn) == 1:
            pose = float_fields([x, y, *turn], "the pose") * (metre, metre_y, radian[0])
            return seconds, pose_fields([*map(repr, pose.tolist())], "the pose")
        place = float_fields([x, y], "the pose") * (metre, metre_y)
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
        odometry_track, told = _track_of(files["odometry"], log)
        met = odometry_track.met(times)
        assumed += told
        pairs = zip(log, met.times.tolist(), met.poses, strict=True)
        scans = [replace(scan, time=when, odometry=known(pose)) for scan, when, pose in pairs]
        dense = len(met.track) > len(scans) or np.isnan(met.poses).any()
        track, times = met.track if dense else None, met.times
        causes += met.causes
    if "truth" in files:
        true_track, told = _track_of(files["truth"], log)
        known_times, poses = true_track.ordered()
        assumed += told
        usual = float(np.median(np.diff(known_times))) if len(known_times) > 1 else 0.0
        gap = max(LONGEST_TRUTH_GAP_S, LONGEST_TRUTH_GAP_STEPS * usual)
        right = known_truth(interpolate(known_times, poses, times, max_gap=gap))
    assumed += [f"poses of {path.name} are the robot's" for path in files.values()]
    return Log(log.name, scans, right, log.skipped, track, log.order_known, causes, assumed)


def _track_of(path: Path, log: Log) -> tuple[Track, tuple[str, ...]]:
    """The poses of a file, some of which lie within the time of the scans; and what is assumed."""
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
        return found, pose_line_of(place).told
