"""A robot that is carried away while nothing is measured: the whole map is asked where it is."""

from dataclasses import replace

import alignment_logs as logs
import numpy as np

from segmap.alignment import pose_graph
from segmap.scans import Log
from segmap.scans.causes import Cause
from segmap.simulation import (
    SICK_LMS200,
    OdometryNoise,
    corridor_loop,
    drive,
    office,
    simulate,
)

LOOP = drive([(1, 1), (29, 1), (29, 13), (1, 13), (1, 1), (10, 1)], step=0.2, turn=np.radians(12))


def seen(walls, path, sensor=logs.AROUND, seed=1) -> Log:
    """A drive with good wheels."""
    rng = np.random.default_rng(seed)
    return simulate(walls, path, sensor=sensor, rng=rng, odometry_noise=OdometryNoise())


def joined(first: Log, second: Log, pause: float = 16.0) -> Log:
    """Both one after the other, as if the robot had stood between them."""
    log = logs.joined(first, second, (0.0, 0.0, 0.0))
    later = first.times[-1] + pause + second.times - second.times[0]
    return logs.changed(log, times=[*first.times, *later])


def lifted(found) -> list[float]:
    """The scans at which the drive breaks."""
    return [f.value for f in found.causes if f.cause is Cause.LIFTED and f.doubtful]


def test_a_lifted_robot_is_told():
    """Catches a robot that is put 15 m away, in a corridor that looks the same, and called good."""
    whole = seen(corridor_loop(30, 14), LOOP)
    assert not lifted(pose_graph(whole))
    third = len(whole) // 3
    carried = joined(whole[:third], whole[2 * third :])
    assert lifted(pose_graph(carried))[0] in (third, third + 1)
    bare = logs.without_odometry(carried)
    assert lifted(pose_graph(bare))[:1] in ([third], [third + 1])


def test_a_laser_that_sees_nothing_for_a_moment_was_not_lifted():
    """Catches a hand before the laser, or a blind start, that makes a right map doubtful."""
    path = drive([(1, 5), (6, 5), (6, 3.1), (6, 5), (1.5, 5.3)], step=0.15, turn=np.radians(12))
    log = seen(logs.OFFICE, path)
    for blind in (range(40, 43), range(4)):
        scans = [
            replace(s, ranges=s.ranges * np.nan) if k in blind else s for k, s in enumerate(log)
        ]
        assert not lifted(pose_graph(replace(log, scans=tuple(scans))))


def test_a_recorder_that_rests_while_the_robot_does_confirms_the_way():
    """Catches a pause that makes a right map doubtful, whatever the scan after it shows."""
    path = drive([(1, 5), (6, 5), (6, 3.1), (6, 5), (1.5, 5.3)], step=0.15, turn=np.radians(12))
    log = seen(logs.OFFICE, path)
    for rest in (20, 50, 80):
        assert not lifted(pose_graph(joined(log[:rest], log[rest - 1 :])))


def test_where_the_odometry_jumps_the_map_is_asked_too():
    """Catches a jump that is left out, a match beside the place that the robot left, and GOOD."""
    stops = [(1, 5), (2, 5), (2, 6.9), (2, 5), (6, 5), (6, 3.1), (6, 5), (7, 5), (1.5, 5.3)]
    path = drive(stops, step=0.15, turn=np.radians(12))
    walls = logs.OFFICE
    there = seen(walls, drive([(6, 5), (2, 5)], step=0.15, turn=np.radians(12)), seed=2)
    carried = joined(seen(walls, path), there, pause=0.1)
    scans = [
        replace(s, odometry=None if k == len(path) else s.odometry) for k, s in enumerate(carried)
    ]
    assert lifted(pose_graph(replace(carried, scans=tuple(scans))))[:1] == [len(path)]


def test_without_odometry_a_match_after_a_far_turn_is_a_guess():
    """Catches a scan that is sure though nothing but one match, turned by 80 degrees, ties it."""
    stops = [(1, 5), *((x, y) for x in (2, 6) for y in (5, 6.9, 5, 3.1, 5)), (7, 5), (1.5, 5.3)]
    path, walls = (
        drive(stops, step=0.4, turn=np.radians(80)),
        office(rng=np.random.default_rng(0), rooms=2),
    )
    log = seen(walls, path, SICK_LMS200, seed=0)
    alone = logs.without_odometry(log)
    led, guessed = pose_graph(log), pose_graph(alone)
    assert led.used.all() and led.sure.all() and led.spread.max() < 0.5
    assert guessed.used.all() and not guessed.sure.all() and guessed.spread.max() > 0.5
