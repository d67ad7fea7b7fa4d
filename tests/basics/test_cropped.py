"""Maps cut to a rectangle, and the direction of most walls."""

import numpy as np
import pytest

from segmap import SegmentMap, build_map, load
from segmap.poses import transform
from segmap.segments import main_direction, point_distance

BOX = 0.0, 0.0, 4.0, 2.0


@pytest.mark.parametrize(
    ("wall", "left"),
    [
        ([(1, 1), (3, 1)], [(1, 1), (3, 1)]),
        ([(3, 1), (9, 1)], [(3, 1), (4, 1)]),
        ([(-1, 0), (9, 2)], [(0, 0.2), (4, 1)]),
        ([(2, 5), (2, -5)], [(2, 2), (2, 0)]),  # keeps which end comes first
        ([(-2, 0), (9, 0)], [(0, 0), (4, 0)]),  # along the border
        ([(-1, 1), (1, -1)], None),  # touches a corner
        ([(5, 0), (5, 2)], None),
        ([(-1, 3), (1, 3)], None),
        ([(2, 1), (2, 1)], [(2, 1), (2, 1)]),
        ([(5, 5), (5, 5)], None),
    ],
)
def test_a_wall_is_cut_by_hand(wall, left):
    found = SegmentMap([wall], [7]).cropped(*BOX)
    assert found.segments.tolist() == ([] if left is None else [list(map(list, left))])
    assert found.scan.tolist() == ([] if left is None else [7])


def test_points_within_go_along_and_again_changes_nothing():
    """Catches points of another segment behind one, and sensors that are lost."""
    log = load("room")
    map = build_map(log, log.truth, keep_points=True)
    found = map.cropped(1, 1, 5.3, 5)
    assert 0 < len(found) < len(map) and found.sensors is not None
    assert (found.points >= 1).all() and (found.points <= [5.3, 5]).all()
    for k in range(len(found)):
        behind = found.points[found.first[k] : found.first[k + 1]]
        assert point_distance(behind, found.segments[k]).max() < 0.1
    again, all_of_it = found.cropped(1, 1, 5.3, 5), map.cropped(-99, -99, 99, 99)
    for one, two in ((found, again), (map, all_of_it)):
        for name in ("segments", "scan", "points", "first", "sensors"):
            assert np.array_equal(getattr(one, name), getattr(two, name), equal_nan=True)


@pytest.mark.parametrize("degrees", [-45, -44.9, -20, -0.4, 0, 7.25, 30, 44.6])
def test_most_walls_say_the_direction_and_oblique_ones_do_not(degrees):
    """Catches a mean of all walls, a seam at 0 or 90 degrees, and a turn of more than 45."""
    plan = [
        [(0, 0), (9, 0)],
        [(9, 0), (9, 5)],
        [(0, 5), (0, 0)],
        [(0, 0), (4, 3)],
        [(1, 1), (5, 4)],
    ]
    walls = transform((3, -2, np.radians(degrees)), np.array(plan))
    assert np.degrees(main_direction(walls)) == pytest.approx(degrees, abs=1e-9)
    assert main_direction(walls[:, ::-1]) == pytest.approx(main_direction(walls), abs=1e-12)
    assert main_direction([]) == 0.0
