"""Poses of a robot with their times, in a file of their own: odometry or truth of any log.

    time_s,x_m,y_m,theta_rad                  a head that names them with units, or `columns`
    t x y z qx qy qz qw                       TUM
    %time,field.header.stamp,field.pose.pose.position.x,...          rostopic echo -p of an Odometry
    __time,/odom/pose/pose/position/x,...                            PlotJuggler, bagpy alike
    sec,nanosec,odom,base_link,x,y,z,qx,qy,qz,qw,...                 ros2 topic echo --csv of one
    t, x, y, theta, 9 covariances             GROUNDTRUTH.csv of Rawseeds
    t, counter, ticks, ticks, x, y, theta     ODOMETRY_XYT.csv of Rawseeds

Names of columns are those of `_columns`; `x_m`, `y_m` and `theta_rad` are the robot's here, and
`qx`, `qy`, `qz`, `qw` the parts of a quaternion.

Assumed: poses are the robot's.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ... import arrays
from ...arrays import Array, checked
from ...poses import interpolate
from ...scans import Log
from ..lines import HeadError, Lines, LogError, OnError
from ..mounting import in_space, level
from ..packed import log_file
from ..raw_scans import Track, known_truth, or_none
from ._columns import POSE, QUATERNION, missing_in, places_of
from ._layout import Layout, declared_layout, layout_as_written, layout_in_toml
from ._question import choices_of
from ._ros import names_in_ros
from ._rows import Rows

TUM = ("time_s", "x_m", "y_m", "-", *QUATERNION)
RAWSEEDS_POSES = {
    "GROUNDTRUTH": ("time_s", "x_m", "y_m", "theta_rad", *["-"] * 9),
    "ODOMETRY_XYT": ("time_s", "-", "-", "-", "x_m", "y_m", "theta_rad"),
}
ROS2 = ("time_s", "nanosec", "-", "-", "x_m", "y_m", "-", *QUATERNION)
#: True poses farther apart than this, in usual steps, say nothing between; nor in seconds.
LONGEST_TRUTH_GAP_STEPS = 3
LONGEST_TRUTH_GAP_S = 1.0


def pose_layout_of(path: Path) -> Layout:
    """How a file of poses is written: by its name, its head, or as TUM and ROS 2 have it."""
    layout = layout_as_written(path)
    for sensor, names in RAWSEEDS_POSES.items():
        if sensor in path.name.upper() and len(layout.kinds) == len(names):
            return layout._replace(names=names)
    numbers = "".join("x" if is_number else "-" for is_number in layout.kinds)
    if layout.separator is None and numbers == "x" * len(TUM):
        return layout._replace(names=TUM)
    if not layout.head and re.fullmatch(r"xx--x{7}x*", numbers):
        return layout._replace(names=(*ROS2, *["-"] * (len(numbers) - len(ROS2))))
    names = names_in_ros(layout.head) or layout.head
    return layout if missing_in(names, of_poses=True) else layout._replace(names=names)


def track_in(path: Path, on_error: str, layout: Layout) -> tuple[Track, Lines]:
    """The poses of a file, and what of it was left out."""
    lines, track = Lines(path, on_error), Track()
    if not layout.names:
        raise HeadError(
            path, choices_of(layout, missing_in(layout.head, of_poses=True)).question(path.name)
        )
    rows, columns = Rows(lines, layout), dict[str, Array]()
    for role, (place, column) in places_of(layout.names, of_poses=True).items():
        values = rows.values(place, column)
        if values is None:
            missing = f"the unit of {layout.names[place]!r} is not said"
            raise HeadError(path, choices_of(layout, missing).question(path.name))
        columns[role] = values
    times = columns["time"] + columns.get("nanosec", 0.0)
    turn = ("pose_theta",) if "pose_theta" in columns else ("qw", "qx", "qy", "qz")
    poses = np.stack([columns[role] for role in (*POSE[:2], *turn)], axis=1)
    is_pose = rows.good & np.isfinite(times) & np.isfinite(poses).all(axis=1)
    for row in np.flatnonzero(is_pose).tolist():
        x, y, *turned = poses[row].tolist()
        try:
            pose = level(in_space((x, y, 0.0), turned)) if turned[1:] else poses[row]
            track.add(float(times[row]), pose)
        except ValueError as fault:
            rows.damaged(row, str(fault))
    if not track.times:
        raise LogError(path, f"holds no pose, expected rows of {layout.columns}{lines.why()}")
    return track, lines


def _track(
    path: str | Path, columns: str | Sequence[str] | None = None, on_error: str = "raise"
) -> Track:
    """The poses of a file by what the caller, a file NAME.toml beside it or it itself says."""
    with log_file(path) as place:
        if columns is not None:
            layout = declared_layout(place, columns, of_poses=True)
        else:
            layout = layout_in_toml(Path(path), of_poses=True) or pose_layout_of(place)
        return track_in(place, on_error, layout)[0]


@checked
def read_trajectory(
    path: str | Path,
    *,
    columns: str | Sequence[str] | None = None,
    on_error: OnError = "raise",
) -> tuple[Array, Array]:
    """Read a file of poses: of TUM, of ROS, of Rawseeds, or with names of its columns.

    `columns` are such names from the left, as in `read_csv`: `time_s,x_m,y_m,theta_rad`. Damage is
    as in `read`. Returned are times `(k,)`, ascending, and poses `(k, 3)`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "it.csv"
    ...     _ = path.write_text("time_s,x_m,y_m,theta_deg\\n10.5,1,2,90\\n11.5,1,2,0\\n")
    ...     times, poses = read_trajectory(path)
    >>> times, poses[0].round(2)
    (array([10.5, 11.5]), array([1.  , 2.  , 1.57]))
    """
    return _track(path, columns, on_error).in_order()


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
    paths = {"odometry": odometry, "truth": truth}
    files = {word: arrays.file(path, word) for word, path in paths.items() if path is not None}
    scans, right, assumed = list(log), log.truth, list(log.assumed)
    causes, times = list(log.causes), log.times
    if "odometry" in files:
        times, poses, clock_causes = _track_of(files["odometry"], log).synchronise(times)
        pairs = zip(log, times.tolist(), poses, strict=True)
        scans = [replace(scan, time=when, odometry=or_none(pose)) for scan, when, pose in pairs]
        causes += clock_causes
    if "truth" in files:
        known_times, poses = _track_of(files["truth"], log).in_order()
        usual = float(np.median(np.diff(known_times))) if len(known_times) > 1 else 0.0
        gap = max(LONGEST_TRUTH_GAP_S, LONGEST_TRUTH_GAP_STEPS * usual)
        right = known_truth(interpolate(known_times, poses, times, max_gap=gap))
    assumed += [f"poses of {path.name} are the robot's" for path in files.values()]
    parts = log.skipped, log.order_known, causes, assumed
    return Log(log.name, scans, right, *parts)


def _track_of(path: Path, log: Log) -> Track:
    """The poses of a file, some of which lie within the time of the scans."""
    track, scans = _track(path), log.times[np.isfinite(log.times)]
    if not len(scans):
        raise LogError(path, "cannot be used: the scans of the log have no times")
    first, last = min(track.times), max(track.times)
    if not ((first <= scans) & (scans <= last)).any():
        raise LogError(
            path,
            f"its poses are from {first:.3f} to {last:.3f} s, and the scans from "
            f"{scans.min():.3f} to {scans.max():.3f} s: it has another clock",
        )
    return track
