"""Mean shift against its literal form, its symmetries, and its weaknesses."""

import numpy as np
import pytest
import reference_mean_shift
from conftest import shared_file
from hypothesis import given, settings
from hypothesis import strategies as st

from segmap import load, metrics, read
from segmap.extraction import build_map
from segmap.poses import transform
from segmap.reduction import _climb_loops as climbing
from segmap.reduction import common_directions, mean_shift
from segmap.reduction._mean_shift import pieces_of
from segmap.segments import SegmentMap, length
from segmap.testing import assert_segments_equal, segment_zoo

BANDWIDTH = np.pi / 18 / 0.20


def random_map(rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(-0.7, 0.7, (18, 2, 2))


def redundant_map(rng: np.random.Generator) -> np.ndarray:
    """Pieces of four walls, each seen some times with noise."""
    walls = rng.uniform(-1, 1, (4, 2, 2))
    part = rng.uniform(0, 1, (20, 2))[..., None]
    wall = walls[rng.integers(0, 4, 20)]
    return wall[:, :1] + part * (wall[:, 1:] - wall[:, :1]) + rng.normal(0, 0.02, (20, 2, 2))


def lattice_map(rng: np.random.Generator) -> np.ndarray:
    """Ties, duplicates, crossings, perpendicular walls, segments without length."""
    return np.repeat(rng.integers(-3, 4, (9, 2, 2)) * 0.15, 2, axis=0)


def corridor_map(rng: np.random.Generator) -> np.ndarray:
    """Many segments along one line, turned so that no angle is near 0."""
    return transform((0, 0, 1.0), rng.normal(0, 1, (14, 2, 2)) * (0.7, 0.02))


MAPS = [random_map, redundant_map, lattice_map, corridor_map]


def assert_same(found, segments, sigma, bandwidth):
    expected, parents = reference_mean_shift.mean_shift(segments.tolist(), sigma, bandwidth)
    np.testing.assert_array_equal(found.parents, parents)
    assert_segments_equal(found.segments, np.reshape(expected, (-1, 2, 2)), ordered=True)


@pytest.mark.parametrize("make", MAPS)
@pytest.mark.parametrize(
    "scales", [(0.2, BANDWIDTH), (0.5, BANDWIDTH), (0.35, 0.1), (0.4, 2.0), (0.9, 1.5)]
)
@pytest.mark.parametrize("seed", range(3))
def test_equals_the_literal_method(make, scales, seed):
    """A piece that the strips miss, an angle not wrapped, another kernel, chain, union or order."""
    segments = make(np.random.default_rng(seed))
    sigma, bandwidth = scales
    assert_same(mean_shift(segments, sigma=sigma, bandwidth=bandwidth), segments, *scales)


def malaga() -> SegmentMap:
    log = load("malaga")
    return build_map(log, log.truth)


@pytest.mark.parametrize("turn", [0.0, 0.8])
@pytest.mark.parametrize("sigma", [0.3, 0.5])
def test_equals_the_literal_method_on_a_real_map(turn, sigma):
    """Lengths and angles of a building: walls of many pieces, next to specks."""
    segments = transform((0, 0, turn), malaga().segments[:45])
    assert_same(mean_shift(segments, sigma=sigma), segments, sigma, BANDWIDTH)


def test_equals_the_literal_method_on_a_second_building():
    """A denser map: each wall seen from everywhere."""
    log = read(shared_file("data/intel.log.gz"))[:4]
    segments = build_map(log, log.truth).segments[:40]
    assert_same(mean_shift(segments, sigma=0.3), segments, 0.3, BANDWIDTH)


@pytest.mark.parametrize("name", segment_zoo())
def test_zoo(name):
    """Empty, single, points, duplicates, crossings, far from the origin."""
    segments = segment_zoo()[name]
    sigma = max(0.3, length(segments).sum() / 120)
    assert_same(mean_shift(segments, sigma=sigma), segments, sigma, BANDWIDTH)


@pytest.mark.parametrize("pose", [(0, 0, np.pi / 2), (0, 0, 1.234), (-70, 40, 0), (3, -8, -2.9)])
@pytest.mark.parametrize("make", [random_map, redundant_map, corridor_map])
def test_moving_the_map_moves_the_result(make, pose):
    """The sign of eq. 4.15 leans the kernel the wrong way for all but walls along an axis."""
    segments = make(np.random.default_rng(5))
    found, expected = mean_shift(transform(pose, segments)), mean_shift(segments)
    np.testing.assert_array_equal(found.parents, expected.parents)
    moved = transform(pose, expected.segments)
    assert_segments_equal(found.segments, moved, ordered=True, atol=1e-8)


@pytest.mark.parametrize("turn", [np.pi / 2, 0.3, 2.0])
@pytest.mark.parametrize("sigma", [0.2, 0.9])
def test_turning_a_building_of_right_angles_turns_the_result(turn, sigma):
    """Perpendicular walls, to which an axial difference gives a sign by rounding."""
    room = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]])
    found = mean_shift(transform((0, 0, turn), room), sigma=sigma)
    moved = transform((0, 0, turn), mean_shift(room, sigma=sigma).segments)
    assert_segments_equal(found.segments, moved, atol=1e-8)


