"""Weighted line fitting: how well a merge is known, and where the method fails."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose

from segmap.compiled import PLAIN
from segmap.reduction import weighted_line_fitting
from segmap.reduction.surveyed import Line, about, compare
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal


def a_map(walls, sensors=None, points_each: int = 21) -> SegmentMap:
    """Walls, each of its own scan, with points from end to end."""
    s = np.array(walls, float)
    t = np.linspace(0, 1, points_each)[:, None]
    points = np.concatenate([a + t * (b - a) for a, b in s])
    first = np.arange(len(s) + 1) * points_each
    return SegmentMap(s, np.arange(len(s)), points=points, first=first, sensors=sensors)


@pytest.mark.parametrize("seed", range(8))
def test_chi_is_symmetric_and_a_merge_is_known_better_than_both(seed):
    """SURVEYED check d; catches the normal that is turned without its covariance."""
    rng = np.random.default_rng(seed)

    def line() -> Line:
        c = rng.normal(size=(2, 2)) * (0.03, 0.01)
        rr, ra, aa = (c @ c.T)[[0, 0, 1], [0, 1, 1]]
        turned = rng.integers(-2, 3) * math.pi
        return Line(*rng.normal(size=2), rng.normal(0, 0.1) + turned, rr, ra, aa)

    a, b = line(), line()
    (chi, merged), (back, same) = compare(a, b), compare(b, a)
    assert chi == pytest.approx(back, rel=1e-6)
    assert_allclose(merged[:2] + merged[3:], same[:2] + same[3:], rtol=1e-6, atol=1e-9)
    assert math.sin(merged.alpha - same.alpha) == pytest.approx(0, abs=1e-9)
    middle = (a.x + b.x) / 2, (a.y + b.y) / 2
    for one in (a, b):
        assert about(merged, *middle)[1] <= about(one, *middle)[1] * (1 + 1e-9)
        assert merged.aa <= one.aa * (1 + 1e-9)


def test_far_walls_on_one_line_merge_without_a_test_of_extent():
    """Weak, as A prints it: across the building. The gap keeps them apart, and is inclusive."""
    map = a_map([[(0, 0), (2, 0)], [(9, 0), (11, 0)]], sensors=np.full((2, 2), (5.0, 3.0)))
    assert len(weighted_line_fitting(map)) == len(weighted_line_fitting(map, gap=6.99)) == 2
    found = weighted_line_fitting(map, gap=math.inf)
    assert_segments_equal(found, [[(0, 0), (11, 0)]])
    assert len(weighted_line_fitting(map, gap=7.0)) == 1


def test_a_threshold_that_allows_all_writes_nothing_beyond_the_index():
    """Catches a room of 1e75 m, more than the index has levels for: the loops check no index."""
    walls = "[[(0, 0), (3, 0)], [(3, 0), (3, 2)], [(3, 2), (0, 2)]]"
    text = f"from segmap import reduction as r; r.weighted_line_fitting({walls}, chi2=1e155)"
    subprocess.run([sys.executable, "-c", text], check=True, env={**os.environ, PLAIN: "1"})
