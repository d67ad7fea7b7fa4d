"""Make the two simulated logs, `room` and `corridor`, from their seeds.

    python data/simulate.py

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
from segmap.scans import LaserScan, Log
from segmap.simulation import SICK_LMS200, URG_04LX, corridor_loop, drive, office, simulate

HERE = Path(__file__).parent


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
