"""Hybrid with Fusion: weights and parents through both, and what it gains."""

from inspect import signature

import numpy as np
import pytest
from reduction_maps import MAPS

from segmap.reduction import LiveReduction, fusion, hybrid, hybrid_fusion
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal


def test_a_fused_segment_weighs_as_much_as_its_parts():
    """A count that starts again at 1 lets one new segment turn a wall that was seen ten times."""
    walls = [[(0, 1), (2, 1)], [(3, 1), (5, 1)], [(1.9, 1), (3.1, 1)]] + 7 * [[(0, 1), (5, 1)]]
    new = [[(0, 1.11), (5, 1.11)]]
    found = hybrid_fusion(SegmentMap(walls + new, [0] * 10 + [1]), every=1)
    assert len(found) == 1
    np.testing.assert_allclose(found.segments[0, :, 1], 1.01, atol=1e-12)


def test_a_fused_segment_has_its_own_line():
    """A mean of the lines of its parts would lie elsewhere, and the next one would not match."""
    walls = [[(0, 0), (4, 0)], [(1, 0.08), (1.5, 0.08)], [(2, 0.08), (2.5, 0.08)]]
    map = SegmentMap([*walls, [(0, 0.03), (4, 0.03)]], [0, 0, 0, 1])
    found = hybrid_fusion(map, distance=0.06, tolerance=0.05, every=1)
    assert len(found) == 1
    (shift,) = {y for y in fusion(walls, tolerance=0.05).segments[0, :, 1].round(12)}
    np.testing.assert_allclose(found.segments[0, :, 1], (3 * shift + 0.03) / 4, atol=1e-12)


def test_parents_follow_through_hybrid_and_every_fusion():
    """Where each wall went is known from how the map was made."""
    rng = np.random.default_rng(3)
    wall = rng.integers(0, 6, 200)
    along = np.sort(rng.uniform(0, 6, (200, 2)), axis=1)
    off = 2.0 * wall[:, None] + rng.normal(0, 0.01, (200, 2))
    map = SegmentMap(np.stack([along, off], axis=-1), rng.integers(0, 40, 200))
    found = hybrid_fusion(map, min_length=0.0, every=3)
    assert len(found) == 6
    np.testing.assert_allclose(found.segments[found.parents, 0, 1], 2.0 * wall, atol=0.05)


def test_a_live_map_is_that_of_the_method():
    """Catches a fusion that comes too early or too late; a scan without segments is none."""
    rng = np.random.default_rng(5)
    walls = np.array([[(0, y), (4, y)] for y in (0, 1, 2, 3)]).repeat(6, axis=0)
    map = SegmentMap(walls + rng.normal(0, 0.02, walls.shape), np.tile(np.arange(12), 2))
    live = LiveReduction(every=5)
    _, *options = signature(hybrid_fusion).parameters.values()
    assert signature(LiveReduction).parameters == {option.name: option for option in options}
    for part in (map.segments[:0], *map.by_scan()):
        live.add(part)
        if live.scans % 5 == 0 and live.scans:
            found = hybrid_fusion(map[map.scan < live.scans], every=5)
            np.testing.assert_array_equal(live.segments, found.segments)
    assert live.scans == 12


def test_what_hybrid_dropped_stays_dropped():
    """A fused index read at -1 is that of the last segment."""
    map = SegmentMap([[(9, 9), (9.1, 9)], [(0, 0), (3, 0)], [(0, 5), (3, 5)]], [0, 1, 2])
    np.testing.assert_array_equal(hybrid_fusion(map, every=1).parents, [-1, 0, 1])


@pytest.mark.parametrize(
    ("every", "live"), [(1, [1, 2, 3, 4]), (2, [2, 2, 4, 4]), (3, [2, 4, 3, 4]), (9, [2, 4, 6, 4])]
)
def test_fusion_runs_after_every_so_many_scans_and_the_last(every, live):
    """Each scan brings a wall that Hybrid keeps in two; scans without segments do not count."""
    walls = [[[(0, y), (2, y)], [(3, y), (5, y)], [(1.9, y), (3.1, y)]] for y in (0, 5, 10, 15)]
    map = SegmentMap(np.concatenate(walls), np.repeat([0, 4, 6, 9], 3))
    found = hybrid_fusion(map, every=every)
    assert len(found.scan_seconds) == 4
    np.testing.assert_array_equal(found.scan_live, live)


@pytest.mark.parametrize("make", MAPS)
@pytest.mark.parametrize("seed", range(3))
def test_no_more_segments_than_hybrid_with_fusion_at_the_end_only(make, seed):
    """Fusion of Hybrid's map is the same as Fusion after the last scan, parents too."""
    rng = np.random.default_rng(seed)
    segments = make(rng)
    map = SegmentMap(segments, rng.integers(0, 9, len(segments)))
    kept = hybrid(map)
    fused, found = fusion(kept), hybrid_fusion(map, every=1000)
    assert_segments_equal(found.segments, fused.segments, ordered=True)
    whole = np.where(kept.parents < 0, -1, np.append(fused.parents, -1)[kept.parents])
    np.testing.assert_array_equal(found.parents, whole)
    assert len(found) <= len(kept)
