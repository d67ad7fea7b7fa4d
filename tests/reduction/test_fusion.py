"""Fusion: the best strip of all, what stays inside it, and its weaknesses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reduction_maps import MAPS, corridor_map, malaga

from segmap.poses import transform
from segmap.reduction import fusion, fusion_online
from segmap.segments import SegmentMap, length
from segmap.testing import assert_segments_equal

TOLERANCE = 0.04


@pytest.mark.parametrize("seed", range(8))
def test_first_chain_is_at_least_as_long_as_any_on_a_fine_grid_of_lines(seed):
    """A greedy move of the line, or a forgotten shift, misses the best strip."""
    segments = corridor_map(np.random.default_rng(seed), 40)
    lengths = length(segments)
    first = int(np.argmax(lengths))
    found = fusion(segments, tolerance=TOLERANCE)
    total = lengths[found.members(0)].sum()
    (x, y), d = segments[first].mean(0), np.diff(segments[first], axis=0)[0] / lengths[first]
    r = segments - (x, y)
    u, v = np.sort(r @ d, axis=1), np.sort(r[..., 1] * d[0] - r[..., 0] * d[1], axis=1)
    for shift in 0.999 * np.linspace(-TOLERANCE, TOLERANCE, 201):
        inside = (v[:, 1] <= shift + TOLERANCE) & (v[:, 0] >= shift - TOLERANCE)
        reach = u[first].copy()
        for _ in range(len(segments)):
            chain = inside & (u[:, 0] <= reach[1]) & (u[:, 1] >= reach[0])
            reach = np.array([u[chain, 0].min(), u[chain, 1].max()])
        assert lengths[chain].sum() <= total + 1e-9


@given(st.integers(0, 10_000))
def test_members_lie_inside_their_strip(seed):
    """Lost or invented segments, parents that point nowhere, outputs longer than their strip."""
    rng = np.random.default_rng(seed)
    segments = MAPS[seed % 4](rng)
    found = fusion(segments, tolerance=TOLERANCE)
    kept = length(segments) >= 1e-9
    assert len(found) <= kept.sum()
    np.testing.assert_array_equal(found.parents >= 0, kept)
    assert set(found.parents[kept]) == set(range(len(found)))
    for k, (a, b) in enumerate(found.segments):
        ends = segments[found.members(k)].reshape(-1, 2)
        along = (b - a) / np.hypot(*(b - a))
        off = np.abs((ends - a) @ (-along[1], along[0]))
        assert off.max() <= TOLERANCE + 1e-8


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("turn", [0.0, np.pi])
def test_of_equal_chains_the_first_indices_win(side, turn):
    """A line that moves up or down by as much for as much: the order of the input decides."""
    rows = [[(0, 0), (3, 0)], [(1, 0.0625 * side), (2, 0.0625 * side)]]
    rows.append([(1, -0.0625 * side), (2, -0.0625 * side)])
    found = fusion(transform((0, 0, turn), rows), tolerance=0.05)
    assert found.parents.tolist() == [0, 0, 1]


# ------------------------------------------------------------------ after every scan


def test_on_line_every_pass_widens_what_a_strip_reaches():
    """The counter-example: looks that drift away are one wall on-line and two off-line.

    A wall that has taken in a look 8 cm beside it stands between both, and reaches the next.
    """
    drift = [[(0, y), (2, y)] for y in (0.0, 0.08, 0.12, 0.14)]
    map = SegmentMap(drift, range(4))
    found = fusion_online(map, tolerance=0.05)
    assert found.scan_live.tolist() == [1, 1, 1, 1]
    assert len(fusion(map, tolerance=0.05)) == 2


def test_on_line_with_one_scan_is_off_line():
    """Catches a last pass too many, or one that is left out."""
    map = malaga()
    once = SegmentMap(map.segments)
    assert_segments_equal(fusion_online(once), fusion(map), ordered=True)
    assert len(fusion_online(map)) < len(fusion(map))