@pytest.mark.parametrize("scale", [0.01, 1000.0])
def test_scaling_every_length_scales_the_result(scale):
    """An absolute length hidden in the loops. The bandwidth is an angle a metre: it divides."""
    segments = redundant_map(np.random.default_rng(6))
    found = mean_shift(scale * segments, sigma=scale * 0.2, bandwidth=BANDWIDTH / scale)
    expected = mean_shift(segments)
    np.testing.assert_array_equal(found.parents, expected.parents)
    assert_segments_equal(found.segments, scale * expected.segments, atol=1e-9 * scale)


def test_scaling_without_the_bandwidth_does_not():
    """The counter-example: a thousandth of the bandwidth keeps angles apart that were alike."""
    segments = redundant_map(np.random.default_rng(6))
    assert len(mean_shift(segments / 1000, sigma=0.2 / 1000)) != len(mean_shift(segments))


@pytest.mark.parametrize("make", MAPS)
def test_swapping_end_points_changes_nothing(make):
    """A segment has no direction. Only outputs of one input, which follow it, change places."""
    segments = make(np.random.default_rng(7))
    assert_segments_equal(mean_shift(segments[:, ::-1]).segments, mean_shift(segments).segments)


@pytest.mark.parametrize("make", MAPS)
def test_the_order_of_the_input_changes_nothing(make):
    """Centres that move in turn among centres, not among pieces, would make order matter."""
    rng = np.random.default_rng(8)
    segments = make(rng)
    order = rng.permutation(len(segments))
    found, expected = mean_shift(segments[order]), mean_shift(segments)
    assert_segments_equal(found.segments, expected.segments)


@pytest.mark.parametrize("turn", [0.0, np.pi / 2, 0.7])
def test_walls_at_1_and_179_degrees_merge(turn):
    """Plain differences and means of angles keep them apart, or make a wall across."""
    wall = np.array([[(0, 0.01), (2, -0.01)], [(0, -0.01), (2, 0.01)]])
    found = mean_shift(transform((0, 0, turn), wall))
    assert len(found) == 1
    back = transform((0, 0, -turn), found.segments)
    np.testing.assert_allclose(back[0, :, 1], 0.0, atol=1e-9)
    assert length(found.segments) == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize(
    ("wall", "pieces"), [(0.1, 1), (0.2, 1), (0.2 + 1e-8, 2), (3 * 0.2, 3), (0.61, 4), (1.4, 7)]
)
def test_pieces_are_as_few_as_are_no_longer_than_sigma(wall, pieces):
    """3 * 0.2 / 0.2 is above 3 in floating point and makes four; 1.4 / 0.2 is below 7."""
    found, owner = pieces_of(np.array([[(1.0, 0.0), (1.0, wall)]]), 0.2)
    assert owner.tolist() == [0] * pieces
    np.testing.assert_allclose(length(found), wall / pieces, atol=1e-15)
    np.testing.assert_allclose(found[1:, 0], found[:-1, 1], atol=1e-15)


