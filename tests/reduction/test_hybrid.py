"""Hybrid: its lines in Hough space, and what they owe to the origin."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from segmap_course import literal

from segmap.reduction import hough, hybrid, hybrid_fusion

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


def test_many_lines_at_once_are_those_of_the_literal_method():
    """Catches two definitions that drift apart."""
    segments = np.random.default_rng(8).uniform(-9, 9, (50, 2, 2))
    found = hough(segments)
    assert found == pytest.approx(np.array([literal.hough(s) for s in segments]))
    assert hough(segments, found[:, 1]) == pytest.approx(found)


@pytest.mark.parametrize("method", [hybrid, hybrid_fusion])
def test_an_origin_outside_of_the_map_is_told(method):
    """Malaga: 493 segments at the origin, 897 at 100 m, 1 226 at UTM coordinates."""
    wall = np.array([[(-1.0, 0.0), (3.0, 0.0)], [(0.0, -1.0), (0.0, 2.0)]])
    assert not method(wall).doubt and not method(wall[:0]).doubt
    for to, off in (((5, 0), 4.0), ((-5, 0), 2.0), ((0, 7), 6.0), ((6, 9), np.hypot(5, 8))):
        doubt = method(wall + to).doubt
        assert doubt.startswith(f"the origin lies {off:.1f} m outside of the map")
        assert doubt in repr(method(wall + to))
