"""The robot that explores by itself: what it knows in the end, and that it meets no wall."""

import numpy as np
import segmap_course as course

from segmap.segments import point_distance
from segmap.simulation import box, polyline, rectangular_room

#: Two rooms with a door of a metre, and a cupboard.
ROOMS = np.concatenate(
    [
        rectangular_room(6, 3),
        polyline([(3, 0), (3, 1)]),
        polyline([(3, 2), (3, 3)]),
        box(0.6, 0.4, (5.2, 0.2, 0)),
    ]
)


def test_it_sees_both_rooms_and_meets_no_wall():
    """Catches a robot that stops at its first frontier, and one that drives through a wall."""
    found = course.explore(ROOMS, (1, 1.5), rng=np.random.default_rng(1))
    assert len(found.poses) == len(found.metres) == len(found.known)
    assert 0.3 < found.known[0] < found.known[-1] and found.known[-1] > 0.97
    assert (np.diff(found.known) >= -0.01).all() and (np.diff(found.metres) >= 0).all()
    assert found.poses[:, 0].max() > 2.9 and 1 < found.metres[-1] < 40
    assert point_distance(found.poses[:, None, :2], ROOMS).min() > 0.1
    pieces = np.stack([found.poses[:-1, :2], found.poses[1:, :2]], 1)
    part = np.linspace(0, 1, 9)[:, None, None]
    between = (pieces[:, 0] + part * (pieces[:, 1] - pieces[:, 0])).reshape(-1, 2)
    assert point_distance(between[:, None], ROOMS).min() > 0.1


def test_the_floor_is_what_hangs_together():
    """Catches the inside of a cupboard, and the room behind a wall without a door."""
    floor = course.floor_of(ROOMS, np.array([1.0, 1.5]))
    inside = (abs(floor - (5.2, 0.2)) < (0.3, 0.2)).all(1)
    assert not inside.any() and floor[:, 0].max() > 5.8
    assert 0.85 * (18 - 0.24) < 0.01 * len(floor) < 18 - 0.24
    closed = np.concatenate([ROOMS, polyline([(3, 0), (3, 3)])])
    assert course.floor_of(closed, np.array([1.0, 1.5]))[:, 0].max() < 3
