"""Pictures of quadtree maps: each leaf in its grey, outlines, the robot, what is shown."""

import base64
import io

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from segmap import load
from segmap.course import draw_cells, draw_classes, draw_ray
from segmap.exports import ros_classes
from segmap.plotting import ERROR, RAW, RESULT, draw_quadtree, draw_quadtrees, figure_png, thumbnail
from segmap.quadtree import QuadtreeMap, build_map


@pytest.fixture
def ax():
    return Figure(figsize=(4, 4), dpi=64).add_axes((0, 0, 1, 1))


def example() -> QuadtreeMap:
    """Free to the right of the sensor, a hit at the right edge, unknown above."""
    map = QuadtreeMap(resolution=1, size=16, bias=1)
    map.insert_scan((0.5, 0.5), [(15.5, 0.5)])
    return map


def pixels(ax):
    ax.axis("off")
    image = plt.imread(io.BytesIO(figure_png(ax.figure)))[::-1, :, :3]
    return image


def test_each_point_has_the_grey_of_its_leaf(ax):
    """Catches occupied drawn white, rows upside down, and x exchanged with y."""
    map = example()
    image = pixels(draw_quadtree(map, ax=ax, outlines=False, whole=True))
    side = len(image)
    centres = (np.arange(16) + 0.5) / 16
    at = (centres * side).astype(int)
    x, y = np.meshgrid(centres * 16, centres * 16)
    expected = 1 - map.occupancy(np.stack([x, y], -1).reshape(-1, 2)).reshape(16, 16)
    for channel in range(3):
        np.testing.assert_allclose(image[np.ix_(at, at)][..., channel], expected, atol=0.01)
    assert expected[0, 15] == 0 and expected[0, 0] == 1 and expected[15, 0] == 0.5


def test_leaves_leave_no_gap(ax):
    """Catches seams between squares: the picture holds the greys of the map and no other."""
    image = pixels(draw_quadtree(example(), ax=ax, outlines=False, whole=True))
    assert set(np.unique(image.round(2))) == {0.0, 0.5, 1.0}


def test_outlines_are_blue_and_can_be_left_out(ax):
    draw_quadtree(example(), ax=ax, whole=True)
    assert len(ax.collections) == 2 and len(ax.collections[1].get_paths()) == 13
    assert (ax.collections[1].get_edgecolor()[0] == to_rgba(RESULT)).all()
    assert len(draw_quadtree(example(), ax=Figure().subplots(), outlines=False).collections) == 1


def test_small_leaves_are_not_drowned_in_their_outlines(ax):
    """Catches a picture in which walls are blue instead of black."""
    log = load("room")
    map = build_map(log, log.truth, resolution=0.01)
    draw_quadtree(map, ax=ax)
    assert len(ax.collections[0].get_array()) == len(map.leaves().x)
    assert 100 < len(ax.collections[1].get_paths()) < 0.3 * len(map.leaves().x)


def test_the_robot_is_red_and_where_it_is(ax):
    draw_quadtree(example(), ax=ax, robot=(3, 5, 1.0))
    (mark,) = ax.lines
    assert mark.get_xydata().tolist() == [[3, 5]] and mark.get_color() == ERROR


def test_the_part_that_was_hit_is_shown_or_the_whole_root(ax):
    """Catches a room of 4 m as a dot in a root of 655 m."""
    map = QuadtreeMap(resolution=0.1)
    assert draw_quadtree(map, ax=ax).get_xlim() == (0, 51.2)
    map.insert_scan((1, 1), [(2, 1), (-200, 1)], [(0, 900.0)])
    (left, right), (low, high) = draw_quadtree(map, ax=ax).get_xlim(), ax.get_ylim()
    assert -220 < left < -200 < 2 < right < 20 and high - low < 40
    assert draw_quadtree(map, ax=ax, whole=True).get_xlim() == map.bounds[0::2]


def test_a_map_shows_itself_in_a_notebook():
    """Catches a map that a notebook shows as one line."""
    bundle = example()._repr_mimebundle_()
    assert base64.b64decode(bundle["image/png"]) == thumbnail(example())
    assert thumbnail(example()) != thumbnail(QuadtreeMap(resolution=1, size=16))
    assert bundle["text/plain"] == "QuadtreeMap(16 m, 13 leaves of 1 m and more, 1 scan)"


