"""The distance field: exact on cells, and within half a diagonal of one elsewhere."""

import numpy as np
import pytest
from quadtrees import literal_of, random_map
from scipy.ndimage import distance_transform_edt

from segmap.matching import DistanceField
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap
from segmap.segments import SegmentMap, point_distance


@pytest.mark.parametrize("seed", range(4))
def test_the_field_is_the_exact_transform(seed):
    """Catches an approximate transform, a transposed window, and one that is off by a cell."""
    map, _ = random_map(seed)
    field = DistanceField(map)
    taken = np.ones(field.cells.shape, bool)
    left, low, *_ = field.bounds
    for x, y in (np.array(literal_of(map).occupied()) - (left, low)) / map.resolution:
        taken[int(y), int(x)] = False
    expected = map.resolution * distance_transform_edt(taken)
    rounding = 0.501 * map.resolution / field.unit
    np.testing.assert_allclose(field.distance, expected, rtol=0, atol=rounding)


@pytest.mark.parametrize("shape", [(1, 40), (40, 1), (7, 90), (90, 7)])
def test_the_transform_of_any_shape(shape):
    """Rows and columns without any occupied cell, and a single one: the envelope's edges."""
    map = QuadtreeMap(resolution=1.0, size=128.0)
    rng = np.random.default_rng(shape)
    window = (10, 10, 10 + shape[1], 10 + shape[0])
    taken = np.ones(shape, bool)
    for i, j in rng.integers(0, shape, (3, 2)):
        map.insert_scan((j + 10.5, i + 10.5), [(j + 10.5, i + 10.5)])
        taken[i, j] = False
    field = DistanceField(map, window)
    assert field.bounds == window
    np.testing.assert_allclose(field.distance, distance_transform_edt(taken), atol=1e-5)


@pytest.mark.parametrize("seed", range(4))
def test_a_score_is_minus_the_sum_of_what_the_field_says(seed):
    """At each pose, for all its ends; those beyond the window count as on its edge."""
    map, rng = random_map(seed)
    side, first, end = map.resolution, *np.reshape(map.bounds, (2, 2))
    field = DistanceField(map, [*(first + 0.1 * (end - first)), *(end - 0.2 * (end - first))])
    points = rng.normal(0, 30 * side, (25, 2))
    poses = np.column_stack([rng.uniform(first, end, (9, 2)), rng.uniform(-3, 3, 9)])
    rows, columns = field.cells.shape
    cells = (transform(poses, points) - field.bounds[:2]) / side
    i, j = np.moveaxis(np.clip(np.floor(cells), 0, (columns - 1, rows - 1)).astype(int), -1, 0)
    np.testing.assert_allclose(field.score(points, poses), -field.distance[j, i].sum(1), rtol=1e-6)


def test_a_window_cuts():
    """What lies outside is not seen: the score is lower. A point beyond counts as on the edge.

    So does a NaN, which `scorer` does not look for; and what is inserted later is not there.
    """
    map = QuadtreeMap(resolution=0.1)
    for cell in [(0.05, 0.05), (3.05, 0.05)]:
        map.insert_scan(cell, [cell])
    field = DistanceField(map, (0, 0, 2, 1))
    map.insert_scan((1, 0.05), [(1.95, 0.05)])
    assert field.bounds == pytest.approx((0, 0, 2, 1))
    found = field.score([(1.95, 0.05), (3.05, 0.05), (1e300, 0.05)], (0, 0, 0))[0]
    assert found == pytest.approx(-3 * 1.9)
    values = field.scorer([(0.05, 0.05)])(np.array([(np.nan, 0, 0), (0, 0, np.nan)]))
    assert np.isfinite(values).all()


def test_the_field_around_a_scan_holds_the_robot_too():
    """A wall beside the robot counts though all beams look away."""
    map = QuadtreeMap(resolution=0.1)
    map.insert_scan((0.05, 0.05), [(0.05, 0.45)])
    field = DistanceField.around(map, [(6.0, 0.0)], [(0, 0, 0), (0, -3, 0)])
    assert field.bounds == pytest.approx((-0.5, -3.5, 6.5, 0.5))


@pytest.mark.parametrize("seed", range(4))
def test_the_field_of_walls_is_the_distance_to_the_nearest(seed):
    """Catches a wall that is dropped too early, a centre taken for a corner, and a window that is
    transposed; walls outside the window count, one without length too."""
    rng = np.random.default_rng(seed)
    walls = rng.uniform(-3, 3, (rng.integers(1, 14), 2, 2))
    walls[0, 1] = walls[0, 0]
    window = (*rng.uniform(-4, 0, 2), *rng.uniform(0.1, 4, 2))
    side = float(rng.choice([0.05, 0.13, 0.7]))
    field = DistanceField(SegmentMap(walls), window, resolution=side)
    left, low, right, high = field.bounds
    rows, columns = field.cells.shape
    x, y = (low_ + side * (np.arange(n) + 0.5) for low_, n in ((left, columns), (low, rows)))
    centres = np.stack(np.meshgrid(x, y), -1)
    expected = point_distance(centres[:, :, None], walls).min(-1)
    np.testing.assert_allclose(field.distance, expected, atol=1e-6 * side * (rows + columns))
    assert left <= window[0] < left + side and high - side < window[3] <= high
    places = rng.uniform((left, low), (right, high), (50, 2))
    exact = point_distance(places[:, None], walls).min(-1)
    found = field.score([(0, 0)], np.column_stack([places, np.zeros(50)]))
    assert np.abs(found + exact).max() <= side / np.sqrt(2) + 1e-6


def test_windows_of_walls():
    """By default all walls and half a metre; a narrow window far from a wall overflows nothing."""
    map = SegmentMap([[(0, 0), (4, 0)], [(4, 0), (4, 3)]])
    assert DistanceField(map).bounds == pytest.approx((-0.5, -0.5, 4.5, 3.5))
    around = DistanceField.around(map, [(1.0, 0.0)], (0, 0, 0), resolution=0.1)
    assert around.bounds == pytest.approx((-0.5, -0.5, 1.5, 0.5)) and "0.1 m" in repr(around)
    thin = DistanceField(map, (-40, 20, 40, 20.05))
    assert thin.distance.max() == pytest.approx(np.hypot(39.975, 20.025))
