"""The public assertions and the samples of inputs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import segmap
from segmap import arrays
from segmap.testing import assert_poses_equal, assert_segments_equal

THREE = np.array([[(0, 0), (1, 0)], [(1, 1), (1, 2)], [(0, 5), (2, 5)]], float)
A, B, C = THREE
NUMBER = st.floats(-20, 20)
MAP = st.lists(st.tuples(st.tuples(NUMBER, NUMBER), st.tuples(NUMBER, NUMBER)), max_size=6)


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
        with pytest.raises(AssertionError):
            assert_segments_equal(moved, segments, ordered=True, atol=1e-6)
    assert_segments_equal(moved, segments, atol=1e-2)


def upright(*places):
    return np.array([[(x, 0), (x, 1)] for x in places])


@pytest.mark.parametrize(
    ("actual", "expected", "options", "words"),
    [
        ([C, [(1, 1), (1, 2.25)], A], THREE, {}, r"segment 1 \[\[1, 1\].*is segment 1.*by 0.25 m"),
        ([A, C, B], THREE, {"ordered": True}, r"segment 1 differs by 4 m: actual \[\[0, 5\], \[2"),
        ([A, A, B], [A, B, B], {}, "actual segment 1"),
        (THREE[:2], THREE, {}, "actual holds 2 segments, expected 3"),
        ([], [A], {}, "actual holds 0 segments, expected 1"),
        (upright(0.5, 0.0), upright(0.3, 1.0), {"atol": 0.45}, "no partner"),
    ],
)
def test_what_differs_is_named(actual, expected, options, words):
    """Catches a comparison of sets, and words about another segment."""
    with pytest.raises(AssertionError, match=words):
        assert_segments_equal(actual, expected, **options)


def test_rounding_partners_and_maps_are_no_difference():
    """Catches end points sorted by x, where rounding decides which comes first in an upright wall,
    and a greedy choice of the nearest, which leaves another one alone."""
    for tilt in (1e-12, -1e-12):
        assert_segments_equal(upright(1) + [[(tilt, 0), (-tilt, 0)]], upright(1))
    assert_segments_equal(upright(0.5, 0.0), upright(0.3, 1.0), atol=0.55)
    assert_segments_equal([A, B, A], [A, A, B])
    assert_segments_equal(segmap.SegmentMap(THREE), THREE)


# ----------------------------------------------------------------- pose assertion
NOWHERE = (np.nan,) * 3


@pytest.mark.parametrize(
    ("actual", "words"),
    [
        ([(1, 2, -np.pi), (0, 0, 7 - 2 * np.pi), NOWHERE], ""),
        ([(1, 2, np.pi), (0, 0, 7.5), NOWHERE], r"pose 1 differs by 0 m and 0\.5 rad"),
        ([(4, 6, np.pi), (0, 0, 7), NOWHERE], "pose 0 differs by 5 m and 0 rad"),
        ([NOWHERE, (0, 0, 7), NOWHERE], "pose 0"),
        ([(1, 2, np.pi), (0, 0, 7), (0, 0, 0)], "pose 2"),
    ],
)
def test_poses_a_turn_apart_are_the_same_and_unknown_ones_equal_unknown_ones(actual, words):
    """Catches pi compared with -pi as numbers, and headings that are not compared."""
    poses = [(1, 2, np.pi), (0, 0, 7), NOWHERE]
    if not words:
        return assert_poses_equal(actual, poses)
    with pytest.raises(AssertionError, match=words):
        assert_poses_equal(actual, poses)
