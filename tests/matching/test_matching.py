"""Scores of a scan on a map against their literal forms."""

import numpy as np
import pytest
from quadtrees import literal_of, random_map
from segmap_course import literal

from segmap.matching import (
    descent_score,
    distance_score,
    field_score,
    nearest_score,
    occupancy_score,
)
from segmap.quadtree import QuadtreeMap

SCORES = (occupancy_score, distance_score, nearest_score, descent_score, field_score)
SEEDS = range(4)


def asked(map, rng, *, spread=30, beams=17):
    """A scan and three poses, mostly on the map."""
    poses = np.column_stack([rng.normal(0, 10 * map.resolution, (3, 2)), rng.uniform(-3, 3, 3)])
    return rng.normal(0, spread * map.resolution, (beams, 2)), poses


@pytest.mark.parametrize("seed", SEEDS)
def test_occupancy_score_is_the_literal_sum(seed):
    """Catches unknown cells counted as half occupied, and cells at or below 0.5 that count."""
    map, rng = random_map(seed)
    tree = literal_of(map)
    points, poses = asked(map, rng, beams=200)
    points[:50] = rng.choice(tree.occupied(), 50)
    poses[0] = 0.0
    found = occupancy_score(map, points, poses)
    shares = {square[:2]: literal.occupancy(*counts) for square, counts in tree.leaves.items()}
    occupied = {cell: share for cell, share in shares.items() if share > 0.5}
    at = poses - (*map.corner, 0)
    expected = [literal.occupancy_score(occupied, points, pose, map.resolution) for pose in at]
    np.testing.assert_allclose(found, expected)
    assert found[0] > 20


@pytest.mark.parametrize("free_resolution", [None, 1, 4])
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("score", [distance_score, nearest_score])
def test_distance_is_that_of_every_cell(seed, free_resolution, score):
    """Catches distances to corners, a search that stops early, and cells emptied again."""
    map, rng = random_map(seed, free_resolution=free_resolution)
    centres = literal_of(map).occupied()
    for spread in (3, 30, 300):
        points, poses = asked(map, rng, spread=spread)
        expected = [literal.distance_score(points, pose, centres) for pose in poses]
        np.testing.assert_allclose(score(map, points, poses), expected, rtol=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_plain_search_finds_what_the_nearest_score_finds(seed):
    """Catches a square that is left out, and an end outside the root."""
    map, rng = random_map(seed)
    tree, side = literal_of(map), map.resolution
    cells = (np.array(tree.occupied()) - map.corner) / side - 0.5
    squares = literal.squares_above(np.rint(cells).astype(int).tolist(), tree.root)
    for end in rng.normal(0, 40 * side, (60, 2)):
        away, opened = literal.nearest_cell(squares, tree.root, (end - map.corner) / side)
        assert away * side == pytest.approx(-nearest_score(map, [end], (0, 0, 0))[0])
        assert {*opened} <= squares


@pytest.mark.parametrize("seed", SEEDS[:4])
def test_descent_is_the_literal_one(seed):
    """Catches a child ranked by its corner, and one that holds nothing."""
    map, rng = random_map(seed)
    points, poses = asked(map, rng, beams=9)
    poses[0] = (*map.corner, 0.0)  # some ends in the middle between two squares
    points[:5] = np.rint(points[:5] / map.resolution) * map.resolution
    expected = [literal.descent_score(literal_of(map), points, pose) for pose in poses]
    np.testing.assert_allclose(descent_score(map, points, poses), expected, rtol=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("wide", [0.0, 0.02, 0.3, 30.0])
def test_nearest_of_many_poses_is_that_of_each(seed, wide):
    """Alike and not, on edges, far outside. Catches what is nearest to one pose only left out."""
    map, rng = random_map(seed)
    points = rng.normal(0, 2, (40, 2))
    for count in (2, 17, 50):
        poses = rng.normal(0, wide, (count, 3)) + (*rng.uniform(*np.reshape(map.bounds, (2, 2))), 1)
        poses[::5, :2] = np.round(poses[::5, :2] / map.resolution) * map.resolution
        poses[1] += (rng.choice([0, 1e6, -1e200]), 0, 0)
        each = [nearest_score(map, points, pose)[0] for pose in poses]
        assert nearest_score(map, points, poses).tolist() == each
        np.testing.assert_allclose(each, distance_score(map, points, poses), rtol=1e-9)


def test_descent_misses_the_nearest_cell():
    """Two quarters: the nearer centre belongs to the one whose only cell lies far away."""
    map = QuadtreeMap(resolution=1.0, size=8.0)
    for cell in [(4.5, 0.5), (0.5, 3.5)]:
        map.insert_scan(cell, [cell])
    assert nearest_score(map, [(3.9, 0.5)], (0, 0, 0))[0] == pytest.approx(-0.6)
    assert descent_score(map, [(3.9, 0.5)], (0, 0, 0))[0] == pytest.approx(-np.hypot(3.4, 3.0))


@pytest.mark.parametrize("score", SCORES)
def test_there_is_a_score_for_each_pose(score):
    """Of one, of none, and of no beams."""
    map, rng = random_map(3)
    points, poses = asked(map, rng)
    assert score(map, points, poses[0]).shape == (1,)
    assert score(map, points, np.empty((0, 3))).shape == (0,)
    assert score(map, [], [(0, 0, 0), (1, 0, 0)]).tolist() == [0, 0]


@pytest.mark.parametrize("score", SCORES)
def test_a_score_is_that_of_the_map_now(score):
    """Catches what is kept from an earlier state: of a map asked before, and of its copies."""
    map, rng = random_map(9)
    points, poses = asked(map, rng)
    score(map, points, poses)
    map.insert_scan((0, 0), points)
    again, _ = random_map(9)
    again.insert_scan((0, 0), points)
    np.testing.assert_array_equal(score(map, points, poses), score(again, points, poses))


@pytest.mark.parametrize("score", SCORES)
def test_an_empty_map_has_no_score(score):
    """B scores an empty map +1 a beam; so would a map whose ends have all been crossed again."""
    empty, crossed = QuadtreeMap(), QuadtreeMap(resolution=0.1)
    crossed.insert_scan((0.05, 0.05), [(0.55, 0.05)])
    for _ in range(3):
        crossed.insert_scan((0.05, 0.05), [(1.55, 0.05)], [(5.05, 0.05)])
    for map in (empty, crossed):
        with pytest.raises(ValueError, match="no occupied cell"):
            score(map, [(1, 0)], (0, 0, 0))
