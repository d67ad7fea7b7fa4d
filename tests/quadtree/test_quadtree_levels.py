"""Mean and variance of the occupancy from level to level of the tree."""

import numpy as np
import pytest
from quadtrees import literal_of, random_map
from segmap_course import literal

VALUES = ("mean", "variance")


@pytest.mark.parametrize("seed", [0, 2])
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