def test_two_points_attract_as_their_kernel_says():
    """The closed form: at distance h, the weights are 1 and exp(-h^2 / 2)."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    centres, steps = climbing.climb(points, np.inf, 10.0, np.inf)
    share = np.exp(-0.5) / (1 + np.exp(-0.5))
    assert steps == 1
    np.testing.assert_allclose(centres, [(share, 0, 0), (1 - share, 0, 0)], atol=1e-12)


def test_points_at_three_deviations_pull_and_those_beyond_do_not():
    """Equal pieces of one wall lie at whole multiples of sigma: rounding must not choose."""
    for gap, share in ((3.0 + 1e-12, np.exp(-4.5) / (1 + np.exp(-4.5))), (3.0 + 1e-6, 0.0)):
        points = np.array([[0.0, 0.0, 0.0], [0.0, gap, 0.0]])
        centres, _ = climbing.climb(points, np.inf, 10.0, np.inf)
        assert centres[0, 1] == pytest.approx(gap * share, abs=1e-12)


def test_a_perpendicular_point_attracts_but_does_not_turn():
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 1.0]])
    centres, _ = climbing.climb(points, 2.0, 10.0, np.inf)
    assert centres[0, 0] > 0.1
    assert centres[:, 2].tolist() == [0.0, 1.0]


def test_all_climb_until_the_slowest_rests():
    """A stop of each centre by itself, or a freeze below the stop: the others go on a little."""
    crowd = np.abs(np.random.default_rng(0).normal(0, 1.5, (60, 3)))
    slow = np.array([[900.0, 0.0, 0.0], [902.0, 0.0, 0.0]])
    alone, steps = climbing.climb(crowd, 100.0, 1 / 200, np.inf)
    both, more = climbing.climb(np.concatenate([crowd, slow]), 100.0, 1 / 200, np.inf)
    assert more > steps
    assert 1e-6 < np.abs(both[:60] - alone).max() < 0.05


@given(st.integers(0, 10_000))
@settings(max_examples=40)
def test_contract(seed):
    """Lost or invented wall: parents that point nowhere, outputs without any input beside them."""
    segments = MAPS[seed % 4](np.random.default_rng(seed))
    found = mean_shift(segments)
    kept = length(segments) >= 1e-9
    np.testing.assert_array_equal(found.parents >= 0, kept)
    assert found.parents.max(initial=-1) < len(found)
    assert length(found.segments).sum() <= length(segments).sum() + 1e-9
    assert np.isfinite(found.segments).all()


def test_parents_name_the_longest_share():
    """The first or the last piece decides: a wall that a short bundle cuts at one end."""
    wall = [[(0, 0), (4, 0)]]
    bundle = [[(3.2, y), (4.0, y)] for y in np.linspace(-0.02, 0.02, 6)]
    found = mean_shift(np.array(bundle + wall))
    shares = length(found.segments)
    assert len(found) > 1
    assert found.parents[-1] == np.argmax(shares)
    assert set(found.parents[:-1]) == {0}


def test_the_first_phase_can_be_watched():
    """A count of steps off by one: 0 are the pieces, 1 is one step, and so on to the end."""
    map = redundant_map(np.random.default_rng(4))
    whole = common_directions(map)
    begin, one = (common_directions(map, steps=k).centres for k in (0, 1))
    literal = reference_mean_shift.cut(map.tolist(), 0.2)
    np.testing.assert_allclose(begin[:, :2], [piece[:2] for piece in literal], atol=1e-12)
    assert 0 < np.abs(one - begin)[:, :2].max() < 0.2
    assert np.abs(whole.centres - one)[:, :2].max() > 0.01
    assert len(whole.theta) == whole.cluster.max() + 1
    np.testing.assert_array_equal(whole.owner, [piece[3] for piece in literal])


def test_a_map_without_redundancy_is_kept():
    square = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]])
    found = mean_shift(square)
    assert_segments_equal(found.segments, square)
    assert metrics.quality(square, found) == pytest.approx(1.0, abs=1e-12)


def test_weakness_more_segments_than_it_got():
    """The counter-example: pieces climb to where the wall was seen twice, and leave gaps behind.

    Both inputs have most of their length in the middle: the outer outputs are no one's parent.
    """
    wall_and_part = np.array([[(0, 0), (4, 0)], [(1.5, 0.01), (2.5, 0.01)]])
    found = mean_shift(wall_and_part)
    assert len(found) == 3
    assert found.parents.tolist() == [1, 1]
    np.testing.assert_allclose(found.segments[:, :, 0], [(0, 1), (1, 3), (3, 4)], atol=1e-9)


def test_weakness_quality_collapses_as_sigma_grows():
    """Walls shorter than sigma stay whole, and are turned to one direction (A 6.3)."""
    map = malaga()
    found = [metrics.quality(map, mean_shift(map, sigma=s)) for s in (0.2, 0.4, 1.0)]
    assert found[0] > 0.7 > 0.5 > found[1] > 0.2 > found[2]


def test_not_idempotent():
    """The counter-example: what has become one wall is cut anew, and merges with its neighbour."""
    once = mean_shift(redundant_map(np.random.default_rng(6)))
    assert [len(once), len(mean_shift(once))] == [5, 4]


@pytest.mark.parametrize(
    ("scales", "message"),
    [
        ({"sigma": 1e-7}, "sigma must cut the map into at most 20000000 pieces"),
        ({"sigma": 1e-12, "bandwidth": 1e6}, "sigma must be at least 1e-10 of the extent"),
        ({"bandwidth": 1e-9}, "bandwidth must be at least 1e-9 rad a sigma"),
    ],
)
def test_scales_that_rounding_would_decide_are_refused(scales, message):
    """Moves below rounding never come to rest: an endless loop."""
    with pytest.raises(ValueError, match=message):
        mean_shift(np.array([[(0, 0), (9, 0)]]), **scales)


def test_empty_and_points():
    """Segments without length have no angle: left out, parents -1."""
    assert mean_shift(np.empty((0, 2, 2))).segments.shape == (0, 2, 2)
    found = mean_shift(np.zeros((3, 2, 2)))
    assert found.segments.shape == (0, 2, 2)
    assert found.parents.tolist() == [-1, -1, -1]
