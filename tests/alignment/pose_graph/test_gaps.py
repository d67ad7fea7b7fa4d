"""Scans that see nothing, or a hand: they tie nothing, and what follows goes on where it was."""

from dataclasses import replace
from functools import cache

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import Alignment, pose_graph, position_errors
from segmap.scans import Log
from segmap.simulation import (
    URG_04LX,
    OdometryNoise,
    Sensor,
    box,
    drifting_odometry,
    drive,
    office,
    polyline,
    rectangular_room,
    simulate,
)

WHEELS = OdometryNoise(turn_bias=0.02, turn_noise=0.02, heading_noise=0.005)
COVERED = range(60, 66)


def with_wheels(log: Log) -> Log:
    """The log with odometry that errs by 2 %."""
    odometry = drifting_odometry(log.truth, odometry_noise=WHEELS, rng=np.random.default_rng(1))
    scans = [replace(scan, odometry=pose) for scan, pose in zip(log, odometry, strict=True)]
    return Log(log.name, scans, log.truth)


def seen(log: Log, which: range, ranges: float, moves: float = 0.0) -> Log:
    """The log where some scans see only this distance; NaN: nothing. A hand moves."""
    scans, rng = list(log), np.random.default_rng(0)
    for k in which:
        beams = len(scans[k].ranges)
        scans[k] = replace(scans[k], ranges=np.abs(rng.normal(ranges, moves, beams)))
    return Log(log.name, scans, log.truth)


def farthest(found: Alignment, log: Log) -> float:
    """How far the scans that are used are off at most, metres."""
    away = position_errors(found.poses[found.used], log.truth[found.used], best=True)
    return float(away.max())


@pytest.mark.parametrize(
    ("wheels", "ranges"), [(True, np.nan), (True, 0.6), (False, np.nan), (False, 0.25)]
)
@pytest.mark.parametrize(("name", "scan"), [("room", 42), ("corridor", 122)])
def test_a_scan_of_nothing_or_of_a_hand_parts_nothing(name, scan, wheels, ranges):
    """Catches one that becomes a key frame: loops then moved all that followed by 4 to 23 m.

    And a hand that is called matched, .7 to 1 m off, since it lies near any wall.
    """
    log = with_wheels(load(name)) if wheels else logs.without_odometry(load(name))
    log = seen(log, range(scan, scan + 1), ranges, 0.03)
    found = pose_graph(log)
    assert found.used.sum() == len(log) - 1 and not found.used[scan]
    assert farthest(found, log) < 0.2


@cache
def hall() -> Log:
    """A drive on an ellipse through a hall that half a turn nearly carries onto itself."""
    turn = np.linspace(0, 2 * np.pi, 110)
    x, y = 9 + 6 * np.cos(turn), 6 + 3.5 * np.sin(turn)
    heading = np.arctan2(3.5 * np.cos(turn), -6 * np.sin(turn))
    things = box(1.5, 1, (9.75, 7.5, 0)), box(1, 1, (13.5, 1.3, 0))
    laser = Sensor("laser", 271, np.radians(-135), np.radians(1), max_range=12.0, sigma=0.01)
    return simulate(
        np.concatenate([rectangular_room(18, 12), *things]),
        np.stack([x, y, heading], 1),
        sensor=laser,
        odometry_noise=WHEELS,
        rng=np.random.default_rng(1),
    )


@pytest.mark.parametrize("wheels", [True, False])
def test_a_blind_laser_turns_no_hall(wheels):
    """Catches what follows at the place that half a turn carries there, 10 m off."""
    log = seen(hall() if wheels else logs.without_odometry(hall()), COVERED, np.nan)
    found = pose_graph(log)
    assert farthest(found, log) < 0.25 and found.used.sum() == len(log) - len(COVERED)


@pytest.mark.parametrize("moves", [0.0, 0.03])
def test_a_hand_before_the_laser_is_no_map(moves):
    """Catches scans of a hand called sure, since they lie on each other, 0.5 m off and more.

    Up to two scans behind it are not used either: they lie on no map of the hand.
    """
    log = seen(hall(), COVERED, 0.25, moves)
    found = pose_graph(log)
    assert farthest(found, log) < 0.1 and found.verdict.grade == "good"
    assert not found.used[COVERED].any() and found.used.sum() >= len(log) - len(COVERED) - 2


