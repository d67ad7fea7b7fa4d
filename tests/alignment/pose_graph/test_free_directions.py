"""Directions that no wall fixes: the wheels say how far the robot went there, and no loop does."""

from dataclasses import replace

import numpy as np
import pytest

from segmap.alignment import pose_graph, position_errors
from segmap.poses import between, compose
from segmap.scans import Log
from segmap.simulation import URG_04LX, OdometryNoise, Sensor, drive, rectangular_room, simulate

CHEAP = OdometryNoise(turn_bias=0.05, turn_noise=0.05, heading_noise=0.02)


def ring(seed: int) -> Log:
    """Once round a plain corridor 1.3 m wide, 9 by 7 m outside, with a laser that sees 4 m."""
    inner = rectangular_room(9 - 2.6, 7 - 2.6) + 1.3
    stops = [(4.5, 0.65), (8.35, 0.65), (8.35, 6.35), (0.65, 6.35), (0.65, 0.65), (4.5, 0.65)]
    return simulate(
        np.concatenate([rectangular_room(9, 7), inner]),
        drive(stops, step=0.3, turn=0.35),
        sensor=replace(URG_04LX, sigma=0.01),
        odometry_noise=CHEAP,
        rng=np.random.default_rng(seed),
    )


@pytest.mark.parametrize("seed", [0, 2])
def test_loops_of_one_stretch_do_not_say_how_far_along_it(seed):
    """Catches loops whose place along a corridor the search chose: 0.5 to 0.6 m off."""
    log = ring(seed)
    found = pose_graph(log)
    assert found.graph.loop.any()
    assert position_errors(found.poses, log.truth, best=True).max() < 0.1


def test_what_wheels_err_by_a_metre_goes_on_along_a_corridor():
    """Catches a deviation that grows with the root of the way: 0.6 m off, and GOOD."""
    sensor = Sensor("round", 360, -np.pi, np.radians(1), max_range=12.0, sigma=0.01)
    path = drive([(2, 1), (58, 1)], step=0.3)
    log = simulate(rectangular_room(60, 2), path, sensor=sensor, rng=np.random.default_rng(1))
    odometry = [path[0]]
    for step in between(path[:-1], path[1:]):
        odometry.append(compose(odometry[-1], step * (0.95, 0.95, 1.0)))
    scans = [replace(scan, odometry=pose) for scan, pose in zip(log, odometry, strict=True)]
    found = pose_graph(Log("corridor", scans, log.truth))
    off = position_errors(found.poses, log.truth, best=True)
    assert (off < 2 * found.spread).mean() > 0.9 and not found.sure.any()


def test_odometry_that_is_missing_here_and_there_leaves_poses_in_a_plain_corridor():
    """Catches a way that is not known and becomes part of a pose: NaN, and an error of a tree."""
    path = drive([(2, 1.2), (38, 1.2)], step=0.2)
    log = simulate(rectangular_room(40, 2.4), path, sensor=URG_04LX, rng=np.random.default_rng(0))
    missing = np.random.default_rng(0).random(len(log)) < 0.3
    scans = [replace(s, odometry=None if gone else s.odometry)
             for s, gone in zip(log, missing, strict=True)]  # fmt: skip
    assert np.isfinite(pose_graph(Log("corridor", scans)).poses).all()
