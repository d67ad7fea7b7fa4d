"""Fusion against its literal reference, its symmetries, and its weaknesses."""

import numpy as np
import pytest
import reference
from hypothesis import given
from hypothesis import strategies as st

from segmap import load, metrics
from segmap.extraction import build_map
from segmap.poses import transform
from segmap.reduction import fusion
from segmap.segments import length

TOLERANCE = 0.04


def random_map(rng: np.random.Generator, n: int = 40) -> np.ndarray:
    return rng.uniform(0, 1, (n, 2, 2))


def redundant_map(rng: np.random.Generator, n: int = 60) -> np.ndarray:
    """Pieces of five walls, each seen a dozen times with noise."""
    walls = rng.uniform(0, 6, (5, 2, 2))
    part = np.sort(rng.uniform(0, 1, (n, 2)), axis=1)[..., None]
    wall = walls[rng.integers(0, len(walls), n)]
    ends = wall[:, :1] + part * (wall[:, 1:] - wall[:, :1])
    return ends + rng.normal(0, 0.015, (n, 2, 2))


def lattice_map(rng: np.random.Generator, n: int = 40) -> np.ndarray:
    """Everything ties: end points on a grid, each segment twice, some without length."""
    return np.repeat(rng.integers(0, 5, (n // 2, 2, 2)) * 0.3, 2, axis=0)


def corridor_map(rng: np.random.Generator, n: int = 60) -> np.ndarray:
    """Many segments along one line: long chains and many shifts."""
    return rng.normal(0, 1, (n, 2, 2)) * (2.0, 0.03)


MAPS = [random_map, redundant_map, lattice_map, corridor_map]


@pytest.mark.parametrize("make", MAPS)
@pytest.mark.parametrize("tolerance", [0.013, 0.04, 0.1, 2.0])
@pytest.mark.parametrize("seed", range(4))
def test_equals_the_literal_method(make, tolerance, seed):
    """A wrong tie, chain, shift or neighbourhood gives other segments than the literal method."""
    segments = make(np.random.default_rng(seed))
    expected, parents, _ = reference.fusion(segments.tolist(), tolerance)
    found = fusion(segments, tolerance=tolerance)
    np.testing.assert_array_equal(found.parents, parents)
    np.testing.assert_allclose(found.segments, expected, atol=1e-9)


@pytest.mark.parametrize("turn", [0.0, 0.4, np.pi / 2])
def test_equals_the_literal_method_on_a_real_map(turn):
    """Long walls that cross many cells, and pieces of them that ended within rounding."""
    log = load("malaga")
    segments = transform((0, 0, turn), build_map(log, log.truth).segments[:400])
    expected, parents, _ = reference.fusion(segments.tolist(), TOLERANCE)
    found = fusion(segments, tolerance=TOLERANCE)
    np.testing.assert_array_equal(found.parents, parents)
    np.testing.assert_allclose(found.segments, expected, atol=1e-9)


@pytest.mark.parametrize("seed", range(20))
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


def assert_moved(found, expected, moved):
    np.testing.assert_array_equal(found.parents, expected.parents)
    np.testing.assert_allclose(
        np.sort(found.segments, axis=1), np.sort(moved(expected.segments), axis=1), atol=1e-8
    )


@pytest.mark.parametrize("pose", [(0, 0, np.pi / 2), (0, 0, 1.234), (-70, 40, 0), (3, -8, -2.9)])
@pytest.mark.parametrize("make", [random_map, redundant_map])
def test_moving_the_map_moves_the_result(make, pose):
    """`y = mx + q`, a plain mean of angles or a grid that forgets negative cells would break it."""
    segments = make(np.random.default_rng(5))
    found, expected = fusion(transform(pose, segments)), fusion(segments)
    np.testing.assert_array_equal(found.parents, expected.parents)
    for a, b in zip(found.segments, transform(pose, expected.segments), strict=True):
        np.testing.assert_allclose(a[np.argsort(a @ (1, 2))], b[np.argsort(b @ (1, 2))], atol=1e-8)


@pytest.mark.parametrize("scale", [0.01, 1000.0])
def test_scaling_every_length_scales_the_result(scale):
    """An absolute length hidden in the loops (a cell, a gap) would break it."""
    segments = redundant_map(np.random.default_rng(6))
    found = fusion(scale * segments, tolerance=scale * TOLERANCE)
    assert_moved(found, fusion(segments, tolerance=TOLERANCE), lambda s: scale * s)


@pytest.mark.parametrize("make", MAPS)
def test_swapping_end_points_changes_nothing(make):
    """A segment has no direction."""
    segments = make(np.random.default_rng(7))
    assert_moved(fusion(segments[:, ::-1]), fusion(segments), lambda s: s)


@given(st.integers(0, 10_000))
def test_contract(seed):
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


def test_a_wall_at_0_degrees_merges_like_one_at_90():
    """Angles compared as plain numbers keep walls at 1 and 179 degrees apart."""
    wall = np.array([[(0, 0.01), (2, -0.01)], [(0.5, -0.01), (3, 0.01)]])
    assert len(fusion(wall)) == len(fusion(wall[..., ::-1])) == 1


def test_a_map_without_redundancy_is_kept():
    """Nothing may change where no two segments share a strip; quality is then 1."""
    square = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]])
    found = fusion(square)
    assert len(found) == 4
    assert metrics.quality(square, found) == pytest.approx(1.0, abs=1e-12)


def test_weakness_a_stub_across_the_wall_is_swallowed():
    """The counter-example of the chapter: there is no test of angles (A 6.3)."""
    wall_and_stub = np.array([[(0, 0), (4, 0)], [(2, -0.03), (2, 0.03)]])
    assert len(fusion(wall_and_stub, tolerance=0.04)) == 1
    assert len(fusion(wall_and_stub, tolerance=0.02)) == 2


def test_weakness_the_longest_decides_the_direction():
    """The result is parallel to the longest segment even where all others disagree (A 6.3)."""
    rows = [[(0, 0.0), (1.0, 0.05)]] + [[(0, y), (0.99, y)] for y in (0.01, 0.02, 0.03)]
    found = fusion(np.array(rows), tolerance=0.05)
    assert len(found) == 1
    rise = np.diff(found.segments[0], axis=0)[0]
    assert rise[1] / rise[0] == pytest.approx(0.05)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("turn", [0.0, np.pi])
def test_of_equal_chains_the_first_indices_win(side, turn):
    """A line that moves up or down by as much for as much: the order of the input decides."""
    rows = [[(0, 0), (3, 0)], [(1, 0.0625 * side), (2, 0.0625 * side)]]
    rows.append([(1, -0.0625 * side), (2, -0.0625 * side)])
    found = fusion(transform((0, 0, turn), rows), tolerance=0.05)
    assert found.parents.tolist() == [0, 0, 1]


def test_not_idempotent():
    """The counter-example: outputs of a first pass can chain with each other in a second."""
    segments = redundant_map(np.random.default_rng(3), 80)
    once = fusion(segments)
    assert len(fusion(once)) < len(once)


def test_segments_must_be_finite():
    with pytest.raises(ValueError, match="in metres, but map"):
        fusion(np.array([[(0, 0), (1, 0)], [(0, np.nan), (1, 0)]]))


def test_empty_and_points():
    """Segments without length have no angle: left out, parents -1."""
    assert len(fusion(np.empty((0, 2, 2)))) == 0
    found = fusion(np.zeros((3, 2, 2)))
    assert len(found) == 0
    assert found.parents.tolist() == [-1, -1, -1]
