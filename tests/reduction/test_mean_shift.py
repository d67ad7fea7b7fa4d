"""Mean shift: its pieces, its two climbs, its parents and its weaknesses."""

import inspect

import numpy as np
import pytest
from reduction_maps import MAPS, redundant_map
from segmap_course.literal.reduction.mean_shift import cut

from segmap.poses import transform
from segmap.reduction import common_directions, mean_shift
from segmap.reduction._mean_shift import pieces_of
from segmap.reduction._mean_shift_kernels import climb, link
from segmap.segments import length
from segmap.testing import assert_segments_equal

#: Two points of one group.
ALIKE = np.zeros(2, int)


@pytest.mark.parametrize("turn", [np.pi / 2, 0.3, 2.0])
@pytest.mark.parametrize("sigma", [0.2, 0.9])
def test_turning_a_building_of_right_angles_turns_the_result(turn, sigma):
    """Perpendicular walls, to which an axial difference gives a sign by rounding."""
    room = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]])
    found = mean_shift(transform((0, 0, turn), room), sigma=sigma)
    moved = transform((0, 0, turn), mean_shift(room, sigma=sigma).segments)
    assert_segments_equal(found.segments, moved, atol=1e-8)


@pytest.mark.parametrize("make", MAPS)
def test_the_order_of_the_input_changes_nothing(make):
    """Centres that move in turn among centres, not among pieces, would make order matter."""
    rng = np.random.default_rng(8)
    segments = make(rng, 18) / 2
    order = rng.permutation(len(segments))
    found, expected = mean_shift(segments[order]), mean_shift(segments)
    assert_segments_equal(found.segments, expected.segments)


@pytest.mark.parametrize(
    ("wall", "pieces"), [(0.1, 1), (0.2, 1), (0.2 + 1e-8, 2), (3 * 0.2, 3), (0.61, 4), (1.4, 7)]
)
def test_pieces_are_as_few_as_are_no_longer_than_sigma(wall, pieces):
    """3 * 0.2 / 0.2 is above 3 in floating point and makes four; 1.4 / 0.2 is below 7."""
    found, owner = pieces_of(np.array([[(1.0, 0.0), (1.0, wall)]]), 0.2)
    assert owner.tolist() == [0] * pieces
    np.testing.assert_allclose(length(found), wall / pieces, atol=1e-15)
    np.testing.assert_allclose(found[1:, 0], found[:-1, 1], atol=1e-15)


def test_points_at_three_deviations_pull_and_those_beyond_do_not():
    """Equal pieces of one wall lie at whole multiples of sigma: rounding must not choose."""
    for gap, share in ((3.0 + 1e-12, np.exp(-4.5) / (1 + np.exp(-4.5))), (3.0 + 1e-6, 0.0)):
        points = np.array([[0.0, 0.0, 0.0], [0.0, gap, 0.0]])
        centres, _ = climb(points, ALIKE, np.inf, 10.0)
        assert centres[0, 1] == pytest.approx(gap * share, abs=1e-12)


def test_a_perpendicular_point_attracts_but_does_not_turn():
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 1.0]])
    centres, _ = climb(points, ALIKE, 2.0, 10.0)
    assert centres[0, 0] > 0.1
    assert centres[:, 2].tolist() == [0.0, 1.0]
    assert climb(points, ALIKE, 2.0, 10.0, 0.0)[1] == 0


@pytest.mark.parametrize("angles", [(0.05, 1.95), (1.95, 0.05)])
def test_directions_at_both_ends_of_half_a_turn_make_a_chain(angles):
    points = np.column_stack([(0.0, 0.1), (0.0, 0.0), angles])
    assert link(points, ALIKE, 2.0, 0.5).tolist() == [0, 0]
    assert link(points, ALIKE, 9.0, 0.5).tolist() == [0, 1]


def test_all_climb_until_the_slowest_rests():
    """A stop of each centre by itself, or a freeze below the stop: the others go on a little."""
    crowd = np.abs(np.random.default_rng(0).normal(0, 1.5, (60, 3)))
    slow = np.array([[900.0, 0.0, 0.0], [902.0, 0.0, 0.0]])
    alone, steps = climb(crowd, np.zeros(60, int), 100.0, 1 / 200)
    both, more = climb(np.concatenate([crowd, slow]), np.zeros(62, int), 100.0, 1 / 200)
    assert more > steps
    assert 1e-6 < np.abs(both[:60] - alone).max() < 0.05


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
    map = redundant_map(np.random.default_rng(4), 20) / 3
    whole = common_directions(map)
    begin, one = (common_directions(map, steps=k).centres for k in (0, 1))
    literal = cut(map.tolist(), 0.2)
    np.testing.assert_allclose(begin[:, :2], [piece.place[:2] for piece in literal], atol=1e-12)
    assert 0 < np.abs(one - begin)[:, :2].max() < 0.2
    assert np.abs(whole.centres - one)[:, :2].max() > 0.01
    assert len(whole.theta) == whole.cluster.max() + 1
    np.testing.assert_array_equal(whole.owner, [piece.owner for piece in literal])
    ways = [inspect.signature(way).parameters for way in (common_directions, mean_shift)]
    for name in ("sigma", "bandwidth"):
        assert ways[0][name].default == ways[1][name].default


@pytest.mark.parametrize(
    ("scales", "message"),
    [
        ({"sigma": 1e-7}, "sigma must cut the map into at most 20000000 pieces"),
        ({"bandwidth": 1e-9}, "bandwidth must be at least 1e-9 rad a sigma"),
    ],
)
@pytest.mark.parametrize("way", [mean_shift, common_directions])
def test_scales_that_rounding_would_decide_are_refused(scales, message, way):
    """Moves below rounding never come to rest: an endless loop."""
    with pytest.raises(ValueError, match=message):
        way(np.array([[(0, 0), (9, 0)]]), **scales)


def test_a_sigma_that_vanishes_beside_the_extent_is_refused():
    """Moves below rounding again, between two short walls that are far apart."""
    with pytest.raises(ValueError, match="sigma must be at least 1e-10 of the extent"):
        mean_shift(np.array([[(0, 0), (0.01, 0)], [(1e5, 0), (1e5, 0.01)]]), sigma=1e-6)


def test_a_map_in_which_nothing_repeats_is_told():
    """Catches 600 pieces of 100 walls that nobody has seen twice, returned as their reduction."""
    rng = np.random.default_rng(1)
    middle, turn = rng.uniform(0, 5, (100, 2)), rng.uniform(0, np.pi, 100)
    half = 1.5 * np.stack([np.cos(turn), np.sin(turn)], 1)
    with pytest.warns(UserWarning, match=r"makes \d+ segments of 100: nothing repeats in this map"):
        found = mean_shift(np.stack([middle - half, middle + half], 1))
    assert len(found) > 200
