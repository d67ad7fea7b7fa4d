"""Trajectories, and logs with corrected poses."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..alignment import Alignment
from ..angles import wrap
from ..arrays import Array
from ..files import pack, rewrite, write_lines
from ..poses import compose
from ..readers import LogError, half_turn, read
from ..scans import NO_POSE, LaserScan, Log

#: What a SICK answers where nothing was met, metres: every reader of CARMEN logs knows it.
SICK_NOTHING_MET_M = 81.83
#: Beams farther than this from where a line would put them, radians, cannot be written.
EVEN = 1e-6
#: A laser that comes back farther away than this, in metres or radians, was read wrongly.
SENSOR_MOVED = 1e-3


def write_tum(path: str | Path, log: Log, poses: Alignment | ArrayLike) -> None:
    """Write a trajectory as lines `t x y z qx qy qz qw`, which evo and the TUM tools compare.

    Poses are `(k, 3)`, one a scan, to the micrometre, times to the microsecond, or the numbers of
    the scans where no time is known; z is 0, the quaternion turns about z. Rows of NaN are left
    out: `alignment.trusted` writes the scans that rest on a match only.

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
    rows = _poses_to_write(log, poses)
    scans = np.flatnonzero(np.isfinite(rows).all(1))
    times, remarks = _times(log)
    lines = (_tum(time, pose) for time, pose in zip(times[scans], rows[scans], strict=True))
    write_lines(arrays.file(path), [*remarks, "# time x y z qx qy qz qw", *lines])


def write_carmen(path: str | Path, log: Log, poses: Alignment | ArrayLike | None = None) -> None:
    """Write a CARMEN log whose laser lines hold corrected poses, as `read` takes it in again.

    Where all beams look over half a turn the lines are FLASER, which every program reads, else
    ROBOTLASER1, which state their beams; a second laser that looks backwards gets RLASER or
    ROBOTLASER2. Where the lasers sit stands in PARAM lines.

    Ranges are written to the micrometre, times to the microsecond, odometry to the micrometre and
    microradian. Without times the scans are numbered, and a comment says so. Beams that met
    nothing become 81.83 or the sensor's maximum, those with an error 0.

    Parameters
    ----------
    poses : Alignment or (k, 3) array, or None
        Of the robot, one a scan; rows of NaN where a scan has none. None takes the log's truth.

    Raises
    ------
    ValueError
        Poses of another shape or infinite, a time that is not finite; a log without scans; beams
        that are not evenly spaced, or none; lasers at more than two places, or two that look ahead.
        In ROBOTLASER1 lines, poses that lie all alike from the odometry: they would be read as the
        laser's place on the robot. Whatever `read` would refuse: angles of more than 10 radians,
        places beyond 10 000 km, times beyond 10^12 s, lines of more than a megabyte.

    Notes
    -----
    Two things the format cannot tell. Poses that are the odometry's are read as no truth where the
    log has PARAM or ROBOTLASER1 lines. Ranges of 50 m or more, and in a log that holds no longer
    ones those from 32.76 to 32.77 and from 8.18 to 8.2 m, are read as nothing met.

    Examples
    --------
    >>> import tempfile
    >>> from segmap import load, read
    >>> log = load("corridor")[:5]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_carmen(Path(folder) / "aligned.log.gz", log, compose((1, 2, 0.5), log.truth))
    ...     read(Path(folder) / "aligned.log.gz")
    Log('aligned', 5 scans, odometry, truth)
    """
    if not len(arrays.instance(log, "log", Log)):
        raise ValueError(f"log {log.name!r} holds no scan: there is nothing to write")
    rows = _poses_to_write(log, log.truth if poses is None else poses)
    times, remarks = _times(log)
    old = all(_looks_over_half_a_turn(k, scan) for k, scan in enumerate(log))
    places = _laser_places(log)
    lines = [f"# written by segmap: {log.name!a}", *remarks]
    for end, offset in zip(("front", "rear"), places, strict=False):
        if offset.any():  # none for a laser at the robot's turning point
            for kind, value in zip(("", "side_", "angular_"), offset, strict=True):
                lines.append(f"PARAM robot_{end}laser_{kind}offset {float(value)!r}")
    for scan, pose, time in zip(log, rows, times, strict=True):
        number = 1 if np.array_equal(scan.sensor_pose, places[0]) else 2
        odometry = np.array(NO_POSE if scan.odometry is None else scan.odometry)
        robot = odometry if np.isfinite(odometry).all() else np.array(NO_POSE)
        both_poses = np.concatenate([compose(pose, scan.sensor_pose), robot])
        timed = f"{time:.6f} segmap {time - times[0]:.6f}"
        head, tail = _old(scan, number) if old else _new(scan, number)
        lines.append(f"{head} {_numbers(both_poses)}{tail} {timed}")
    place = arrays.file(path)
    with rewrite(place) as target:
        data = "".join(f"{line}\n" for line in lines).encode("ascii")
        target.write(pack(data) if place.suffix == ".gz" else data)
        target.flush()
        _check_readable(Path(target.name), log, place.name)


