"""Hybrid: its lines in Hough space, its filter and its weaknesses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from segmap_course import literal

from segmap.reduction import hough, hybrid
from segmap.reduction._hough import line_of

NUMBER = st.floats(-20, 20)
POINT = st.tuples(NUMBER, NUMBER)
SEGMENT = st.tuples(POINT, POINT).filter(lambda s: np.hypot(*np.subtract(*s)) > 1e-3).map(np.array)


@given(SEGMENT, st.floats(-10, 10))
def test_both_end_points_lie_on_the_line(segment, near):
    """Catches a slope, a sign lost with a half turn, and another theta than the nearest."""
    rho, theta = hough(segment, near)
    assert segment @ [np.cos(theta), np.sin(theta)] == pytest.approx(rho, abs=1e-8)
    assert abs(theta - near) <= np.pi / 2 + 1e-9
    assert 0 <= hough(segment)[1] < np.pi


def test_many_lines_at_once_are_those_of_the_loops_and_of_the_literal_method():
    """Catches two definitions that drift apart."""
    segments = np.random.default_rng(8).uniform(-9, 9, (50, 2, 2))
    found = hough(segments)
    assert found == pytest.approx(np.array([line_of(segments, i) for i in range(50)]))
    assert found == pytest.approx(np.array([literal.hough(s) for s in segments]))
    assert hough(segments, found[:, 1]) == pytest.approx(found)


def test_the_filter_drops_what_neither_matches_nor_is_long_enough():
    segments = [[(0, 0), (0.1, 0)], [(1, 0), (3, 0)], [(1.5, 0.01), (1.6, 0.01)]]
    found = hybrid(segments)
    np.testing.assert_array_equal(found.parents, [-1, 0, 0])
    assert len(hybrid(segments, min_length=0.0)) == 2


def test_the_filter_keeps_what_is_exactly_long_enough():
    assert len(hybrid([[(0, 0), (0.25, 0)]], min_length=0.25)) == 1
    assert len(hybrid([[(0, 0), (0.25, 0)]], min_length=0.2500001)) == 0
