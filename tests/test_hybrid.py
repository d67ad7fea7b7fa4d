"""Hybrid against the literal method, its symmetries, its filter and its weaknesses."""

import numpy as np
import pytest
import reference

from segmap import load
from segmap.extraction import build_map
from segmap.poses import transform
from segmap.reduction import _hybrid_loops as loops
from segmap.reduction import hybrid
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal, segment_zoo


def random_map(rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(-1, 1, (50, 2, 2))


def redundant_map(rng: np.random.Generator) -> np.ndarray:
    """Pieces of five walls around the origin, each seen a dozen times with noise."""
    walls = rng.uniform(-3, 3, (5, 2, 2))
    part = rng.uniform(0, 1, (60, 2))[..., None]
    wall = walls[rng.integers(0, 5, 60)]
    return wall[:, :1] + part * (wall[:, 1:] - wall[:, :1]) + rng.normal(0, 0.02, (60, 2, 2))


def lattice_map(rng: np.random.Generator) -> np.ndarray:
    """Ties, duplicates, crossings, lines through the origin, segments without length."""
    return np.repeat(rng.integers(-3, 4, (25, 2, 2)) * 0.15, 2, axis=0)


MAPS = [random_map, redundant_map, lattice_map]


@pytest.mark.parametrize("make", MAPS)
@pytest.mark.parametrize(
    "thresholds", [(0.1, 0.1, 0.0), (0.2, np.pi / 18, 0.2), (0.37, 0.5, 0.1), (0.2, np.pi / 2, 0.0)]
)
@pytest.mark.parametrize("seed", range(6))
def test_equals_the_literal_method(make, thresholds, seed):
    """A candidate that the grid misses, a wrong representative, a tie, a forgotten filter."""
    rng = np.random.default_rng(seed)
    segments = make(rng)
    scans = rng.integers(0, 6, len(segments))
    distance, angle, least = thresholds
    expected, into = reference.hybrid(segments.tolist(), scans.tolist(), distance, angle, least)
    found = hybrid(SegmentMap(segments, scans), distance=distance, angle=angle, min_length=least)
    assert_segments_equal(found.segments, expected, ordered=True)
    np.testing.assert_array_equal(found.parents, into)


@pytest.mark.parametrize("turn", [0.0, 0.4, np.pi / 2])
def test_equals_the_literal_method_on_a_real_map(turn):
    """Turned by a right angle, theta of half of the walls lies where it wraps."""
    log = load("malaga")
    map = build_map(log, log.truth)
    map = SegmentMap(transform((0, 0, turn), map.segments[:400]), map.scan[:400])
    expected, into = reference.hybrid(
        map.segments.tolist(), map.scan.tolist(), 0.2, np.pi / 18, 0.2
    )
    found = hybrid(map)
    assert_segments_equal(found.segments, expected, ordered=True)
    np.testing.assert_array_equal(found.parents, into)


@pytest.mark.parametrize("name", segment_zoo())
def test_zoo(name):
    segments = segment_zoo()[name]
    zeros = [0] * len(segments)
    expected, into = reference.hybrid(segments.tolist(), zeros, 0.3, 0.3, 0.0)
    found = hybrid(segments, distance=0.3, angle=0.3, min_length=0.0)
    assert_segments_equal(found.segments, expected, ordered=True)
    np.testing.assert_array_equal(found.parents, into)


@pytest.mark.parametrize("turn", [np.pi / 2, 1.234, -3.0])
def test_turning_about_the_origin_turns_the_result(turn):
    """Theta wraps at half a turn, and rho changes its sign there."""
    segments = redundant_map(np.random.default_rng(5))
    found, expected = hybrid(transform((0, 0, turn), segments)), hybrid(segments)
    np.testing.assert_array_equal(found.parents, expected.parents)
    moved = transform((0, 0, turn), expected.segments)
    assert_segments_equal(found.segments, moved, ordered=True, atol=1e-8)


def test_moving_the_map_can_change_the_result():
    """The counter-example: rho of a slanted wall changes with the distance of the origin."""
    walls = np.array([[(0, 0.0), (2, 0.0)], [(1.95, 0.0), (3.9, 0.2)]])
    there = transform((-20, 0, 0), walls)
    assert [len(hybrid(walls)), len(hybrid(there))] == [1, 2]


def test_scaling_every_length_scales_the_result():
    segments = redundant_map(np.random.default_rng(6))
    found, expected = hybrid(1000 * segments, distance=200.0), hybrid(segments, distance=0.2)
    assert_segments_equal(found.segments, 1000 * expected.segments, ordered=True, atol=1e-6)


def test_swapping_end_points_changes_nothing():
    segments = redundant_map(np.random.default_rng(7))
    assert_segments_equal(hybrid(segments[:, ::-1]).segments, hybrid(segments).segments)


def test_walls_at_0_and_179_degrees_merge():
    """Theta of the normal compared as plain numbers keeps them apart."""
    for turn in (0.0, 0.3, np.pi / 2):
        wall = np.array([[(0, 0.02), (2, -0.02)], [(0, -0.02), (2, 0.02)]])
        assert len(hybrid(transform((0, 0, turn), wall))) == 1


def test_nearness_is_not_symmetric():
    """The counter-example: a short piece in the middle of a wall is near it, not the reverse."""
    wall, piece = [(0, 0), (5, 0)], [(2, 0.05), (3, 0.05)]
    assert len(hybrid([wall, piece])) == 1
    assert len(hybrid([piece, wall])) == 2


def test_two_far_walls_on_one_line_stay_two():
    """They match in Hough space, which is why nearness comes first (A fig. 4.9)."""
    assert len(hybrid([[(0, 1), (2, 1)], [(5, 1), (7, 1)]])) == 2


def test_the_filter_drops_what_neither_matches_nor_is_long_enough():
    segments = [[(0, 0), (0.1, 0)], [(1, 0), (3, 0)], [(1.5, 0.01), (1.6, 0.01)]]
    found = hybrid(segments)
    np.testing.assert_array_equal(found.parents, [-1, 0, 0])
    assert len(hybrid(segments, min_length=0.0)) == 2


def test_the_filter_keeps_what_is_exactly_long_enough():
    assert len(hybrid([[(0, 0), (0.25, 0)]], min_length=0.25)) == 1
    assert len(hybrid([[(0, 0), (0.25, 0)]], min_length=0.2500001)) == 0


@pytest.mark.parametrize("seed", range(40))
def test_a_segment_takes_no_more_entries_than_room_is_made_for(seed):
    """One entry too many is written beside the grid, into other memory."""
    rng = np.random.default_rng(seed)
    segment = rng.uniform(-1, 1, (2, 2)) * rng.choice([0.05, 0.5, 20.0])
    state = loops.with_room(loops.start(1), 10_000)
    state.s[0] = segment
    loops.enter(state, 0, 0.2)
    assert loops.most_entries(segment, segment, 0.2) >= state.used[1] >= 1


def test_records_each_scan():
    map = SegmentMap(redundant_map(np.random.default_rng(1)), np.repeat([2, 5, 9], 20))
    found = hybrid(map)
    assert len(found.scan_seconds) == len(found.scan_live) == 3
    assert found.scan_live[-1] == len(found)
    assert found.scan_live[0] == len(hybrid(map.segments[:20]))
