"""Segments have no direction; maps of them keep the scan that each came from."""

from typing import Annotated

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from segmap import arrays
from segmap.angles import axial_difference
from segmap.poses import transform
from segmap.segments import SegmentMap, angle, extreme_projections, length, midpoint, point_distance

NUMBER = st.floats(-20, 20)
POINT = st.tuples(NUMBER, NUMBER)
SEGMENT = st.tuples(POINT, POINT)
POSE = st.tuples(NUMBER, NUMBER, NUMBER)
THREE = [[(0, 0), (3, 4)], [(1, 1), (1, 2)], [(0, 5), (0.05, 5)]]


# ---------------------------------------------------------------------- measures
@given(SEGMENT, POSE)
def test_moving_a_segment_moves_its_middle_and_turns_its_angle(segment, pose):
    moved = transform(pose, segment)
    assert length(moved) == pytest.approx(length(segment), abs=1e-9)
    np.testing.assert_allclose(midpoint(moved), transform(pose, midpoint(segment)), atol=1e-9)
    assume(length(segment) > 1e-3)
    turn = axial_difference(angle(moved), angle(segment))
    assert abs(np.sin(turn - pose[2])) < 1e-9


@given(SEGMENT)
def test_a_segment_has_no_direction(segment):
    """Catches an angle in [-pi, pi), which changes when end points are swapped."""
    swapped = segment[::-1]
    assert length(swapped) == length(segment)
    assert 0 <= angle(segment) < np.pi
    assert abs(axial_difference(angle(swapped), angle(segment))) < 1e-12
    np.testing.assert_array_equal(midpoint(swapped), midpoint(segment))


@pytest.mark.parametrize(
    ("segment", "degrees"),
    [
        ([(0, 0), (2, 0)], 0),
        ([(2, 0), (0, 0)], 0),
        ([(0, 0), (1, -1e-20)], 0),
        ([(0, 0), (0, -1)], 90),
        ([(5, 5), (4, 6)], 135),
        ([(5, 5), (5, 5)], 0),
    ],
)
def test_angles_of_the_cases_that_slopes_get_wrong(segment, degrees):
    """Catches y = mx + q for vertical walls and a rounding up to 180 degrees."""
    assert np.degrees(angle(segment)) == pytest.approx(degrees, abs=1e-9)


def test_measures_keep_leading_axes_and_accept_none():
    grid = np.zeros((4, 3, 2, 2))
    assert length(grid).shape == angle(grid).shape == (4, 3) and midpoint(grid).shape == (4, 3, 2)
    none = np.empty((0, 2, 2))
    assert length(none).shape == angle(none).shape == (0,)


# ------------------------------------------------------------------- projections
@given(st.lists(POINT, min_size=1, max_size=8), POINT, st.floats(-4, 4))
def test_extreme_projections_lie_on_the_line_and_span_all_points(points, through, direction):
    """Catches the first and last point taken for the extreme ones."""
    along = np.array([np.cos(direction), np.sin(direction)])
    found = extreme_projections(points, through, direction)
    across = np.array([-along[1], along[0]])
    np.testing.assert_allclose((found - through) @ across, 0, atol=1e-9)
    u = np.subtract(points, through) @ along
    np.testing.assert_allclose((found - through) @ along, [min(u), max(u)], atol=1e-9)


# --------------------------------------------------------------------- distances
@given(POINT, SEGMENT)
def test_point_distance_equals_a_search_along_the_segment(point, segment):
    """Catches the distance to the endless line, and to the end points only."""
    share = np.linspace(0, 1, 2001)[:, None]
    places = np.array(segment[0]) + share * np.subtract(segment[1], segment[0])
    literal = np.hypot(*(places - point).T).min()
    found = point_distance(point, segment)
    assert found <= literal + 1e-12
    assert literal - found <= length(segment) / 4000 + 1e-9


def test_point_distance_beside_beyond_and_on_a_segment():
    """Catches a division by zero where a segment has no length; axes that do not broadcast."""
    points = [(1, 2), (1, -2), (5, 0), (-3, 4), (0.5, 0), (2, 0)]
    assert point_distance(points, [(0, 0), (2, 0)]).tolist() == [2, 2, 3, 5, 0, 0]
    assert point_distance((3, 4), [(0, 0), (0, 0)]) == 5
    grid = point_distance(np.zeros((5, 1, 2)), np.ones((3, 2, 2)))
    np.testing.assert_allclose(grid, np.full((5, 3), np.sqrt(2)))


