"""Hybrid with Fusion: against the literal methods one after the other, its parents, its gains."""

import numpy as np
import pytest
import reference
from test_hybrid import MAPS, redundant_map

from segmap import load
from segmap.extraction import build_map
from segmap.poses import transform
from segmap.reduction import fusion, hybrid, hybrid_fusion
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal, segment_zoo

DISTANCE, ANGLE, TOLERANCE = 0.20, np.pi / 18, 0.04


def malaga() -> SegmentMap:
    log = load("malaga")
    return build_map(log, log.truth)


def assert_literal(map: SegmentMap, distance, angle, min_length, tolerance, every) -> None:
    segments, scans = map.segments.tolist(), map.scan.tolist()
    expected, into = reference.hybrid_fusion(
        segments, scans, distance, angle, min_length, tolerance, every
    )
    found = hybrid_fusion(
        map,
        distance=distance,
        angle=angle,
        min_length=min_length,
        tolerance=tolerance,
        every=every,
    )
    assert_segments_equal(found.segments, np.reshape(expected, (-1, 2, 2)), ordered=True)
    np.testing.assert_array_equal(found.parents, into)


@pytest.mark.parametrize("make", MAPS)
@pytest.mark.parametrize("every", [1, 2, 5, 100])
@pytest.mark.parametrize("thresholds", [(0.2, ANGLE, 0.2, 0.04), (0.37, 0.5, 0.0, 0.11)])
@pytest.mark.parametrize("seed", range(4))
def test_equals_the_literal_methods_one_after_the_other(make, every, thresholds, seed):
    """Counts, lines or cells of before a Fusion used after it; a Fusion too many or too few."""
    rng = np.random.default_rng(seed)
    segments = make(rng)
    assert_literal(SegmentMap(segments, rng.integers(0, 12, len(segments))), *thresholds, every)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_equals_the_literal_methods_on_a_real_map(turn):
    map = malaga()
    segments = transform((0, 0, turn), map.segments[:400])
    assert_literal(SegmentMap(segments, map.scan[:400]), DISTANCE, ANGLE, 0.2, TOLERANCE, 7)


@pytest.mark.parametrize("name", segment_zoo())
def test_zoo(name):
    segments = segment_zoo()[name]
    scans = np.arange(len(segments)) // 2
    assert_literal(SegmentMap(segments, scans), 0.3, 0.3, 0.0, TOLERANCE, 1)


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


def scanned(seed: int) -> SegmentMap:
    segments = redundant_map(np.random.default_rng(seed))
    return SegmentMap(segments, np.arange(len(segments)) // 4)


@pytest.mark.parametrize("turn", [np.pi / 2, 1.234, -3.0])
def test_turning_about_the_origin_turns_the_result(turn):
    """Theta of a fused segment that is not that of its line, or wraps wrongly."""
    map = scanned(5)
    there = SegmentMap(transform((0, 0, turn), map.segments), map.scan)
    found, expected = hybrid_fusion(there, every=3), hybrid_fusion(map, every=3)
    np.testing.assert_array_equal(found.parents, expected.parents)
    moved = transform((0, 0, turn), expected.segments)
    assert_segments_equal(found.segments, moved, ordered=True, atol=1e-8)


def test_moving_the_map_can_change_the_result():
    """The counter-example of Hybrid: rho of a slanted wall changes with the distance of the origin.

    Fusion does not mend it: the second wall leaves its strip.
    """
    walls = np.array([[(0, 0.0), (2, 0.0)], [(1.95, 0.0), (3.9, 0.2)]])
    there = transform((-20, 0, 0), walls)
    assert [len(hybrid_fusion(walls)), len(hybrid_fusion(there))] == [1, 2]


def test_scaling_every_length_scales_the_result():
    map = scanned(6)
    large = SegmentMap(1000 * map.segments, map.scan)
    found = hybrid_fusion(large, distance=200.0, tolerance=40.0, every=3)
    expected = 1000 * hybrid_fusion(map, every=3).segments
    assert_segments_equal(found.segments, expected, ordered=True, atol=1e-6)


def test_swapping_end_points_changes_nothing():
    map = scanned(7)
    swapped = SegmentMap(map.segments[:, ::-1], map.scan)
    found, expected = hybrid_fusion(swapped, every=3), hybrid_fusion(map, every=3)
    assert_segments_equal(found.segments, expected.segments, ordered=True)


def test_fewer_segments_than_hybrid_on_a_real_map_and_a_smaller_map_meanwhile():
    """What the thesis hopes for (A 7); a Fusion that does nothing fails here."""
    map = malaga()
    plain, often = (
        hybrid(map, distance=0.1),
        hybrid_fusion(map, distance=0.1, tolerance=0.02, every=10),
    )
    assert len(often) < 0.7 * len(plain)
    assert often.scan_live.max() < 0.8 * plain.scan_live.max()


def test_weakness_a_stub_that_hybrid_keeps_is_swallowed():
    """Hybrid tests angles and Fusion does not: so the two together do not."""
    wall_and_stub = [[(0, 0), (4, 0)], [(2, -0.03), (2, 0.03)]]
    assert len(hybrid(wall_and_stub, min_length=0.0)) == 2
    assert len(hybrid_fusion(wall_and_stub, min_length=0.0)) == 1