@pytest.mark.parametrize("scan", [4, 30, 42])
def test_a_lost_robot_is_not_sought_on_a_map_of_what_it_sees(scan):
    """Catches old places whose surroundings hold what came behind the gap: 5 m off, and GOOD."""
    log = seen(logs.without_odometry(load("room")), range(scan, scan + 1), np.nan)
    found = pose_graph(log)
    assert farthest(found, log) < 0.25 or found.verdict.grade != "good"


@pytest.mark.parametrize("scans", [1, 3, 6])
def test_without_wheels_a_hand_turns_no_hall_that_is_called_good(scans):
    """Catches a chain that goes on behind the hand: 10.6 m off, and GOOD."""
    log = seen(logs.without_odometry(hall()), range(60, 60 + scans), 0.25)
    found = pose_graph(log)
    assert farthest(found, log) < 0.25 or found.verdict.grade != "good"


def test_a_room_behind_a_door_is_not_the_last_one_turned():
    """Catches two equal rooms that become one, 4.9 m off, where scans in the door are damaged."""
    left = [(2.55, 4.6), (0, 4.6), (0, 0), (6, 0), (6, 4.6), (3.45, 4.6)]
    walls = polyline([*left, *((x, 9.45 - y) for x, y in left[::-1])], closed=True)
    path, rng = drive([(1.5, 1), (3, 2.3), (3, 7.2), (3, 5.3)], step=0.1), np.random.default_rng(0)
    log = simulate(walls, path, sensor=replace(URG_04LX, sigma=0.01), rng=rng)
    damaged = range(door := int(np.argmax(path[:, 1] > 4.7)), door + 4)
    log = logs.changed(log, lambda k, r: rng.uniform(0.3, 3.5, len(r)) if k in damaged else r)
    assert logs.errors(log, pose_graph(log).poses)[0].max() < 0.3


@pytest.mark.parametrize("seed", range(2))
def test_without_odometry_the_motion_goes_on_in_time(seed):
    """Catches one that goes on scan by scan: where scans are left out, or come twice, rooms that
    look alike became one, metres off."""
    stops = [(x, y) for x in (2, 6, 10, 14) for y in (5, 7.5, 5, 2.5, 5)]
    path = drive([(1, 5), *stops, (15, 5), (1, 5)], step=0.15, turn=0.14)
    walls, rng = office(rng=np.random.default_rng(1), rooms=4), np.random.default_rng(seed)
    log = logs.without_odometry(simulate(walls, path, sensor=logs.AROUND, rng=rng))
    came = np.cumsum(rng.choice([0, 0, 1, 1, 2, 4, 6], len(log)))
    log = log[came[came < len(log)]]
    alignment = pose_graph(log)
    assert alignment.used.all() and logs.errors(log, alignment.poses)[0].max() < 0.4


def test_an_empty_scan_between_two_moves_none():
    """Catches a motion that goes on by a whole step over half of its time: 6 m."""
    log = logs.without_odometry(load("corridor"))
    k = len(log) // 2
    time = (log[k - 1].time + log[k].time) / 2
    empty = replace(log[k], ranges=np.full(len(log[k]), np.nan), time=time)
    more = pose_graph(Log(log.name, [*log[:k], empty, *log[k:]])).poses
    apart = np.delete(more, k, axis=0) - pose_graph(log).poses
    assert np.abs(apart).max() < 1e-6


def test_stamps_that_come_in_bursts_throw_no_scan_off():
    """Catches a motion that goes on a hundred times, since the scan before waited: 37 m."""
    stops = [(x, y) for x in (2, 6) for y in (5, 7.5, 5, 2.5, 5)]
    path = drive([(1, 5), *stops, (7, 5), (1, 5)], step=0.15, turn=0.14)
    rng, walls = np.random.default_rng(0), logs.OFFICE
    log = logs.without_odometry(simulate(walls, path, sensor=logs.AROUND, rng=rng))
    scans = np.arange(len(log))
    times = log.times[np.minimum(scans // 5 * 5 + 4, scans[-1])] + 0.002 * (scans % 5)
    alignment = pose_graph(logs.changed(log, times=times))
    assert alignment.used.all() and logs.errors(log, alignment.poses)[0].max() < 0.05
