"""Small simulated logs for the tests of alignment, and ways to spoil them."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from segmap.poses import between, compose
from segmap.scans import Log
from segmap.simulation import (
    SICK_LMS200,
    OdometryNoise,
    Sensor,
    corridor_loop,
    drive,
    office,
    polyline,
    simulate,
)

#: Wheels that err more than most: a loop of 80 m ends metres away.
BAD_WHEELS = OdometryNoise(turn_bias=0.05, turn_noise=0.05, heading_noise=0.02)

#: An L-shaped room with a pillar: no turn and no shift carries it onto itself.
L_ROOM = np.concatenate(
    [
        polyline([(0, 0), (5, 0), (5, 3), (3, 3), (3, 4.5), (0, 4.5)], closed=True),
        polyline([(1.0, 2.8), (1.5, 2.8), (1.5, 3.2), (1.0, 3.2)], closed=True),
    ]
)
OFFICE = office(rng=np.random.default_rng(1), rooms=2)
AROUND = Sensor("around", 360, -np.pi, np.radians(1), max_range=12.0, min_range=0.12, sigma=0.01)
#: In and out of four rooms of the office, and back.
STOPS = [(1, 5), *((x, y) for x in (2, 6) for y in (5, 6.9, 5, 3.1, 5)), (7, 5), (1.5, 5.3)]
ROOMS = drive(STOPS, step=0.15, turn=np.radians(12))


@cache
def rooms_log(sensor: Sensor = AROUND, place: tuple[float, float, float] = (0, 0, 0)) -> Log:
    """That drive with the odometry of good wheels, seen by a laser at a place on the robot."""
    rng, wheels = np.random.default_rng(11), OdometryNoise()
    how = {"sensor": sensor, "rng": rng, "odometry_noise": wheels, "sensor_pose": place}
    return simulate(OFFICE, ROOMS, **how)


def exact_log(
    wheels: OdometryNoise = OdometryNoise(), *, step: float = 0.25, turn: float = 15, seed: int = 5
) -> Log:
    """The way of `office_log`, seen by a laser without error."""
    path = drive([(1, 5), (2, 5), (2, 7.5)], step=step, turn=np.radians(turn))
    rng, sensor = np.random.default_rng(seed), SICK_LMS200.ideal()
    return simulate(OFFICE, path, sensor=sensor, rng=rng, odometry_noise=wheels)


def office_log(wheels: OdometryNoise = OdometryNoise(), step: float = 0.3) -> Log:
    """Along a corridor and into a room: some 20 scans."""
    path = drive([(1, 5), (2, 5), (2, 7.5)], step=step, turn=np.radians(15))
    rng = np.random.default_rng(5)
    return simulate(OFFICE, path, sensor=SICK_LMS200, rng=rng, odometry_noise=wheels, name="office")


def loop_log(wheels: OdometryNoise = BAD_WHEELS, seed: int = 0, step: float = 0.25) -> Log:
    """Once round a corridor of 76 m and a little further: some 350 scans."""
    corners = [(1, 1), (29, 1), (29, 11), (1, 11), (1, 1), (5, 1)]
    path = drive(corners, step=step, turn=np.radians(15))
    rng = np.random.default_rng(seed)
    return simulate(
        corridor_loop(), path, sensor=SICK_LMS200, rng=rng, odometry_noise=wheels, name="loop"
    )


def moving_log() -> Log:
    """The way of `office_log`, seen by a laser that turns five times a second meanwhile."""
    path = drive([(1, 5), (2, 5), (2, 7.5)], step=0.1, turn=0.2)
    sensor, rng = Sensor("spin", 180, 0.0, np.radians(2), 8.0, period=0.2), np.random.default_rng(5)
    return simulate(OFFICE, path, sensor=sensor, rng=rng, moving=True, name="moving")


def featureless_log(step: float = 0.3, sensor: Sensor = SICK_LMS200) -> Log:
    """Between two endless walls: nothing says how far the robot has come."""
    walls = np.array([[(-90, -1), (90, -1)], [(-90, 1), (90, 1)]])
    path = drive([(-3, 0), (3, 0)], step=step)
    rng = np.random.default_rng(2)
    return simulate(walls, path, sensor=sensor, rng=rng, name="featureless")


def errors(log: Log, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance (metres) and turn (radians) of each pose from the truth, both from the start."""
    assert log.truth is not None
    left = between(between(log.truth[0], log.truth), between(poses[0], poses))
    return np.hypot(left[:, 0], left[:, 1]), np.abs(left[:, 2])


def changed(
    log: Log,
    ranges: Callable[[int, np.ndarray], np.ndarray] | None = None,
    odometry: Sequence | np.ndarray | None = None,
    times: Sequence | np.ndarray | None = None,
) -> Log:
    """The log with other ranges, odometry or times."""
    for name, new in (("ranges", ranges), ("odometry", odometry), ("time", times)):
        if new is not None:
            rows = [new(k, s.ranges.copy()) for k, s in enumerate(log)] if callable(new) else new
            scans = [replace(s, **{name: row}) for s, row in zip(log, rows, strict=False)]
            log = Log(log.name, scans, log.truth)
    return log


def person(log: Log, seed: int = 3) -> Log:
    """Somebody walks through: a fifth of the beams of each scan end early."""
    rng = np.random.default_rng(seed)

    def cut(k: int, ranges: np.ndarray) -> np.ndarray:
        first = rng.integers(0, len(ranges) * 4 // 5)
        body = slice(first, first + len(ranges) // 5)
        ranges[body] = np.minimum(ranges[body], 0.6 + 0.1 * rng.random())
        return ranges

    return changed(log, cut)


def missing(log: Log, share: float = 0.3, seed: int = 3) -> Log:
    """Beams that do not come back, chosen anew in each scan."""
    rng = np.random.default_rng(seed)
    return changed(log, lambda k, r: np.where(rng.random(len(r)) < share, np.inf, r))


def blind(log: Log, *which: int) -> Log:
    """These scans have no point at all."""
    return changed(log, lambda k, r: np.full_like(r, np.inf) if k in which else r)


def without_odometry(log: Log, *which: int) -> Log:
    """These scans, or all, have no odometry."""
    gone = set(which or range(len(log)))
    return changed(log, odometry=[None if k in gone else s.odometry for k, s in enumerate(log)])


def joined(first: Log, second: Log, step: Sequence = (0.25, 0.0, 0.0)) -> Log:
    """The robot is carried away between two logs; its odometry goes on as if it had driven."""
    assert first.truth is not None
    assert second.truth is not None
    start = compose(first.odometry[-1], step)
    on = compose(start, between(second.odometry[0], second.odometry))
    rest = changed(second, odometry=on)
    return Log("kidnapped", [*first, *rest], np.concatenate([first.truth, second.truth]))
