"""Trajectories, and logs with corrected poses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..alignment import Alignment
from ..arrays import Array
from ..files import packed, replacing, write_lines
from ..poses import between, compose
from ..readers import LogError, half_turn, read, same_poses
from ..scans import NO_POSE, LaserScan, Log

#: What a SICK answers where nothing was met, metres: every reader of CARMEN logs knows it.
NOTHING_MET = 81.83
#: Beams farther than this from where a line would put them, radians, cannot be written.
EVEN = 1e-6


def write_tum(path: str | Path, log: Log, poses: Alignment | ArrayLike) -> None:
    """Write a trajectory as lines `t x y z qx qy qz qw`, which evo and the TUM tools compare.

    Parameters
    ----------
    path : str or Path
    log : Log
        Gives the times, seconds, to the microsecond.
    poses : Alignment or (k, 3) array, metres and radians
        One a scan, to the micrometre; z is 0, the quaternion turns about z. Rows of NaN are left
        out: `alignment.trusted` writes the scans that rest on a match only.

    Raises
    ------
    ValueError
        Poses of another shape or infinite, a time that is not finite.
    OSError
        A folder that does not exist, or cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "one.tum"
    ...     write_tum(path, Log("one", [LaserScan([1.0], [0.0], time=2.5)]), [(1, 2, np.pi)])
    ...     print(path.read_text(), end="")
    # time x y z qx qy qz qw
    2.500000 1.000000 2.000000 0 0 0 1.000000000 0.000000000
    """
    arrays.instance(log, "log", Log)
    if poses is None:
        raise ValueError("poses must be one a scan, or an alignment, got None")
    rows = _poses(log, poses)
    known = np.flatnonzero(np.isfinite(rows).all(1))
    lines = (_tum(time, pose) for time, pose in zip(log.times[known], rows[known], strict=True))
    write_lines(arrays.file(path), ["# time x y z qx qy qz qw", *lines])


def write_carmen(path: str | Path, log: Log, poses: Alignment | ArrayLike | None = None) -> None:
    """Write a CARMEN log whose laser lines hold corrected poses, as `read` takes it in again.

    Where all beams look over half a turn the lines are FLASER, which every program reads, else
    ROBOTLASER1, which state their beams; a second laser that looks backwards gets RLASER or
    ROBOTLASER2. Where the lasers sit stands in PARAM lines.

    Parameters
    ----------
    path : str or Path
    log : Log
        Ranges, metres, are written to the micrometre, times to the microsecond, odometry to the
        micrometre and microradian. Beams that met nothing become 81.83 or the sensor's maximum,
        those with an error 0.
    poses : Alignment or (k, 3) array, metres and radians, or None
        Of the robot, one a scan; rows of NaN where a scan has none. None takes the log's truth.

    Raises
    ------
    ValueError
        Poses of another shape or infinite, a time that is not finite; a log without scans; beams
        that are not evenly spaced, or none; lasers at more than two places, or two that look ahead.
        In ROBOTLASER1 lines, poses that lie all alike from the odometry: they would be read as the
        laser's place on the robot. Whatever `read` would refuse: angles of more than 10 radians,
        places beyond 10 000 km, times beyond 10^12 s, lines of more than a megabyte.
    OSError
        A folder that does not exist, or cannot be written to.

    Notes
    -----
    Two things the format cannot tell. Poses that are the odometry's are read as no truth where the
    log has PARAM or ROBOTLASER1 lines. Ranges of 50 m or more, and in a log that holds no longer
    ones those from 32.76 to 32.77 and from 8.18 to 8.2 m, are read as nothing met.

    Examples
    --------
    >>> import tempfile
    >>> from segmap import load, read
    >>> from segmap.alignment import pose_graph
    >>> log = load("corridor")[:5]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_carmen(Path(folder) / "aligned.log.gz", log, pose_graph(log))
    ...     read(Path(folder) / "aligned.log.gz")
    Log('aligned', 5 scans, odometry, truth)
    """
    if not len(arrays.instance(log, "log", Log)):
        raise ValueError(f"log {log.name!r} holds no scan: there is nothing to write")
    rows = _poses(log, log.truth if poses is None else poses)
    old = all(_looks_over_half_a_turn(k, scan) for k, scan in enumerate(log))
    lasers = _lasers(log)
    if not old:
        _refuse_ambiguous(log, rows, lasers)
    head = [f"# written by segmap: {log.name!a}", *_parameters(lasers)]
    scans = (
        _flaser(scan, pose, lasers, log[0].time)
        if old
        else _robotlaser(scan, pose, lasers, log[0].time)
        for scan, pose in zip(log, rows, strict=True)
    )
    place = arrays.file(path)
    with replacing(place) as target:
        data = "".join(f"{line}\n" for line in [*head, *scans]).encode("ascii")
        target.write(packed(data) if place.suffix == ".gz" else data)
        target.flush()
        _check_readable(Path(target.name), log, place.name)


def _check_readable(written: Path, log: Log, name: str) -> None:
    """Refuse a log that `read` would not take in again, before it is moved to its place."""
    try:
        count = len(read(written))
    except LogError as fault:
        where = f"line {fault.line}" if fault.line else "the file"
        raise ValueError(f"{name} cannot hold this log, {where}: {fault.reason}") from None
    if count != len(log):
        raise ValueError(f"{name} cannot hold this log: {count} of {len(log)} scans come back")


# ------------------------------------------------------------------------------ lines
def _tum(time: float, pose: Array) -> str:
    x, y, heading = pose
    return f"{time:.6f} {x:.6f} {y:.6f} 0 0 0 {np.sin(heading / 2):.9f} {np.cos(heading / 2):.9f}"


class _Lasers(NamedTuple):
    """Where the lasers of a log sit on the robot, `(3,)` each, metres and radians."""

    front: Array
    rear: Array | None = None

    def places(self) -> list[Array]:
        """One or two, (3,) array each, metres and radians."""
        return [self.front] if self.rear is None else [self.front, self.rear]

    def number(self, scan: LaserScan) -> int:
        """1 for a scan of the front laser, 2 for one of the rear."""
        return 1 if np.array_equal(scan.sensor_pose, self.front) else 2


def _flaser(scan: LaserScan, pose: Array, lasers: _Lasers, start: float) -> str:
    name = "FR"[lasers.number(scan) - 1] + "LASER"
    ranges = _numbers(_written(scan, NOTHING_MET))
    return f"{name} {len(scan)} {ranges} {_placed(scan, pose)} {_timed(scan, start)}"


def _robotlaser(scan: LaserScan, pose: Array, lasers: _Lasers, start: float) -> str:
    name, step = f"ROBOTLASER{lasers.number(scan)}", _step(scan)
    limit = scan.max_range if np.isfinite(scan.max_range) else NOTHING_MET
    turn = f"{float(scan.angles[0])!r} {step * (len(scan) - 1)!r} {step!r}"
    ranges = f"{len(scan)} {_numbers(_written(scan, limit))}"
    head = f"{name} 0 {turn} {limit:.6f} 0.010 0 {ranges} 0"
    return f"{head} {_placed(scan, pose)} 0 0 0 0 0 {_timed(scan, start)}"


def _written(scan: LaserScan, nothing: float) -> Array:
    """Ranges `(n,)`, metres, with the answer for nothing met, and 0 for an error."""
    met = np.where(scan.ranges >= scan.max_range, np.inf, scan.ranges)
    return np.where(scan.valid, met, np.where(np.isposinf(met), nothing, 0.0))


def _placed(scan: LaserScan, pose: Array) -> str:
    """The laser's corrected pose and the robot's odometry."""
    known = scan.odometry is not None and np.isfinite(scan.odometry).all()
    odometry = scan.odometry if known and scan.odometry is not None else np.array(NO_POSE)
    return _numbers(np.concatenate([compose(pose, scan.sensor_pose), odometry]))


def _timed(scan: LaserScan, start: float) -> str:
    return f"{scan.time:.6f} segmap {scan.time - start:.6f}"


def _numbers(values: Iterable[float]) -> str:
    """Six decimals, without zeros at the end: 1.5, 2, nan."""
    return " ".join(f"{value:.6f}".rstrip("0").rstrip(".") for value in values)


# ---------------------------------------------------------------------------- the log
def _poses(log: Log, poses: Alignment | ArrayLike | None) -> Array:
    """Poses to write, `(k, 3)`: finite, or NaN where a scan has none."""
    given = np.full((len(log), 3), np.nan) if poses is None else poses
    rows = arrays.poses(given, "poses", count=len(log), missing=True)
    if not np.isfinite(log.times).all():
        bad = int(np.argmin(np.isfinite(log.times)))
        raise ValueError(f"the time of scan {bad} must be finite, got {log.times[bad]}")
    return np.where(np.isnan(rows).any(axis=1, keepdims=True), np.nan, rows)


def _step(scan: LaserScan) -> float:
    """Angle from beam to beam, radians."""
    return float(scan.angles[-1] - scan.angles[0]) / max(len(scan) - 1, 1)


def _looks_over_half_a_turn(number: int, scan: LaserScan) -> bool:
    """Whether the beams are those of a FLASER line; beams that no line can state are refused."""
    if not len(scan):
        raise ValueError(f"scan {number} has no beam: a line of a CARMEN log holds at least one")
    even = scan.angles[0] + _step(scan) * np.arange(len(scan))
    if _step(scan) < 0 or np.abs(scan.angles - even).max() > EVEN:
        raise ValueError(
            f"the beams of scan {number} must be evenly spaced and counter-clockwise: a CARMEN log "
            "holds where they start and their step, and no angle of each"
        )
    return bool(np.abs(scan.angles - half_turn(len(scan))).max() <= EVEN)


def _lasers(log: Log) -> _Lasers:
    """The one laser of a log, or the front one and the one that looks back."""
    places = list({tuple(scan.sensor_pose): scan.sensor_pose for scan in log}.values())
    back = [np.cos(place[2]) < 0 for place in places]
    if len(places) == 1:
        return _Lasers(places[0])
    if len(places) == 2 and any(back):
        rear = 1 if back[1] else 0
        return _Lasers(places[1 - rear], places[rear])
    where = ", ".join(str(place.round(3).tolist()) for place in places[:4])
    raise ValueError(
        "the lasers of a CARMEN log must sit at one place on the robot, or at two of which one "
        f"looks back, got {len(places)}: {where}"
    )


def _parameters(lasers: _Lasers) -> Iterator[str]:
    """PARAM lines of where the lasers sit; none for one at the robot's turning point."""
    for end, place in zip(("front", "rear"), lasers.places(), strict=False):
        if place.any():
            for kind, value in zip(("", "side_", "angular_"), place, strict=True):
                yield f"PARAM robot_{end}laser_{kind}offset {float(value)!r}"


def _refuse_ambiguous(log: Log, rows: Array, lasers: _Lasers) -> None:
    """Refuse poses that all differ alike from the odometry: they would be read as an extrinsic."""
    for place in lasers.places():
        mine = [k for k, scan in enumerate(log) if np.array_equal(scan.sensor_pose, place)]
        way = between(log.odometry[mine], compose(rows[mine], place)) if mine else np.empty((0, 3))
        way = way[np.isfinite(way).all(1)]
        if len(way) and same_poses(way, way[:1]) and not same_poses(way, place):
            raise ValueError(
                "poses that lie all alike from the odometry would be read as the laser's place on "
                "the robot: write a longer log, or one without odometry"
            )
