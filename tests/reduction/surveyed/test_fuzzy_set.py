"""Fuzzy set: rectangles along the axes by hand, and buildings that have none."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

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


def test_the_precise_one_draws_the_slanted_one():
    """SURVEYED check b: errors 0.07 and 0.02; a third look then sees the error that is left."""
    walls = [[(0, 0), (4, 0.1)], [(0, 0.1), (4, 0.1)]]
    assert_allclose(fuzzy_set(walls, axes=0.0).segments[0, :, 1], 0.088889, atol=1e-6)
    # a third look, more precise than what is left of both, draws it
    y, e = 0.088889, 0.038889
    expected = (0.2 / 0.02 + y / e) / (1 / 0.02 + 1 / e)
    found = fuzzy_set([*walls, [(0, 0.2), (4, 0.2)]], axes=0.0)
    assert_allclose(found.segments[0, :, 1], expected, atol=1e-5)


def test_with_its_own_axes_it_turns_with_the_building_and_with_those_of_the_map_not():
    """SURVEYED check c, with the counter-example: 561 of 567 are left."""
    room = the_room()
    assert len(room) == 567
    found = fuzzy_set(room)
    assert len(found) == 112 and quality(room, found) == pytest.approx(0.822, abs=1e-3)
    there = fuzzy_set(turned(room, 30, -7, 4))
    back = transform((-7, 4, np.radians(30)), found.segments)
    assert_segments_equal(there, back, ordered=True, atol=1e-7)
    slanted = fuzzy_set(turned(room, 30), axes=0.0)
    assert len(slanted) == 561
    assert slanted.doubt.startswith("not orthogonal: ") and not found.doubt


def test_the_points_give_the_error():
    """Catches points that are not turned with the map, or that are measured along the wall."""
    walls = np.array([[(0, 0), (4, 0)], [(0, 0.1), (4, 0.1)]], float)
    rough = [(0, 0), (2, 0.08), (4, 0)]
    points = np.array([*rough, (0, 0.1), (2, 0.1), (4, 0.1)])
    map = SegmentMap(walls, points=points, first=[0, 3, 6])
    expected = 0.1 / 0.02 / (1 / 0.08 + 1 / 0.02)
    assert_allclose(fuzzy_set(map).segments[0, :, 1], expected, atol=1e-9)
    pose = (3, 1, 0.7)
    there = SegmentMap(transform(pose, walls), points=transform(pose, points), first=map.first)
    assert_segments_equal(fuzzy_set(there), transform(pose, fuzzy_set(map).segments))
