"""Directions that no wall fixes: the wheels say how far the robot went there, and no loop does."""

from dataclasses import replace

import numpy as np
import pytest

from segmap.alignment import pose_graph, position_errors
from segmap.scans import Log
from segmap.simulation import URG_04LX, OdometryNoise, drive, rectangular_room, simulate

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