# ------------------------------------------------------------------------ checks
def test_maps_and_whatever_has_segments_are_accepted():
    class Reduced:
        segments = np.array(THREE, float)

    for value in (THREE, SegmentMap(THREE), Reduced()):
        np.testing.assert_array_equal(arrays.segments(value), THREE)
    for nothing in ([], np.empty((0, 2, 2)), np.empty((0, 4, 1))):
        assert arrays.segments(nothing).shape == (0, 2, 2)


# -------------------------------------------------------------------------- maps
def test_filtering_keeps_segments_of_exactly_the_least_length_and_their_scans():
    """Catches < for <=, and scans that slip against their segments."""
    lengths = [0.05, 0.25, 0.2499999, 1.0]
    map = SegmentMap([[(0, 0), (x, 0)] for x in lengths], scan=[4, 5, 6, 7])
    kept = map.filtered(0.25)
    assert kept.scan.tolist() == [5, 7]
    assert length(kept.segments).tolist() == [0.25, 1.0]
    assert len(map.filtered()) == 3


@given(st.lists(st.integers(-2, 5), max_size=40))
def test_by_scan_gives_every_segment_once_scans_ascending_in_input_order(scans):
    """Catches an unstable sort, which shuffles the segments of a scan."""
    segments = np.arange(4.0 * len(scans)).reshape(-1, 2, 2)
    groups = list(SegmentMap(segments, scan=scans).by_scan())
    literal = [
        segments[[k for k, s in enumerate(scans) if s == scan]] for scan in sorted(set(scans))
    ]
    assert len(groups) == len(literal)
    for group, expected in zip(groups, literal, strict=True):
        np.testing.assert_array_equal(group, expected)


def test_a_map_tells_how_much_it_holds():
    assert SegmentMap(THREE).scan.tolist() == [0, 0, 0]
    assert repr(SegmentMap(THREE, scan=[0, 0, 2])) == "SegmentMap(3 segments of 2 scans)"
    assert repr(SegmentMap(THREE[:1])) == "SegmentMap(1 segment of 1 scan)"
    assert repr(SegmentMap([])) == "SegmentMap(0 segments of 0 scans)" and len(SegmentMap([])) == 0


# --------------------------------------------------------------------- arguments
@pytest.mark.parametrize("nothing", [[], [[]], np.empty((0, 5))])
def test_nothing_at_all_is_no_point(nothing):
    """Catches an empty list in a list, or no rows of five columns, that are refused."""
    assert arrays.points(nothing).shape == (0, 2)


def test_a_coordinate_at_the_limit_is_within_it():
    """Catches a limit that refuses itself beside a row of NaN, or is named for the one above it."""
    there = (arrays.LIMIT, 0, 0)
    assert arrays.poses([(np.nan,) * 3, there], missing=True).shape == (2, 3)
    with pytest.raises(ValueError, match=r"poses must be within 1e\+07, .* poses\[1\] is"):
        arrays.poses([there, (2 * arrays.LIMIT, 0, 0)])


def test_a_whole_number_that_rounding_may_have_made_is_refused():
    """Catches 2^53, which 2^53 + 1 becomes as a float."""
    assert arrays.indices([2**53 - 1], "scan").tolist() == [2**53 - 1]
    with pytest.raises(ValueError, match="scan must be whole numbers"):
        arrays.indices([2**53 + 1], "scan")


def test_an_angle_is_at_most_a_whole_turn_and_told_in_radians():
    """Catches another bound where none is given, and the hint of degrees for metres."""

    @arrays.checked
    def call(turn: arrays.Radians, *, reach: Annotated[arrays.Metres, arrays.at_most(5.0)] = 1.0):
        return turn, reach

    assert call(2 * np.pi) == (2 * np.pi, 1.0)
    for refused in (lambda: call(7), lambda: call(turn=7)):
        with pytest.raises(ValueError, match=r"in radians \(of degrees np.radians\(7\)\), got 7$"):
            refused()
    with pytest.raises(ValueError, match=r"a number above 0 and of at most 5, in metres, got 7$"):
        call(1, reach=7)
