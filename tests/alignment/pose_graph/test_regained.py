"""Without odometry: a scan that its match lost is sought at any heading, or a new map begins."""

import alignment_logs as logs
import numpy as np
import pytest

from segmap.alignment import LiveGraph
from segmap.poses import between, compose
from segmap.scans import LaserScan
from segmap.simulation import Sensor, cast_rays

ROUND = Sensor("round", 360, -np.pi, np.radians(1), max_range=30.0)
ROOM, HERE = logs.L_ROOM, np.array([1.5, 1.5, 0.2])
ELSEWHERE = 3.0 * logs.L_ROOM
ENDLESS = np.array([[(-90.0, -1.0), (90.0, -1.0)], [(-90.0, 1.0), (90.0, 1.0)]])


def seen(walls, pose) -> LaserScan:
    """All round, or in the corridor ahead only: behind it looks the same."""
    angles = ROUND.angles if walls is not ENDLESS else ROUND.angles[80:281]
    return LaserScan(cast_rays(walls, pose, angles), angles, max_range=20.0)


NOWHERE, LOOSE = (
    "too little of it lies on the map",
    "neither walls nor odometry say how far it went",
)


@pytest.mark.parametrize(
    ("walls", "step", "reason"),
    [
        pytest.param(ROOM, (0.9, 0.6, 2.5), "", id="far, and nearly turned round"),
        pytest.param(ROOM, (0.0, 0.0, -1.5), "", id="a turn on the spot"),
        pytest.param(ROOM, (1.2, 0.6, 0.3), "", id="just so far as it may have come"),
        pytest.param(ROOM, (1.7, 0.6, 0.3), NOWHERE, id="farther"),
        pytest.param(ENDLESS, (0.4, 0.0, 0.5), LOOSE, id="in a corridor, by half a radian"),
        pytest.param(ENDLESS, (0.4, 0.0, 1.6), NOWHERE, id="in a corridor, by a quarter turn"),
    ],
)
def test_where_it_is_found_and_what_is_refused(walls, step, reason):
    """Catches a quadrant left out, a reach without an end, a turn along a corridor."""
    graph, start = LiveGraph(), HERE if walls is ROOM else np.zeros(3)
    for pose in (start, compose(start, step)):
        graph.add(seen(walls, pose))
    assert graph.unmatched == ("", reason)
    found = between(*graph.poses)
    if reason != NOWHERE:  # along the corridor it keeps the guess
        assert np.abs(found - np.array(step) * (walls is ROOM, 1, 1)).max() < 0.01


def test_after_two_scans_in_a_row_a_map_begins_anew():
    """Catches a map of two places at once; scans behind a break are used where a loop ties them."""
    graph, there = LiveGraph(), np.array([4.5, 4.5, 0.1])
    for k in range(4):
        graph.add(seen(ROOM, HERE + (0.1 * k, 0, 0)))
    for k in range(8):
        graph.add(seen(ELSEWHERE, there + (0.05 * k, 0, 0)))
    found = graph.refine()
    assert np.flatnonzero(found.used).tolist() == [*range(6, 12)]  # the larger part counts
    steps = between(found.poses[6:-1], found.poses[7:])
    np.testing.assert_allclose(steps, [between(there, there + (0.05, 0, 0))] * 5, atol=5e-4)


# ------------------------------------------------------------------------------ real logs
