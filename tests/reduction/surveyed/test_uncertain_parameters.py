"""Uncertain parameters: what a line is known by, what a look may be fused with, and the origin."""

import numpy as np
import pytest
from reduction_maps import assert_literal, corridor_map, redundant_map
from segmap_course.literal.reduction.uncertain_parameters import fused, uncertain

from segmap.poses import transform
from segmap.reduction import uncertain_parameters
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal

PAIR = np.array([[(0, 0), (4, 0)], [(3, 0.02), (4, 0.04)]])


def in_scans(segments) -> SegmentMap:
    """A scan for each segment."""
    return SegmentMap(segments, np.arange(len(segments)))


def test_a_long_look_and_a_short_one():
    """Catches weights without the length, or deviations that are added."""
    found = uncertain_parameters(PAIR)
    assert_segments_equal(found, [[(0, 0.000492), (4.000012, 0.001724)]], atol=6e-7)
    d = np.diff(found.segments[0], axis=0)[0]
    assert np.degrees(np.arctan2(d[1], d[0])) == pytest.approx(0.017635, abs=1e-6)
    wall = fused([uncertain(s, 0.01, i) for i, s in enumerate(PAIR.tolist())], None)
    assert wall.sigma_theta == pytest.approx(0.0048507, abs=1e-7)
    assert wall.sigma_rho == pytest.approx(0.0070711, abs=1e-7)


@pytest.mark.parametrize("turn", [0.3, 2.0, -2.5])
def test_with_the_origin_of_the_map_only_turning_about_it_is_free(turn):
    map = in_scans(redundant_map(np.random.default_rng(2)))
    there = SegmentMap(transform((0, 0, turn), map.segments), map.scan)
    found = uncertain_parameters(map, origin="map")
    moved = transform((0, 0, turn), found.segments)
    assert_segments_equal(uncertain_parameters(there, origin="map"), moved, ordered=True, atol=1e-8)


def test_segments_that_touch_nothing_do_not_meet():
    """Catches a test of the distance alone: the gap is 0.05 m, within 0.10."""
    assert len(uncertain_parameters(in_scans([[(0, 0), (1, 0)], [(1.05, 0), (2, 0)]]))) == 2
    assert len(uncertain_parameters(in_scans([[(0, 0), (1, 0)], [(0.95, 0), (2, 0)]]))) == 1


@pytest.mark.parametrize(("shift", "side", "left"), [(s, y, 1 if s > 0.0101 else 2)
                         for s in (0.005, 0.015) for y in (1, -1)])  # fmt: skip
def test_overlap_is_along_the_bisector(shift, side, left):
    """One begins 5 cm above the end of the other: tan(0.2) of it, 1 cm, is what they must share."""
    x, y = 1 - shift, 0.05 * side
    turned = [(x, y), (x + np.cos(0.4), y + side * np.sin(0.4))]
    for map in ([[(0, 0), (1, 0)], turned], [turned, [(0, 0), (1, 0)]]):
        assert len(uncertain_parameters(in_scans(map), angle=0.5)) == left


def test_a_segment_takes_in_all_its_matches():
    """Catches the nearest alone, or two looks that both keep the same wall."""
    apart = [[(0, 0), (1.2, 0)], [(1.9, 0), (3, 0)]]
    found = uncertain_parameters(in_scans([*apart, [(1, 0), (2, 0)]]))
    assert_segments_equal(found, [[(0, 0), (3, 0)]])
    assert found.parents.tolist() == [0, 0, 0] and found.scan_live.tolist() == [1, 2, 1]
    together = uncertain_parameters(SegmentMap([*apart, [(1, 0), (2, 0)], [(1, 0), (2, 0)]]))
    assert together.parents.tolist() == [0, 0, 0, 0]


def test_the_fused_wall_stands_where_the_first_of_them_stood():
    """Catches walls that are fused in the order of the cells: another would keep its place."""
    walls = [[(0, 0), (1.2, 0)], [(0, 1), (1, 1)], [(1.9, 0), (3, 0)], [(1, 0), (2, 0)]]
    for turned in (walls, [walls[2], walls[1], walls[0], walls[3]]):
        assert uncertain_parameters(in_scans(turned)).parents.tolist() == [0, 1, 0, 0]


def test_the_points_behind_a_segment_say_how_well_it_is_known():
    """Catches `eps` for a map that keeps its points, or points of another segment."""
    walls = [[(0, 0.0), (2, 0.0)], [(0, 0.05), (2, 0.05)]]
    points = [(0, 0), (2, 0.0005), (0, 0.05), (1, 0.09), (2, 0.05)]
    map = SegmentMap(walls, [0, 1], points=points, first=[0, 2, 5])
    expected = (0.05 / 0.04**2) / (1 / 0.001**2 + 1 / 0.04**2)
    assert uncertain_parameters(map).segments[0, :, 1] == pytest.approx(expected)
    assert uncertain_parameters(map.segments).segments[0, :, 1] == pytest.approx(0.025)


@pytest.mark.parametrize("seed", range(2))
def test_lines_of_hundreds_of_metres_are_known_no_better_than_any_line(seed):
    rng = np.random.default_rng(seed)
    map = SegmentMap(100 * corridor_map(rng, 40), rng.integers(0, 9, 40))
    assert_literal("uncertain_parameters", map, distance=10.0)


def test_another_origin_is_refused():
    with pytest.raises(ValueError, match="origin must be one of 'map', 'pair', got 'here'"):
        uncertain_parameters(PAIR, origin="here")
