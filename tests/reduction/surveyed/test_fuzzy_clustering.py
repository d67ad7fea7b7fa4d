"""Fuzzy clustering, a reconstruction: a corner by hand, its cells, and what they cost."""

import numpy as np
import pytest

from segmap.poses import transform
from segmap.reduction import fuzzy_clustering
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal

STEPS = np.arange(11) / 10
#: The points of SURVEYED's check a: two walls that meet in a corner, and one far from both.
CORNER = np.array([*((x, 0) for x in STEPS), *((0, y) for y in STEPS[1:]), (0.6, 0.6)])
#: A wall through four cells, and one that ends in its cell.
WALLS = np.array([[(0.2, 1.0), (7.8, 1.1)], [(5.2, 0.2), (5.3, 0.9)]])


def looks(walls, times: int) -> SegmentMap:
    """As many scans that each see all walls."""
    return SegmentMap(np.tile(walls, (times, 1, 1)), np.repeat(np.arange(times), len(walls)))


def test_the_same_corner_as_a_map():
    """Catches noise that joins a wall; the corner's point goes to the first of equals."""
    walls = [[(0, 0), (1, 0)], [(0, 0), (0, 1)]]
    map = SegmentMap(walls, points=CORNER, first=[0, 11, 22])
    found = fuzzy_clustering(map, corner=(-0.5, -0.5))
    assert_segments_equal(found, [walls[0], [(0, 0.1), (0, 1)]], atol=1e-9, ordered=True)
    assert found.parents.tolist() == [0, 1]


def test_walls_end_at_cells_until_they_are_grouped():
    """A grouping too early, too late or never; a last one that is forgotten."""
    once = [[(0.2, 1.0), (7.8, 1.0)]]
    assert fuzzy_clustering(looks(once, 3), every=2).scan_live.tolist() == [4, 1, 1]
    assert fuzzy_clustering(looks(once, 3)).scan_live.tolist() == [4, 4, 1]
    assert_segments_equal(fuzzy_clustering(looks(once, 3)), once, atol=0.03)


def test_a_quarter_turn_about_the_corner_turns_the_result():
    """SURVEYED check b."""
    map, quarter = looks(WALLS, 3), (0, 0, np.pi / 2)
    expected = transform(quarter, fuzzy_clustering(map).segments)
    assert_segments_equal(fuzzy_clustering(carried(map, quarter)), expected, atol=1e-6)


def carried(map: SegmentMap, pose) -> SegmentMap:
    return SegmentMap(transform(pose, map.segments), map.scan)


@pytest.mark.filterwarnings("ignore:cell is 10000 m:UserWarning")
@pytest.mark.parametrize(("cell", "what"), [(1e-9, "larger"), (1e4, "smaller")])
def test_cells_that_no_map_can_bear(cell, what):
    """Memory, in bytes and not in metres."""
    many = np.tile([[(0.0, 1.0), (900.0, 1.0)]], (40, 1, 1))
    many[:, :, 1] += np.arange(40)[:, None]
    with pytest.raises(ValueError, match=rf"^cell must be {what}"):
        fuzzy_clustering(many, cell=cell)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("axis", range(2))
def test_a_map_as_far_as_cells_have_numbers(axis):
    """Catches a row of cells that goes on in the next one."""
    wall, cell = np.array([[(0.0, 0.5), (0.75, 0.5)]]), 2.0**-8
    near, far = (np.roll(cell * (wall + (out, 0)), axis, -1) for out in (2**31 - 1, 2**31))
    fuzzy_clustering(near, cell=cell)
    with pytest.raises(ValueError, match=r"^cell must be larger"):
        fuzzy_clustering(far, cell=cell)
