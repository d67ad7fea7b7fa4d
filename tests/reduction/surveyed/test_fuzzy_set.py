"""Fuzzy set: rectangles along the axes by hand, and buildings that have none."""

from segmap.reduction import fuzzy_set
from segmap.testing import assert_segments_equal


def test_two_looks_and_a_wall_across():
    """SURVEYED check a: equal errors, so the mean of both lines."""
    walls = [[(0, 0), (4, 0)], [(3, 0.06), (5, 0.06)], [(0, 1), (0, 3)]]
    found = fuzzy_set(walls, axes=0.0)
    assert_segments_equal(found, [[(0, 0.03), (5, 0.03)], walls[2]], ordered=True)
    assert found.parents.tolist() == [0, 0, 1] and found.doubt == ""
