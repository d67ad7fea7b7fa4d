"""Make the three simulated logs, `room`, `corridor` and `clinic`, from their seeds.

    python data/simulate.py

The true walls of `clinic` are written beside it, since no function of the library has them.
Each is a CARMEN log, gzipped without a time stamp: the same seed gives the same file. Truth stands
where a corrected log has it, in the laser's pose, odometry in the robot's; the laser sits at the
robot's turning point, so that both are poses of one frame.
"""

import gzip
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from segmap.arrays import Array
from segmap.exports import write_segments
from segmap.scans import LaserScan, Log
from segmap.simulation import (
    CHEAP_WHEELS,
    SICK_LMS200,
    URG_04LX,
    box,
    corridor_loop,
    drive,
    office,
    polyline,
    simulate,
)

HERE = Path(__file__).parent
#: Left and right wall of the rooms of the clinic, x, metres; each has a door in the middle.
ROOMS = (1.3, 3.3), (3.4, 5.4), (5.5, 7.6)
DOOR_M = 0.9
#: What stands in its rooms and corridors: x, y, width, depth, metres, and turn, radians.
FURNITURE = (
    (1.6, 3.6, 0.6, 1.2, 0), (2.7, 4.1, 1.0, 0.6, 0), (3.75, 2.2, 0.6, 0.9, 0),
    (4.6, 4.05, 1.4, 0.7, 0), (4.9, 3.3, 0.45, 0.45, 0.9), (7.25, 2.4, 0.7, 1.3, 0),
    (6.0, 4.1, 0.8, 0.5, 0), (6.6, 3.75, 0.45, 0.45, 0.5), (1.65, 5.4, 0.7, 1.6, 0),
    (2.9, 6.9, 0.5, 0.6, 0), (2.6, 5.3, 0.45, 0.45, 0.3), (5.1, 5.3, 0.5, 1.0, 0),
    (3.9, 4.85, 0.9, 0.7, 0), (7.3, 5.2, 0.6, 1.2, 0), (5.85, 6.6, 0.6, 0.8, 0),
    (8.85, 3.1, 0.3, 0.7, 0), (2.5, 0.15, 1.0, 0.3, 0), (0.15, 4.2, 0.3, 0.6, 0),
    (6.9, 8.7, 0.8, 0.2, 0),
)  # fmt: skip


def room() -> Log:
    """A URG-04LX in an office: from the corridor into two rooms, every fifth scan kept."""
    rng = np.random.default_rng(2012)
    walls = office(rng=rng, rooms=2)
    stops = [(1, 5), (2, 5), (2, 7.8), (2, 5), (6, 5), (6, 2.2), (6, 4.4)]
    path = drive(stops, step=0.35, turn=np.radians(45))
    return simulate(walls, path, sensor=replace(URG_04LX, period=0.5), rng=rng, name="room")


def corridor() -> Log:
    """A SICK LMS 200 once round a corridor and on past the start, every third scan kept."""
    stops = [(1, 1), (29, 1), (29, 11), (1, 11), (1, 1), (4, 1)]
    path = drive(stops, step=0.58, turn=np.radians(30))
    sensor, rng = replace(SICK_LMS200, period=0.6), np.random.default_rng(2007)
    return simulate(corridor_loop(), path, sensor=sensor, rng=rng, name="corridor")


def clinic_walls() -> Array:
    """Six furnished rooms inside a ring of corridors: 9.00 x 8.80 m, walls of 0.10 m.

    Rooms 1, 2 and 3 stand from left to right and open to the corridor below, which is 1.40 m wide;
    4, 5 and 6 behind them open to the one above, of 1.30 m. The corridor on the left has 1.20 m,
    that on the right 1.30 m; where these two meet, a slanting wall cuts the corner.
    """
    outside = polyline([(0, 0), (9, 0), (9, 8), (8.2, 8.8), (0, 8.8)], closed=True)
    below, above = _room_fronts(1.4, 1.5, 4.4), _room_fronts(7.5, 7.4, 4.5)
    corners = [(1.2, 7.5), (1.2, 1.4), *below, (7.7, 1.4), (7.7, 7.5), *above[::-1]]
    things = [box(width, depth, (x, y, turn)) for x, y, width, depth, turn in FURNITURE]
    return np.round(np.concatenate([outside, polyline(corners, closed=True), *things]), 6)


