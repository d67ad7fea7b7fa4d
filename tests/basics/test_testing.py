"""The public assertions and the samples of inputs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import segmap
from segmap import arrays
from segmap.testing import assert_poses_equal, assert_segments_equal

THREE = np.array([[(0, 0), (1, 0)], [(1, 1), (1, 2)], [(0, 5), (2, 5)]], float)
NUMBER = st.floats(-20, 20)
MAP = st.lists(st.tuples(st.tuples(NUMBER, NUMBER), st.tuples(NUMBER, NUMBER)), max_size=6)


def refused(actual, expected, **options):
    with pytest.raises(AssertionError) as caught:
        assert_segments_equal(actual, expected, **options)
    return str(caught.value)


# -------------------------------------------------------------- segment assertion
@given(MAP, st.randoms())
def test_segments_are_equal_whichever_end_and_segment_comes_first(segments, random):
    """Catches an assertion that knows a direction, or an order."""
    other = [s[::-1] if random.random() < 0.5 else s for s in segments]
    random.shuffle(other)
    assert_segments_equal(segments, other)
    assert_segments_equal(np.reshape(segments, (-1, 2, 2)), other)


@given(MAP.filter(len), st.data(), st.sampled_from([-1e-3, 1e-3]))
def test_a_coordinate_that_is_off_is_seen(segments, data, step):
    """Catches an assertion that cannot fail."""
    moved = np.array(segments, float)
    place = tuple(data.draw(st.integers(0, n - 1)) for n in moved.shape)
    moved[place] += step
    ours, theirs = sorted(map(str, arrays.segments(segments))), sorted(map(str, moved))
    if ours != theirs:
        refused(moved, segments, ordered=True, atol=1e-6)
    assert_segments_equal(moved, segments, atol=1e-2)


def test_the_first_segment_without_a_partner_is_named_with_the_nearest():
    moved = THREE[[2, 1, 0]] + 0.0
    moved[1, 1, 1] = 2.25
    assert refused(moved, THREE) == (
        "actual segment 1 [[1, 1], [1, 2.25]] has no partner in expected; "
        "nearest is segment 1 [[1, 1], [1, 2]], off by 0.25 m"
    )


def test_order_counts_where_it_is_asked_for_and_direction_never():
    assert_segments_equal(THREE[:, ::-1], THREE, ordered=True)
    message = refused(THREE[[0, 2, 1]], THREE, ordered=True)
    assert message.startswith("segment 1 differs by 4 m: actual [[0, 5], [2, 5]], expected [[1, 1]")


def test_repeated_segments_are_counted():
    """Catches a comparison of sets."""
    a, b = THREE[0], THREE[1]
    assert "actual segment 1" in refused([a, a, b], [a, b, b])
    assert_segments_equal([a, b, a], [a, a, b])


def test_a_missing_or_extra_segment_is_counted():
    for actual, expected in ((2, 3), (3, 2), (0, 1)):
        said = f"actual holds {actual} segments, expected {expected}"
        assert refused(THREE[:actual], THREE[:expected]) == said


def test_rounding_of_one_coordinate_does_not_exchange_end_points():
    """Catches end points sorted by x: in an upright wall rounding decides which comes first."""
    upright = np.array([[(1, 0), (1, 2)]])
    for tilt in (1e-12, -1e-12):
        assert_segments_equal(upright + [[(tilt, 0), (-tilt, 0)]], upright)


def test_partners_are_shared_out_so_that_all_get_one():
    """Catches a greedy choice of the nearest, which leaves another one alone."""
    places = [np.array([[(x, 0), (x, 1)] for x in xs]) for xs in ((0.5, 0.0), (0.3, 1.0))]
    assert_segments_equal(*places, atol=0.55)
    refused(*places, atol=0.45)


def test_maps_and_reductions_are_accepted_and_what_is_no_map_is_named():
    assert_segments_equal(segmap.SegmentMap(THREE), THREE)
    with pytest.raises(ValueError, match="actual must have shape"):
        assert_segments_equal(THREE.reshape(3, 4), THREE)
    with pytest.raises(ValueError, match="expected must be finite"):
        assert_segments_equal(THREE, THREE * np.nan)


# ----------------------------------------------------------------- pose assertion
def test_headings_a_turn_apart_are_the_same_and_others_are_not():
    """Catches pi compared with -pi as numbers, and headings that are not compared."""
    assert_poses_equal([(1, 2, np.pi), (0, 0, 7)], [(1, 2, -np.pi), (0, 0, 7 - 2 * np.pi)])
    with pytest.raises(AssertionError, match=r"pose 1 differs by 0 m and 0\.5 rad"):
        assert_poses_equal([(1, 2, 0), (0, 0, 0.5)], [(1, 2, 0), (0, 0, 0)])
    with pytest.raises(AssertionError, match="pose 0 differs by 5 m and 0 rad"):
        assert_poses_equal([(3, 4, 0)], [(0, 0, 0)])


def test_unknown_poses_equal_unknown_ones_only():
    nan = (np.nan,) * 3
    assert_poses_equal([nan, (0, 0, 0)], [nan, (0, 0, 0)])
    with pytest.raises(AssertionError, match="pose 0"):
        assert_poses_equal([nan], [(0, 0, 0)])
    with pytest.raises(AssertionError, match="pose 0"):
        assert_poses_equal([(0, 0, 0)], [nan])
