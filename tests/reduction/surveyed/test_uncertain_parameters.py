"""Uncertain parameters: two looks by hand, and lines that are very long."""

import numpy as np
import pytest
from reduction_maps import assert_plain, corridor_map

from segmap.reduction import uncertain_parameters
from segmap.reduction.surveyed import fused, uncertain
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal

PAIR = np.array([[(0, 0), (4, 0)], [(3, 0.02), (4, 0.04)]])


def test_a_long_look_and_a_short_one():
    """Catches weights without the length, or deviations that are added."""
    found = uncertain_parameters(PAIR)
    assert_segments_equal(found, [[(0, 0.000492), (4.000012, 0.001724)]], atol=6e-7)
    d = np.diff(found.segments[0], axis=0)[0]
    assert np.degrees(np.arctan2(d[1], d[0])) == pytest.approx(0.017635, abs=1e-6)
    wall = fused([uncertain(s, 0.01, i) for i, s in enumerate(PAIR.tolist())], None)
    assert wall.sigma_theta == pytest.approx(0.0048507, abs=1e-7)
    assert wall.sigma_rho == pytest.approx(0.0070711, abs=1e-7)


@pytest.mark.parametrize("seed", range(2))
def test_lines_of_hundreds_of_metres_are_known_no_better_than_any_line(monkeypatch, seed):
    """Two looks of 400 m, whose deviations would fall below those that no line is known by."""
    rng = np.random.default_rng(seed)
    map = SegmentMap(100 * corridor_map(rng, 40), rng.integers(0, 9, 40))
    assert_plain(monkeypatch, "uncertain_parameters", map, distance=10.0)
    wall = fused([uncertain([(0, 0), (400, 0.1 * k)], 0.001, k) for k in range(9)], "pair")
    assert (wall.sigma_rho, wall.sigma_theta) == (0.001, 1e-4)
