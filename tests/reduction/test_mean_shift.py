"""Mean shift: its pieces, where its climbs stop, and what it refuses."""

import inspect

import numpy as np
import pytest
from reduction_maps import redundant_map
from segmap_course.literal.reduction.mean_shift import cut

from segmap.reduction import common_directions, mean_shift
from segmap.segments import length


@pytest.mark.parametrize(
    ("wall", "pieces"), [(0.1, 1), (0.2, 1), (0.2 + 1e-8, 2), (3 * 0.2, 3), (0.61, 4), (1.4, 7)]
)
def test_pieces_are_as_few_as_are_no_longer_than_sigma(wall, pieces):
    """3 * 0.2 / 0.2 is above 3 in floating point and makes four; 1.4 / 0.2 is below 7."""
    found = common_directions([[(1.0, 0.0), (1.0, wall)]], sigma=0.2, steps=0).pieces
    np.testing.assert_allclose(length(found), [wall / pieces] * pieces, atol=1e-15)
    np.testing.assert_allclose(found[1:, 0], found[:-1, 1], atol=1e-15)


def test_points_at_three_deviations_pull_and_those_beyond_do_not():
    """Equal pieces of one wall lie at whole multiples of sigma: rounding must not choose."""
    for gap, share in ((3.0 + 1e-12, np.exp(-4.5) / (1 + np.exp(-4.5))), (3.0 + 1e-6, 0.0)):
        walls = [[(0, 0), (1, 0)], [(0, gap), (1, gap)]]
        begin, one = (common_directions(walls, sigma=1, steps=k).centres for k in (0, 1))
        assert (one - begin)[0, 1] == pytest.approx(gap * share, abs=1e-12)


def test_all_climb_until_the_slowest_rests():
    """A stop of each centre by itself, or a freeze below the stop: the others go on a little."""
    places = np.random.default_rng(0).normal(0, 1.5, (60, 1, 2))
    crowd = places + [(-0.1, 0), (0.1, 0)]
    slow = crowd[:1] - places[:1] + np.reshape([(900, 0), (902, 0)], (2, 1, 2))
    alone, both = (
        common_directions(map, sigma=1).centres for map in (crowd, np.concatenate([crowd, slow]))
    )
    assert 1e-6 < np.abs(both[:60] - alone).max() < 0.05


def test_the_first_phase_can_be_watched():
    """A count of steps off by one: 0 are the pieces, 1 is one step, and so on to the end."""
    map = redundant_map(np.random.default_rng(4), 20) / 3
    whole = common_directions(map)
    begin, one = (common_directions(map, steps=k).centres for k in (0, 1))
    pieces, owner = cut(map, 0.2)
    np.testing.assert_allclose(begin[:, :2], pieces.mean(axis=1), atol=1e-12)
    assert 0 < np.abs(one - begin)[:, :2].max() < 0.2
    assert np.abs(whole.centres - one)[:, :2].max() > 0.01
    assert len(whole.theta) == whole.cluster.max() + 1
    np.testing.assert_array_equal(whole.owner, owner)
    ways = [inspect.signature(way).parameters for way in (common_directions, mean_shift)]
    for name in ("sigma", "bandwidth"):
        assert ways[0][name].default == ways[1][name].default


def test_a_map_in_which_nothing_repeats_is_told():
    """Catches 600 pieces of 100 walls that nobody has seen twice, returned as their reduction."""
    rng = np.random.default_rng(1)
    middle, turn = rng.uniform(0, 5, (100, 2)), rng.uniform(0, np.pi, 100)
    half = 1.5 * np.stack([np.cos(turn), np.sin(turn)], 1)
    with pytest.warns(UserWarning, match=r"makes \d+ segments of 100: nothing repeats in this map"):
        found = mean_shift(np.stack([middle - half, middle + half], 1))
    assert len(found) > 200
