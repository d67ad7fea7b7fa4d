"""A building of any size: its streets are free, no two alike, and scanning it stays linear."""

import numpy as np
import pytest

from segmap.segments import point_distance
from segmap.simulation import SICK_LMS200, Sensor, cast_rays, city, drive, simulate

BLOCK, STREET = 16.0, 3.0
WALLS = city(4, 3, rng=np.random.default_rng(5), block=BLOCK, street=STREET)
NEAR = Sensor("near", 181, -np.pi / 2, np.pi / 180, max_range=20.0, sigma=0.01)
ALL_ROUND = np.linspace(-np.pi, np.pi, 720, endpoint=False)


def crossing(i: int, j: int) -> np.ndarray:
    return STREET / 2 + (BLOCK + STREET) * np.array([i, j], float)


def test_the_streets_are_free_and_closed():
    """Catches facades on the wrong side of their wall, pillars in the way, gaps at corners."""
    way = [crossing(0, 0), crossing(4, 0), crossing(4, 3), crossing(0, 3), crossing(0, 1)]
    path = drive([*way, crossing(3, 1), crossing(3, 0)], step=0.5)
    assert all(point_distance(pose[:2], WALLS).min() > 0.6 for pose in path[::4])
    assert all(np.isfinite(cast_rays(WALLS, pose, ALL_ROUND)).all() for pose in path[::25])


@pytest.mark.parametrize("sensor", [NEAR, SICK_LMS200, Sensor("far", 9, 0, 0.7, max_range=np.inf)])
def test_walls_out_of_reach_do_not_change_a_log(sensor):
    """Long walls too, of which both ends are far away; catches an index into the wrong walls."""
    long = [[(-900, -40), (1000, -40.5)], [(30, -500), (30.1, -0.1)], [(-50, -50), (200, 100)]]
    walls = np.concatenate([long, WALLS])
    path = drive([crossing(0, 0), crossing(1, 0), crossing(1, 1)], step=3)
    log = simulate(walls, path, sensor=sensor.ideal(), rng=np.random.default_rng(1))
    for scan, pose in zip(log, path, strict=True):
        met = cast_rays(walls, pose, scan.angles, max_range=sensor.max_range)
        np.testing.assert_allclose(scan.ranges, met, atol=0.005)


def test_a_long_wall_at_the_end_of_the_range_is_met_everywhere():
    """Catches a wall that is looked for near its places alone, not half way between two."""
    others = [[(5000 + k, 0), (5000 + k, 1)] for k in range(201)]
    walls = np.array([[(-900, 19.5), (1000, 19.5)], *others], float)
    path = [(x, 0, np.pi / 2) for x in range(0, 21, 2)]
    log = simulate(walls, path, sensor=NEAR.ideal(), rng=np.random.default_rng(1))
    np.testing.assert_allclose([scan.ranges[90] for scan in log], 19.5, atol=0.005)
