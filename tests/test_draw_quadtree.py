"""Pictures of quadtree maps: each leaf in its grey, outlines, the robot, what is shown."""

import base64
import io

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from segmap import load
from segmap.plotting import ERROR, RESULT, draw_quadtree, figure_png, thumbnail
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
