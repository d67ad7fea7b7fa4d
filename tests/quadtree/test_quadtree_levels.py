"""Mean and variance of the occupancy from level to level of the tree."""

import numpy as np
import pytest
from conftest import slow
from quadtrees import literal_of, random_map
from segmap_course import literal

from segmap.quadtree import QuadtreeMap

VALUES = ("mean", "variance")


def test_four_cells_by_hand():
    """One occupied cell of four, the others never crossed: (1 + 3 * 0.5) / 4, and its spread."""
    map = QuadtreeMap(resolution=1, size=4)
    map.insert_scan((0.5, 0.5), [(3.5, 0.5)])
    map.tree.vis[map.tree.occ == 0] = np.minimum(map.tree.vis[map.tree.occ == 0], 0)
    mean, variance = (map.to_grid(2, value=value) for value in VALUES)
    assert np.array_equal(mean, [[0.5, 0.625], [0.5, 0.5]])
    assert np.array_equal(variance, [[0, 3 / 64], [0, 0]])
    mean, variance = (map.to_grid(4, value=value) for value in VALUES)
    # the root: the variance within its quarters, and that of their means
    assert mean == 17 / 32 and variance == 3 / 256 + 3 / 1024


@pytest.mark.parametrize("seed", [*range(9), *map(slow, range(9, 24))])
def test_equals_the_literal_form_and_the_finest_grid(seed):
    """Catches leaves weighted by their number, spread within children lost, and four that are of
    two squares; and a variance of 1e-33 where all leaves are equal."""
    map, _ = random_map(seed, free_resolution=[None, 1, 2][seed % 3])
    finest, tree = map.to_grid(), literal_of(map)
    left, low, _ = tree.root
    for k in range(map.tree.level + 1):
        n, side = len(finest) >> k, 1 << k
        mean, variance = (map.to_grid(map.resolution * side, value=value) for value in VALUES)
        blocks = finest.reshape(n, side, n, side)
        assert mean == pytest.approx(blocks.mean((1, 3)), abs=1e-12)
        assert variance == pytest.approx(blocks.var((1, 3)), abs=1e-12)
        assert np.array_equal(variance == 0, blocks.max((1, 3)) == blocks.min((1, 3)))
        for (i, j), value in list(np.ndenumerate(mean))[:: max(1, mean.size // 20)]:
            square = (left + j * side, low + i * side, side)
            while square not in tree.leaves and tree.leaf(square[:2])[2] > side:
                square = tree.leaf(square[:2])
            expected = literal.mean_and_variance(tree, square)
            assert (value, variance[i, j]) == pytest.approx(expected, abs=1e-12)


def test_the_mean_is_the_same_at_every_level():
    """Catches a mean of leaves in place of areas; the largest value does grow with the cells."""
    map, _ = random_map(3)
    sides = map.resolution * 2.0 ** np.arange(map.tree.level + 1)
    means = [map.to_grid(side, value="mean").mean() for side in sides]
    spreads = [map.to_grid(side, value="variance").mean() for side in sides]
    assert means == pytest.approx([means[0]] * len(means), abs=1e-12)
    assert spreads[0] == 0 and (np.diff(spreads) > 0).all()
    assert map.to_grid(sides[4]).mean() > means[4] + 0.03
