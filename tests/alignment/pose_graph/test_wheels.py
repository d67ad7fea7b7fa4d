"""What goes along with the robot is no wall: where a match contradicts good wheels by far.

People and boxes are squares that keep their place beside the robot, in a corridor whose pillars say
how far it went. Wheels err by 5 mm a step.
"""

import alignment_logs as logs
import numpy as np
import pytest

from segmap import LaserScan, Log
from segmap import simulation as sim
from segmap.alignment import pose_graph
from segmap.poses import between, compose

PILLARS = [sim.box(0.2, 0.2, (x, 0.9, 0)) for x in (3, 9, 15, 21)]
CORRIDOR = np.concatenate([sim.box(24, 2, (12, 0, 0)), *PILLARS])
OFFICE = sim.office(rng=np.random.default_rng(5), rooms=2)
ROUND = np.array([(1, 5), (6, 5), (6, 6.9), (6, 5), (2, 5), (2, 3.1), (2, 5), (1.5, 5)], float)


def drive(beside, path, walls=CORRIDOR, seed=6):
    """A log, where `beside` says at each scan which squares go along: side, x and y, in metres."""
    rng, sensor = np.random.default_rng(seed), sim.SICK_LMS200
    angles = np.radians(np.arange(-180.0, 180.0))
    odometry, scans = np.zeros(3), []
    for k, pose in enumerate(path):
        if k:
            step = between(path[k - 1], pose)
            odometry = compose(odometry, step + [rng.normal(0, 0.005), 0, 0])
        squares = [sim.box(a, a, compose(pose, np.array([x, y, 0.0]))) for a, x, y in beside(k)]
        seen = sim.cast_rays(np.concatenate([walls, *squares]), pose, angles, max_range=12.0)
        seen = seen + rng.normal(0, 0.01, len(angles))
        scans.append(LaserScan(seen, angles, 0.5 * k, odometry, sensor.max_range))
    return Log("people", scans, np.array(path))


def along(step, count=60):
    return [np.array([2 + step * k, 0, 0.0]) for k in range(count)]


def circling(k):
    turn = 0.05 * k + np.array([0, np.pi])
    return [(0.3, 0.8 * np.cos(a), 0.8 * np.sin(a)) for a in turn]


DRIVES = {
    "one beside": (lambda k: [(0.3, 0.8, 0.6)], along(0.3)),
    "two beside": (lambda k: [(0.3, 0.8, 0.6), (0.3, 0.8, -0.6)], along(0.3)),
    "one who sways": (lambda k: [(0.3, 0.8 + 0.3 * np.sin(0.3 * k), 0.6)], along(0.3)),
    "one behind": (lambda k: [(0.4, -0.9, 0.2)], along(0.2, 100)),
    "two who circle": (circling, along(0.1, 200)),
    "a box on the robot": (lambda k: [(0.15, 0.35, 0.0)], along(0.3)),
    "nobody": (lambda k: [], along(0.3)),
}


def off(log, poses):
    """How far each scan lies from its true place, seen from the first, in metres."""
    true = between(log.truth[0], log.truth)
    return np.hypot(*(between(poses[0], poses) - true).T[:2])


@pytest.mark.parametrize("who", DRIVES)
def test_who_goes_along_with_the_robot_does_not_hold_it(who):
    """Before, one beside made 17.7 m to 0.0 m, good, and all 60 scans sure."""
    log = drive(*DRIVES[who])
    found = pose_graph(log)
    assert found.used.all()
    assert off(log, found.poses).max() < 0.25


@pytest.mark.parametrize(
    "wrong",
    [
        lambda step, k: step * (1.3, 1.0, 1.0),
        lambda step, k: step * (0.0, 1.0, 1.0) if 20 <= k < 24 else step,
        lambda step, k: step + (0.4, 0.0, 0.0) if k % 15 == 7 else step,
        lambda step, k: step + (0.0, 0.0, 0.3) if k % 15 == 7 else step,
        lambda step, k: step * (1.0, 1.0, -1.0),
    ],
    ids=["long", "blocked", "slips", "turns", "mirrored"],
)
def test_wheels_that_err_do_not_win_against_walls(wrong):
    """Wheels that count too far, or spin, contradict each match by many standard deviations."""
    path = list(sim.drive(ROUND, step=0.15, turn=np.radians(12)))
    log = drive(lambda k: [], path, OFFICE)
    rows = [np.zeros(3)]
    for k in range(1, len(path)):
        rows.append(compose(rows[-1], wrong(between(log.odometry[k - 1], log.odometry[k]), k)))
    found = pose_graph(logs.changed(log, odometry=rows))
    assert found.used.all()
    assert off(log, found.poses).max() < 0.05
