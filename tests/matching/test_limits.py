"""Where the rules of matching end: a little less and a little more than what they allow."""

from functools import partial

import numpy as np
import pytest

from segmap import LaserScan
from segmap.matching import hill_climb, map_scans
from segmap.quadtree import QuadtreeMap


def scan_of(points):
    x, y = np.array(points, float).T
    return LaserScan(np.hypot(x, y), np.arctan2(y, x))


# ------------------------------------------------------------------ scan after scan


@pytest.mark.parametrize(("off", "on"), [(0.14, 1), (0.15, 0)])
def test_an_end_lies_on_the_map_twelve_centimetres_and_half_a_cell_from_it(off, on):
    still = partial(lambda map, points, start, *, score: start)
    scans = [scan_of([(1.025, 0.025)]), scan_of([(1.025, 0.025 + off)])]
    *_, last = map_scans(scans, map=QuadtreeMap(resolution=0.05), matcher=still)
    assert last.overlap == on


@pytest.mark.parametrize(("on", "found"), [(3, True), (2, False)])
def test_a_robot_is_found_where_three_fifths_of_its_scan_lie_on_the_map(on, found):
    first = [(1, y / 2) for y in range(5)]
    second = first[:on] + [(9, y) for y in range(5 - on)]
    still = partial(lambda map, points, start, *, score: start)
    *_, last = map_scans([scan_of(first), scan_of(second)], matcher=still)
    assert last.overlap == on / 5 and last.found == found


# ------------------------------------------------------------------ smaller parts


@pytest.mark.parametrize(("heading", "wrapped"), [(np.pi, -np.pi), (-np.pi, -np.pi), (3.0, 3.0)])
def test_a_heading_of_half_a_turn_is_that_to_the_right(heading, wrapped):
    score = lambda map, points, poses: np.zeros(len(poses))  # noqa: E731
    assert hill_climb(QuadtreeMap(), [(1, 0)], (0, 0, heading), score=score)[2] == wrapped
