"""Frontiers of the quadtree map, against a search on the finest grid; and squares that touch."""

import numpy as np
import pytest
from conftest import slow
from quadtrees import random_map
from scipy import ndimage

from segmap.quadtree import QuadtreeMap, frontiers


def borders_on_grid(map):
    """Borders of single cells between free and unknown ones: their two ends, in cells.

    Cells that only the mask hides are neither.
    """
    value, leaves = map.to_grid(), map.leaves()
    single = map.rasterize(leaves.side)[0] == map.resolution
    beside = ndimage.binary_dilation(map.rasterize(leaves.occ)[0] > 0, np.ones((3, 3)))
    value = np.where(single & beside & (value == 0.5), np.nan, value)
    value = np.pad(value, 1, constant_values=0.5)
    found = set()
    for axis in (0, 1):  # rows are y
        one, other = (np.take(value, range(a, value.shape[axis] - 1 + a), axis) for a in (0, 1))
        met = ((one < 0.5) & (other == 0.5)) | ((one == 0.5) & (other < 0.5))
        for row, column in np.argwhere(met).tolist():
            end = (column - 1, row) if axis == 0 else (column, row - 1)
            along = (1, 0) if axis == 0 else (0, 1)
            found.add((*end, end[0] + along[0], end[1] + along[1]))
    return found


def in_cells(map, found):
    """The borders of a frontier, cut to those of single cells."""
    corner = map.corner + map.tree.corner * map.resolution
    parts = []
    for (x0, y0), (x1, y1) in np.rint((found.edges - corner) / map.resolution).astype(int).tolist():
        assert (x0 == x1) != (y0 == y1)
        if x0 == x1:
            parts += [(x0, y, x0, y + 1) for y in range(min(y0, y1), max(y0, y1))]
        else:
            parts += [(x, y0, x + 1, y0) for x in range(min(x0, x1), max(x0, x1))]
    return parts


@pytest.mark.parametrize("seed", [*range(5), *map(slow, range(5, 32))])
def test_the_same_borders_as_on_the_finest_grid(seed):
    """Catches a border beside a larger leaf that is lost or found twice, one at the edge of the
    root, and groups that are torn or run together."""
    map, _ = random_map(seed, free_resolution=[1, 2, 4, None][seed % 4])
    found = frontiers(map, min_size=1e-9)
    cells = [in_cells(map, each) for each in found]
    together = [cell for part in cells for cell in part]
    assert len(together) == len(set(together)) and set(together) == borders_on_grid(map)
    sizes = [each.size for each in found]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes == pytest.approx([len(part) * map.resolution for part in cells])
    ends = [{end for a, b, c, d in part for end in ((a, b), (c, d))} for part in cells]
    assert sum(len(each) for each in ends) == len(
        set.union(set(), *ends)
    )  # no two groups share an end
    for part in cells:  # and each hangs together, on a grid of twice the cells
        lines = np.array(part).reshape(-1, 2, 2)
        dots = np.concatenate([2 * lines[:, 0], lines.sum(1), 2 * lines[:, 1]])
        dots -= dots.min(0)
        picture = np.zeros(dots.max(0) + 1)
        picture[tuple(dots.T)] = 1
        assert ndimage.label(picture)[1] == 1
    for each in found:  # beside the border, on the free side
        assert (map.occupancy(each.places) < 0.5).all()
        away = np.abs(each.places - each.edges.mean(1)).sum(1)
        assert away == pytest.approx(np.abs(each.edges[:, 1] - each.edges[:, 0]).sum(1) / 2)


def test_an_empty_map_and_short_ones():
    assert frontiers(QuadtreeMap()) == []
    map = QuadtreeMap(resolution=0.1, free_resolution=0.1)
    map.insert_scan((0.05, 0.05), [], free_points=[(0.05, 0.05)])
    assert [found.size for found in frontiers(map, min_size=0.4)] == pytest.approx([0.4])
    assert frontiers(map) == []