def _check_readable(written: Path, log: Log, name: str) -> None:
    """Refuse a log that `read` would take in as another one, before it is moved to its place."""
    try:
        copy = read(written)
    except LogError as fault:
        where = f"line {fault.line}" if fault.line else "the file"
        raise ValueError(f"{name} cannot hold this log, {where}: {fault.reason}") from None
    if len(copy) != len(log):
        raise ValueError(f"{name} cannot hold this log: {len(copy)} of {len(log)} scans come back")
    for read_back, scan in zip(copy, log, strict=True):
        off = read_back.sensor_pose - scan.sensor_pose
        if np.abs([*off[:2], wrap(off[2])]).max() > SENSOR_MOVED:
            raise ValueError(
                "poses that lie all alike from the odometry would be read as the laser's place on "
                "the robot: write a longer log, or one without odometry"
            )


# ------------------------------------------------------------------------------ lines
def _tum(time: float, pose: Array) -> str:
    x, y, heading = pose
    return f"{time:.6f} {x:.6f} {y:.6f} 0 0 0 {np.sin(heading / 2):.9f} {np.cos(heading / 2):.9f}"


def _old(scan: LaserScan, number: int) -> tuple[str, str]:
    """What stands before the poses of a FLASER or RLASER line, and behind them."""
    ranges = _numbers(_ranges_to_write(scan, SICK_NOTHING_MET_M))
    return f"{'FR'[number - 1]}LASER {len(scan)} {ranges}", ""


def _new(scan: LaserScan, number: int) -> tuple[str, str]:
    """What stands before the poses of a ROBOTLASER line, and behind them."""
    step, limit = _step(scan), scan.max_range if np.isfinite(scan.max_range) else SICK_NOTHING_MET_M
    turn = f"{float(scan.angles[0])!r} {step * (len(scan) - 1)!r} {step!r}"
    ranges = f"{len(scan)} {_numbers(_ranges_to_write(scan, limit))}"
    return f"ROBOTLASER{number} 0 {turn} {limit:.6f} 0.010 0 {ranges} 0", " 0 0 0 0 0"


def _ranges_to_write(scan: LaserScan, nothing: float) -> Array:
    """Ranges `(n,)` with the answer for nothing met, and 0 for an error."""
    met = np.where(scan.ranges >= scan.max_range, np.inf, scan.ranges)
    return np.where(scan.valid, met, np.where(np.isposinf(met), nothing, 0.0))


def _numbers(values: Iterable[float]) -> str:
    """Six decimals, without zeros at the end: 1.5, 2, nan."""
    return " ".join(f"{value:.6f}".rstrip("0").rstrip(".") for value in values)


# ---------------------------------------------------------------------------- the log
def _poses_to_write(log: Log, poses: Alignment | ArrayLike | None) -> Array:
    """Poses to write, `(k, 3)`: finite, or NaN where a scan has none."""
    if poses is None:
        return np.full((len(log), 3), np.nan)
    rows = arrays.poses(poses, "poses", count=len(log), missing=True)
    return np.where(np.isnan(rows).any(axis=1, keepdims=True), np.nan, rows)


def _times(log: Log) -> tuple[Array, list[str]]:
    """Times `(k,)`, for formats that hold one with each scan: the numbers of the scans, and a word.

    Some scans with a time and others without are a ValueError.
    """
    has_time = np.isfinite(log.times)
    if len(log) and not has_time.any():
        return np.arange(float(len(log))), ["# times are the numbers of the scans: none is known"]
    if not has_time.all():
        bad = int(np.argmin(has_time))
        raise ValueError(f"the time of scan {bad} must be finite, got {log.times[bad]}")
    return log.times, []


def _step(scan: LaserScan) -> float:
    """Angle from beam to beam."""
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


def _laser_places(log: Log) -> list[Array]:
    """Where the one laser of a log sits, or the front one and then the one that looks back."""
    places = list({tuple(scan.sensor_pose): scan.sensor_pose for scan in log}.values())
    back = [bool(np.cos(place[2]) < 0) for place in places]
    if len(places) == 1 or (len(places) == 2 and any(back)):
        return places[::-1] if len(places) == 2 and not back[1] else places
    where = ", ".join(str(place.round(3).tolist()) for place in places[:4])
    raise ValueError(
        "the lasers of a CARMEN log must sit at one place on the robot, or at two of which one "
        f"looks back, got {len(places)}: {where}"
    )
