"""Maps that grew to the left and down: cells are counted from the first corner, not the root's."""

import numpy as np
import pytest

from segmap.exports import ros_classes
from segmap.matching import route
from segmap.quadtree import QuadtreeMap, extent

#: The corner of the first root, and where beams end: beside it, on all four sides.
FIRST, ENDS = (0.0, 0.0), [(-5.25, 0.75), (0.75, -3.25), (6.25, 0.25), (0.25, 5.75), (-3.25, -2.75)]


@pytest.fixture(scope="module", params=[1, 3, 5])
def grown(request):
    map = QuadtreeMap(resolution=0.5, size=2, corner=FIRST, bias=1, free_resolution=0.5)
    for end in ENDS[: request.param]:
        map.insert_scan((0.75, 0.75), [end])
    assert map.bounds[0] < 0 and map.side > 2
    return map


def middles(map):
    """The middle of each cell of the root."""
    left, low, right, high = map.bounds
    x, y = (np.arange(a + 0.25, b, 0.5) for a, b in ((left, right), (low, high)))
    return np.stack(np.meshgrid(x, y), -1)


def test_a_crop_keeps_what_lies_inside(grown):
    at = middles(grown)
    known = grown.occupancy(at.reshape(-1, 2)).reshape(at.shape[:2])
    for left, low, right, high in ((-5.5, -1, 1, 1), (0, 0, 2, 2), (-2, -4, 3, 0.5)):
        found = grown.cropped(left, low, right, high)
        x, y = np.moveaxis(at, -1, 0)
        inside = (left < x) & (x < right) & (low < y) & (y < high)
        values = found.occupancy(at.reshape(-1, 2)).reshape(inside.shape)
        np.testing.assert_array_equal(values, np.where(inside, known, 0.5))


def test_grids_leaves_and_files_lie_where_the_map_does(grown, tmp_path):
    """Each says of a place what the map itself says there."""
    at = middles(grown)
    known = grown.occupancy(at.reshape(-1, 2)).reshape(at.shape[:2])
    np.testing.assert_array_equal(grown.to_grid(), known)
    grid, left, low, side = grown.rasterize(grown.leaf_occupancy())
    assert (left, low, side) == (*grown.bounds[:2], 0.5)
    np.testing.assert_array_equal(grid, known)
    leaves = grown.leaves()
    middle = np.stack([leaves.x + leaves.side / 2, leaves.y + leaves.side / 2], -1)
    np.testing.assert_array_equal(grown.occupancy(middle), grown.leaf_occupancy())
    greys, left, low, side = ros_classes(grown)
    rows, columns = np.indices(greys.shape)
    places = np.stack([left + (columns + 0.5) * side, low + (rows + 0.5) * side], -1)
    values = grown.occupancy(places.reshape(-1, 2)).reshape(greys.shape)
    np.testing.assert_array_equal(greys == 0, values > 0.5)
    grown.save(tmp_path / "it.npz")
    again = QuadtreeMap.load(tmp_path / "it.npz")
    np.testing.assert_array_equal(again.to_grid(), known)
    again.insert_scan((0.75, 0.75), [(-5.25, -3.25)])
    assert again.occupancy([(-5.25, -3.25)]) == 1
    left, low, _, _ = extent(grown, margin=0)
    assert grown.occupancy([ENDS[0]]) == 1 and left == -5.5


def test_a_way_leads_over_what_has_grown(grown):
    way = route(grown, (0.75, 0.75), (-4.25, 0.75), radius=0.1)
    assert way.tolist() == [[0.75, 0.75], [-4.25, 0.75]]