def test_maps_side_by_side_have_their_titles_and_limits():
    """Catches maps under each other's titles, and options that reach only the first."""
    other = QuadtreeMap(resolution=1, size=8, corner=(-4, 2))
    left, right = draw_quadtrees({"one": example(), "other": other}, whole=True, outlines=False)
    assert (left.get_title(), right.get_title()) == ("one", "other")
    assert left.get_xlim() == (0, 16) and (*right.get_xlim(), *right.get_ylim()) == (-4, 4, 2, 10)
    assert len(left.collections) == len(right.collections) == 1
    plt.close(left.figure)


def squares(ax, index=0):
    """Lower left corners and sides of squares that were drawn."""
    corners = [path.vertices[:4] for path in ax.collections[index].get_paths()]
    return sorted((*c.min(0).tolist(), *(c.max(0) - c.min(0)).tolist()) for c in corners)


@pytest.mark.parametrize("resolution", [1, 4])
def test_chosen_cells_lie_where_the_map_has_them(ax, resolution):
    """Catches rows upside down, x for y, a root that does not begin at 0, and coarser grids."""
    map = QuadtreeMap(resolution=1, size=16, corner=(-3, 7))
    map.insert_scan((-2.5, 7.5), [(10.5, 8.5)])
    draw_cells(map, map.to_grid(resolution) > 0.5, ax=ax)
    (left, low, *sides), *rest = squares(ax)
    assert sides == [resolution, resolution] and not rest
    assert left <= 10.5 < left + resolution and low <= 8.5 < low + resolution
    assert ax.collections[0].get_facecolor()[0].tolist() == list(to_rgba(ERROR))


def test_no_cell_and_cells_that_are_none(ax):
    map = example()
    assert not squares(draw_cells(map, np.zeros((16, 16), bool), ax=ax))
    with pytest.raises(ValueError, match=r"cells must be .* square grid, got shape \(3, 4\)"):
        draw_cells(map, np.zeros((3, 4)), ax=ax)


@pytest.mark.parametrize(("start", "end"), [((0, 0), (14, 5)), ((9, 2), (0, 0)), ((0, 9), (-3, 1))])
def test_the_mask_is_at_the_end_of_a_ray(ax, start, end):
    """Catches a mask at the start of rays to the left, whose cells come in the other order."""
    draw_ray(start, end, ax=ax)
    (crossed, spared), (line,) = (squares(ax, k) for k in (0, 1)), ax.lines
    assert len(crossed) + len(spared) == max(abs(end[0] - start[0]), abs(end[1] - start[1])) + 1
    assert len(spared) == 2 and (*end, 1, 1) in spared and (*start, 1, 1) in crossed
    assert line.get_xydata().tolist() == [[k + 0.5 for k in start], [k + 0.5 for k in end]]
    colors = [ax.collections[k].get_facecolor()[0].tolist() for k in (0, 1)]
    assert colors == [list(to_rgba(RESULT)), list(to_rgba(RAW))] and line.get_color() == ERROR
    for (low, high), k in ((ax.get_xlim(), 0), (ax.get_ylim(), 1)):
        assert (low, high) == (min(start[k], end[k]), max(start[k], end[k]) + 1)


def test_classes_are_drawn_at_their_place_the_lowest_row_below(ax):
    """Catches a picture half a pixel off, or upside down; white must be free."""
    map = QuadtreeMap(resolution=0.5, size=4, bias=1)
    map.insert_scan((0.2, 0.2), [(1.2, 0.2)], [(0.2, 1.7)] * 2)
    classes = ros_classes(map)
    draw_classes(classes, ax=ax)
    (image,) = ax.images
    assert image.origin == "lower" and (image.get_array() == classes.greys).all()
    rows, columns = classes.greys.shape
    edges = classes.left, classes.left + columns * 0.5, classes.low, classes.low + rows * 0.5
    assert tuple(image.get_extent()) == edges and image.get_clim() == (0, 254)
