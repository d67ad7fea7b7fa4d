"""Basic, off-line and on-line, against the literal double loop, and its symmetries."""

import numpy as np
import pytest
import reference

from segmap import load
from segmap.extraction import build_map
from segmap.metrics import quality
from segmap.poses import transform
from segmap.reduction import basic_offline, basic_online
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal, segment_zoo

DISTANCE, ANGLE = 0.20, np.pi / 18


def random_map(rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(0, 2, (50, 2, 2))


def redundant_map(rng: np.random.Generator) -> np.ndarray:
    """Pieces of five walls, each seen a dozen times with noise, in any direction."""
    walls = rng.uniform(0, 5, (5, 2, 2))
    part = rng.uniform(0, 1, (60, 2))[..., None]
    wall = walls[rng.integers(0, 5, 60)]
    return wall[:, :1] + part * (wall[:, 1:] - wall[:, :1]) + rng.normal(0, 0.02, (60, 2, 2))


def lattice_map(rng: np.random.Generator) -> np.ndarray:
    """Ties, duplicates, crossings and segments without length."""
    return np.repeat(rng.integers(0, 6, (25, 2, 2)) * 0.15, 2, axis=0)


MAPS = [random_map, redundant_map, lattice_map]


def outputs(into: list[int]) -> np.ndarray:
    """Number of the output that each input ended in."""
    survivors = sorted({i for i in into if i >= 0})
    return np.array([survivors.index(i) if i >= 0 else -1 for i in into], int)


@pytest.mark.parametrize("make", MAPS)
@pytest.mark.parametrize("thresholds", [(0.1, 0.1), (0.2, ANGLE), (0.37, 0.5), (0.2, np.pi / 2)])
@pytest.mark.parametrize("seed", range(4))
def test_offline_equals_the_literal_double_loop(make, thresholds, seed):
    """Another order of merges, a missed neighbour, a dead segment that matches."""
    segments = make(np.random.default_rng(seed))
    distance, angle = thresholds
    expected, into = reference.basic(segments.tolist(), [0] * len(segments), distance, angle)
    found = basic_offline(
        SegmentMap(segments, np.arange(len(segments))), distance=distance, angle=angle
    )
    assert_segments_equal(found.segments, expected, ordered=True)
    np.testing.assert_array_equal(found.parents, outputs(into))


@pytest.mark.parametrize("make", MAPS)
@pytest.mark.parametrize("seed", range(6))
def test_online_equals_the_literal_double_loop_after_each_scan(make, seed):
    """Scans out of order in the map; a new segment that an older one has to take in first."""
    rng = np.random.default_rng(seed)
    segments = make(rng)
    scans = rng.integers(0, 7, len(segments))
    expected, into = reference.basic(segments.tolist(), scans.tolist(), DISTANCE, ANGLE)
    found = basic_online(SegmentMap(segments, scans), distance=DISTANCE, angle=ANGLE)
    assert_segments_equal(found.segments, expected, ordered=True)
    order = {k: n for n, k in enumerate(np.argsort(scans, kind="stable"))}
    survivors = sorted({i for i in into if i >= 0}, key=order.__getitem__)
    rows = [survivors.index(i) if i >= 0 else -1 for i in into]
    np.testing.assert_array_equal(found.parents, rows)


@pytest.mark.parametrize("turn", [0.0, 0.4, np.pi / 2])
def test_equals_the_literal_double_loop_on_a_real_map(turn):
    """Rounding decides nothing that matters: the walls along the axes are slanted elsewhere."""
    log = load("malaga")
    map = build_map(log, log.truth)
    map = SegmentMap(transform((0, 0, turn), map.segments[:300]), map.scan[:300])
    for method, scans in ((basic_offline, [0] * 300), (basic_online, map.scan.tolist())):
        expected, _ = reference.basic(map.segments.tolist(), scans, DISTANCE, ANGLE)
        assert_segments_equal(method(map).segments, expected, ordered=True)


def test_online_records_each_scan():
    map = SegmentMap(redundant_map(np.random.default_rng(1)), np.repeat([2, 5, 9], 20))
    found = basic_online(map)
    assert len(found.scan_seconds) == len(found.scan_live) == 3
    assert found.scan_live[-1] == len(found)
    assert found.scan_live[0] == len(basic_offline(map.segments[:20]))
    assert basic_offline(map).scan_live is None


@pytest.mark.parametrize("method", [basic_offline, basic_online])
@pytest.mark.parametrize("make", [random_map, redundant_map])
class TestSymmetries:
    """Basic knows no origin, no axis and no unit; a segment has no direction."""

    @pytest.mark.parametrize("pose", [(0, 0, np.pi / 2), (-70, 40, 1.234), (3, -8, -2.9)])
    def test_moving_the_map_moves_the_result(self, method, make, pose):
        segments = make(np.random.default_rng(5))
        found, expected = method(transform(pose, segments)), method(segments)
        np.testing.assert_array_equal(found.parents, expected.parents)
        assert_segments_equal(
            found.segments, transform(pose, expected.segments), ordered=True, atol=1e-8
        )

    def test_scaling_every_length_scales_the_result(self, method, make):
        segments = make(np.random.default_rng(6))
        found = method(1000 * segments, distance=1000 * DISTANCE)
        assert_segments_equal(
            found.segments, 1000 * method(segments).segments, ordered=True, atol=1e-6
        )

    def test_swapping_end_points_changes_nothing(self, method, make):
        segments = make(np.random.default_rng(7))
        assert_segments_equal(method(segments[:, ::-1]).segments, method(segments).segments)

    def test_idempotent(self, method, make):
        """A map that has converged holds no match."""
        once = method(make(np.random.default_rng(8)))
        assert_segments_equal(method(once).segments, once.segments, ordered=True)


@pytest.mark.parametrize("method", [basic_offline, basic_online])
@pytest.mark.parametrize("name", segment_zoo())
def test_zoo(method, name):
    segments = segment_zoo()[name]
    found = method(segments, distance=0.3, angle=0.3)
    expected, _ = reference.basic(segments.tolist(), [0] * len(segments), 0.3, 0.3)
    assert_segments_equal(found.segments, expected, ordered=True)


def test_end_points_exactly_a_distance_apart_do_not_match():
    """Both tests are strict (A 4.1)."""
    walls = np.array([[(0, 0), (1, 0)], [(1.25, 0), (2, 0)]])
    assert len(basic_offline(walls, distance=0.25)) == 2
    assert len(basic_offline(walls, distance=0.2500001)) == 1


def test_a_wall_at_0_degrees_merges_like_one_at_90():
    wall = np.array([[(0, 0.02), (2, -0.02)], [(0.1, -0.02), (2.1, 0.02)]])
    assert len(basic_offline(wall)) == len(basic_offline(wall[..., ::-1])) == 1


def test_a_map_without_redundancy_is_kept():
    walls = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)]])
    assert quality(walls, basic_offline(walls)) == pytest.approx(1, abs=1e-12)


def test_weakness_a_piece_in_the_middle_of_a_wall_is_never_merged():
    """The counter-example of A fig. 4.4: all end points are far."""
    assert len(basic_offline(np.array([[(0, 0), (5, 0)], [(2, 0), (3, 0)]]))) == 2
