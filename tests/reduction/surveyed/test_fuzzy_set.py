"""Fuzzy set: rectangles along the axes by hand, and buildings that have none."""

import numpy as np
import pytest

from segmap import load
from segmap.extraction import build_map
from segmap.metrics import quality
from segmap.poses import transform
from segmap.reduction import fuzzy_set
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal


def the_room() -> SegmentMap:
    log = load("room")
    return build_map(log, log.truth).filtered()


def turned(map: SegmentMap, degrees: float, x: float = 0.0, y: float = 0.0) -> SegmentMap:
    return SegmentMap(transform((x, y, np.radians(degrees)), map.segments), map.scan)


def test_two_looks_and_a_wall_across():
    """SURVEYED check a: equal errors, so the mean of both lines."""
    walls = [[(0, 0), (4, 0)], [(3, 0.06), (5, 0.06)], [(0, 1), (0, 3)]]
    found = fuzzy_set(walls, axes=0.0)
    assert_segments_equal(found, [[(0, 0.03), (5, 0.03)], walls[2]], ordered=True)
    assert found.parents.tolist() == [0, 0, 1] and found.doubt == ""


def test_with_its_own_axes_it_turns_with_the_building_and_with_those_of_the_map_not():
    """SURVEYED check c, with the counter-example: 562 of 568 are left."""
    room = the_room()
    assert len(room) == 568
    found = fuzzy_set(room)
    assert len(found) == 114 and quality(room, found) == pytest.approx(0.820, abs=1e-3)
    there = fuzzy_set(turned(room, 30, -7, 4))
    back = transform((-7, 4, np.radians(30)), found.segments)
    assert_segments_equal(there, back, ordered=True, atol=1e-7)
    slanted = fuzzy_set(turned(room, 30), axes=0.0)
    assert len(slanted) == 562
    assert slanted.doubt.startswith("not orthogonal: ") and not found.doubt
