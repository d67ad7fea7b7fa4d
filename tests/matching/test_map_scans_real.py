"""Mapping without odometry on a real robot with an URG-04LX; skipped where the log is not here."""

import numpy as np
import pytest
from conftest import shared_file

from segmap import read
from segmap.matching import map_scans
from segmap.quadtree import QuadtreeMap, build_map


@pytest.fixture(scope="module")
def walked():
    """The log, the map that grew, and the steps."""
    log = read(shared_file("data/urg04lx-exp1.dat.gz"))[:300]
    map = QuadtreeMap()
    return log, map, list(map_scans(log, map=map))


def test_walls_are_single(walked):
    """Poses that agree leave few leaves (B Fig. 6.17): two thirds of those of the wheels."""
    log, _, steps = walked
    away = [-step.score / len(scan.points()) for step, scan in zip(steps, log, strict=True)]
    assert np.nanmedian(away) < 0.015
    found, wheels = (
        len(build_map(log, poses, resolution=0.02, free=False).leaves().x)
        for poses in ([step.pose for step in steps], log.odometry)
    )
    assert found < 0.7 * wheels


def test_walls_stay(walked):
    """Half the beams of this sensor met nothing that it could see: taken for open space, as in a
    simulated room, they erase most of what stands there.
    """
    log, map, steps = walked
    unmet = np.mean([np.isposinf(scan.ranges).mean() for scan in log])
    erased = build_map(log, [step.pose for step in steps], resolution=0.01, free=True)
    kept, left = ((m.leaf_occupancy() > 0.5).sum() for m in (map, erased))
    assert unmet > 0.5 and kept > 2 * left