def _room_fronts(corridor: float, front: float, back: float) -> list[tuple[float, float]]:
    """Corners of three rooms from left to right, in and out through their doors; y in metres."""
    corners = []
    for left, right in ROOMS:
        door, end = (left + right - DOOR_M) / 2, (left + right + DOOR_M) / 2
        corners += [(door, corridor), (door, front), (left, front), (left, back)]
        corners += [(right, back), (right, front), (end, front), (end, corridor)]
    return corners


def way_through_the_clinic() -> Array:
    """Poses, `(k, 3)`: rooms 3, 6, 5, 4 on the way round the ring, then rooms 1 and 2."""
    left, middle, right = 2.3, 4.4, 6.55  # doors, x
    stops = [(4.4, 0.7), *((right, y) for y in (0.7, 2.8, 0.7))]
    stops += [(8.35, 0.7), (8.35, 7.9), (8.15, 8.1)]
    stops += [(x, y) for x in (right, middle, left) for y in (8.1, 6.1, 8.1)]
    stops += [(0.6, 8.1), (0.6, 0.7)]
    stops += [(x, y) for x in (left, middle) for y in (0.7, 2.8, 0.7)]
    return drive(stops, step=0.4, turn=0.5)


def clinic() -> Log:
    """A URG-04LX on cheap wheels once round the clinic and into its six rooms."""
    sensor, rng = replace(URG_04LX, period=0.5), np.random.default_rng(2012)
    path = way_through_the_clinic()
    return simulate(
        clinic_walls(), path, sensor=sensor, odometry_noise=CHEAP_WHEELS, rng=rng, name="clinic"
    )


def flaser(scan: LaserScan, truth: Array) -> str:
    """One line of the old form: 181 beams over 180 degrees, 81.83 where nothing was met."""
    ranges = " ".join(f"{r:.2f}" for r in np.nan_to_num(scan.ranges, posinf=81.83))
    return f"FLASER {len(scan)} {ranges} {_poses(truth, scan.odometry)} {_time(scan)}"


def robotlaser(scan: LaserScan, truth: Array) -> str:
    """One line of the new form, which states the beams; 4.000 nothing met, 0.000 too near."""
    start, step = float(scan.angles[0]), float(URG_04LX.step)
    head = f"0 {start!r} {step * (len(scan) - 1)!r} {step!r} {scan.max_range:.3f} 0.010 0"
    ranges = " ".join(f"{r:.3f}" for r in np.nan_to_num(scan.ranges, posinf=scan.max_range))
    poses, still = _poses(truth, scan.odometry), "0 0 0 0 0"
    return f"ROBOTLASER1 {head} {len(scan)} {ranges} 0 {poses} {still} {_time(scan)}"


def _poses(*poses: Array | None) -> str:
    return " ".join(f"{value:.6f}" for pose in poses if pose is not None for value in pose)


def _time(scan: LaserScan) -> str:
    return f"{scan.time:.6f} simulated {scan.time:.6f}"


#: Name of a log -> how it is simulated and how its lines are written.
LOGS: dict[str, tuple[Callable[[], Log], Callable[[LaserScan, Array], str]]] = {
    "room": (room, robotlaser),
    "corridor": (corridor, flaser),
    "clinic": (clinic, robotlaser),
}


def text(name: str) -> str:
    """The whole log as it is written."""
    make, line = LOGS[name]
    log = make()
    assert log.truth is not None
    lines = [line(scan, pose) for scan, pose in zip(log, log.truth, strict=True)]
    return "\n".join([f"# simulated by data/simulate.py of segmap: {name}", *lines, ""])


if __name__ == "__main__":
    for name in LOGS:
        packed = gzip.compress(text(name).encode(), 9, mtime=0)
        (HERE / name / f"{name}.log.gz").write_bytes(packed)
    write_segments(HERE / "clinic" / "walls.csv", clinic_walls())
