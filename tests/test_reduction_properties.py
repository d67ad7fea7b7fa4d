"""What the thesis says of every method, as properties that hold, or as counter-examples."""

import numpy as np
import pytest
import reference
from conftest import shared_file
from hypothesis import given, settings
from hypothesis import strategies as st

from segmap import load, read
from segmap.extraction import build_map
from segmap.metrics import quality
from segmap.poses import transform
from segmap.reduction import METHODS
from segmap.segments import SegmentMap
from segmap.testing import assert_segments_equal, segment_zoo

methods = pytest.mark.parametrize("name", METHODS)

#: Mean shift cuts walls into pieces, and does not always join them again.
MAY_GROW = {"mean_shift"}
#: Running it again changes nothing: its last pass has found no match.
IDEMPOTENT = {"basic_offline", "basic_online"}


def malaga() -> SegmentMap:
    log = load("malaga")
    return build_map(log, log.truth)


def room() -> np.ndarray:
    """Walls without redundancy: nothing lies near another but at right angles."""
    x, y = (0.0, 4.0, 9.0), (0.0, 3.0)
    across = [[(x[0], v), (x[1], v)] for v in y] + [[(x[1] + 1.0, v), (x[2], v)] for v in y]
    return np.array(across + [[(u, y[0]), (u, y[1])] for u in x])


@methods
@pytest.mark.parametrize("turn", [0.0, np.pi / 2, 0.3, -1.2, np.pi - 1e-9])
def test_a_map_without_redundancy_is_kept(name, turn):
    """Corners that are cut, walls that are joined through a door: quality below 1."""
    walls = transform((0, 0, turn), room())
    found = METHODS[name](SegmentMap(walls, np.arange(len(walls)) // 2))
    assert quality(walls, found) == pytest.approx(1.0, abs=1e-9)
    assert sorted(found.parents) == list(range(len(walls)))
    assert_segments_equal(found.segments[found.parents], walls, ordered=True, atol=1e-9)


@methods
@pytest.mark.parametrize("turn", np.radians([0, 0.4, 30, 89.6, 90, 90.4, 135, 179.6, 180, -90]))
def test_walls_at_0_and_180_degrees_merge_like_walls_at_90(name, turn):
    """Angles compared, or averaged, as plain numbers: two walls, or one across."""
    seen = [[(0.0, 1.01), (2.0, 0.99)], [(0.05, 0.99), (2.05, 1.01)], [(2.0, 1.0), (0.0, 1.0)]]
    map = SegmentMap(transform((0, 0, turn), np.array(seen)), [0, 1, 2])
    found = METHODS[name](map)
    assert len(found) == 1
    back = transform((0, 0, -turn), found.segments)
    np.testing.assert_allclose(back[0, :, 1], 1.0, atol=0.03)
    np.testing.assert_allclose(np.sort(back[0, :, 0]), (0.0, 2.05), atol=0.03)


@methods
@given(seed=st.integers(0, 10_000), scans=st.integers(1, 12))
@settings(max_examples=25)
def test_no_more_segments_than_it_got(name, seed, scans):
    """A segment that is split, or listed twice."""
    if name in MAY_GROW:
        pytest.skip("mean shift cuts walls into pieces: test_mean_shift shows the exception")
    rng = np.random.default_rng(seed)
    segments = rng.normal(0, (2.0, 0.5), (30, 2, 2))
    found = METHODS[name](SegmentMap(segments, rng.integers(0, scans, 30)))
    assert 0 < len(found) <= len(segments)


@methods
@pytest.mark.parametrize("zoo", segment_zoo())
def test_no_more_segments_than_it_got_in_the_zoo(name, zoo):
    """Duplicates, crossings, points, a map far from the origin."""
    segments = segment_zoo()[zoo]
    found = METHODS[name](segments)
    assert np.isfinite(found.segments).all()
    assert set(found.parents) <= set(range(-1, len(found)))
    assert len(found) <= len(segments) or name in MAY_GROW


@pytest.mark.parametrize("name", sorted(IDEMPOTENT))
@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_idempotent_on_a_real_map(name, turn):
    """A last pass that left a match is found by running again."""
    once = METHODS[name](SegmentMap(transform((0, 0, turn), malaga().segments), malaga().scan))
    again = METHODS[name](once)
    assert_segments_equal(again.segments, once.segments, ordered=True)


@pytest.mark.parametrize("name", ["hybrid", "fusion", "hybrid_fusion"])
def test_not_idempotent(name):
    """The counter-example: what has grown together is near what it was far from."""
    once = METHODS[name](malaga())
    assert len(METHODS[name](once)) < len(once)


def test_hybrid_is_not_idempotent_because_it_never_compares_its_own_segments():
    """The smallest counter-example: a third piece joins one of two, and reaches the other."""
    pieces = [[(0, 1), (2, 1)], [(3, 1), (5, 1)], [(1.9, 1), (3.1, 1)]]
    once = METHODS["hybrid"](SegmentMap(pieces, [0, 0, 0]))
    assert [len(once), len(METHODS["hybrid"](once))] == [2, 1]


@pytest.mark.parametrize("turn", [0.0, 1.0])
def test_equality_with_the_literal_methods_on_a_second_building(turn):
    """A denser real map, each wall seen from everywhere, in its scans."""
    log = read(shared_file("data/intel.log.gz"))[:60]
    map = build_map(log, log.truth)
    map = SegmentMap(transform((0, 0, turn), map.segments), map.scan)
    segments, scans = map.segments.tolist(), map.scan.tolist()
    basic = [reference.basic(segments, s, 0.2, 0.17)[0] for s in ([0] * len(map), scans)]
    expected = {
        "basic_offline": basic[0],
        "basic_online": basic[1],
        "hybrid": reference.hybrid(segments, scans, 0.2, 0.17, 0.2)[0],
    }
    for name, literal in expected.items():
        found = METHODS[name](map, distance=0.2, angle=0.17)
        assert_segments_equal(found.segments, literal, ordered=True)
