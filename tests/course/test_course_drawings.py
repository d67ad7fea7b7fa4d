"""What the chapters draw: the values that their claims rest on. See `test_drawings` first."""

from functools import partial

import numpy as np
import pytest
import segmap_course as course
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex

from segmap.alignment import Match
from segmap.alignment.points import PointStep
from segmap.exports import ros_classes
from segmap.plotting import ERROR, MAP, RAW, RESULT
from segmap.quadtree import QuadtreeMap

TWO, FEET = np.array([(0, 1.0), (1, 0.5)]), np.array([(0, 0.0), (1, 0)])
STEP = PointStep(np.zeros(3), 0.6, TWO, FEET, np.array([1, 0]))
WALLS = np.array([[(0, 0), (4, 0)], [(0, 0.06), (4, 0.03)], [(0, 2), (0, 3)]])
#: In the strip with both ends, with one, and on the border.
STRIP = np.array([[(0, y), (1, z)] for y, z in ((0, 0), (0.03, 0.07), (0.06, 0.06))])


pytestmark = pytest.mark.usefixtures("agg")


def content(ax):
    """Every line and every collection of lines: its colour and its coordinates, from below."""
    lines = [(line.get_color(), line.get_xydata()) for line in ax.lines]
    parts = [c for c in ax.collections if isinstance(c, LineCollection)]
    lines += [(to_hex(c.get_color()[0]), np.array(c.get_segments())) for c in parts]
    return [(color, (np.round(places, 9) + 0.0).tolist()) for color, places in lines]


#: What each drawing consists of, and what its labels, its title or its letters say.
DRAWN = {
    "points have lines to their walls, not walls to walls": (
        partial(course.draw_icp_step, FEET, STEP),
        [(RAW, FEET), (RESULT, TWO), (ERROR, [[(0, 1), (0, 0)], [(1, 0.5), (1, 0)]])],
    ),
    "what two segments cover of each other, and the farthest end of the second": (
        partial(course.draw_match_value, [(0, 0), (3, 0)], [(1, 1), (4, 1)]),
        [(MAP, [(4, 1), (3, 0)]), (MAP, [[(0, 0), (3, 0)], [(1, 1), (4, 1)]]),
         (ERROR, [[(1, 0), (3, 0)]]), (ERROR, [[(1, 1), (3, 1)]])],
        "2.00 m of u covered", "2.00 m of v covered", "  1.41 m",
    ),
    "marked segments lie over the rest": (
        partial(course.draw_marked, WALLS, [False, True, False]),
        [(RAW, WALLS[[0, 2]]), (ERROR, WALLS[[1]])],
    ),
    "ends fall at right angles on the line, beyond the wall too": (
        partial(course.draw_merge, [[(-1, 1), (3, 3)]], [(0, 0), (2, 1)]),
        [(RAW, [[(-1, 1), (-0.4, -0.2)], [(3, 3), (3.6, 1.8)]]),
         (RESULT, [[(0, 0), (2, 1)]]), (MAP, [[(-1, 1), (3, 3)]])],
        "merged", "its parts",
    ),
    "a strip holds what lies in it with both ends, up to its border": (
        partial(course.draw_strip, STRIP, 0.02, 0.04), [(MAP, STRIP[[0, 2]]), (ERROR, STRIP[[1]])]
    ),
    "a profile is in degrees, with its peaks": (
        partial(course.draw_profile, np.radians([-90, 0, 90, 180]), [1, 3, 0, 2]),
        [(RESULT, [(-90, 1), (0, 3), (90, 0), (180, 2)]), (ERROR, [(0, 3), (180, 2)])],
    ),
    "a profile may be drawn without its peaks": (
        partial(course.draw_profile, [0, 0], [0, 1], tops=False), [(RESULT, [(0, 0), (0, 1)])]
    ),
    "marks stand at their places, and their words beside them": (
        partial(course.mark_places, {"open": 2.0, "shut": 4.0}, at=(0.5, 0.1)),
        [(RAW, [(2, 0), (2, 1)]), (RAW, [(4, 0), (4, 1)])], "open", "shut",
    ),
}  # fmt: skip


@pytest.mark.parametrize("claim", DRAWN)
def test_a_drawing_consists_of(claim, ax):
    draw, parts, *words = DRAWN[claim]
    draw(ax=ax)
    expected = [(color, np.array(places, float).tolist()) for color, places in parts]
    assert content(ax) == expected
    named = [line.get_label() for line in (*ax.lines, *ax.collections)]
    said = [ax.get_title(), *(text.get_text() for text in ax.texts), *named]
    assert [word for word in said if word and not word.startswith("_")] == words


def test_the_second_scan_is_laid_by_its_pose():
    """Catches the inverse of the pose, and a wrong place in the colour of a right one."""
    poses = {"right": (0, 0, 0), "wrong": (1, 2, np.pi / 2)}
    right, wrong = course.draw_laid(WALLS[:1], WALLS[:1], poses)
    assert content(right)[1] == (RESULT, [[[0, 0], [4, 0]]])
    assert content(wrong) == [(MAP, [[[0, 0], [4, 0]]]), (ERROR, [[[1, 2], [1, 6]]])]


@pytest.mark.parametrize("turn", [0.0, 0.5, 2.0])
def test_the_ellipse_lies_along_the_direction_that_is_least_known(turn, ax):
    """Catches the transpose of the axes, variances as deviations, and half axes as whole ones."""
    c, s = np.cos(turn), np.sin(turn)
    axes = np.array([(c, -s), (s, c)])
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = axes @ np.diag([0.25, 0.01]) @ axes.T
    course.draw_uncertainty(Match(np.array([3.0, 4, 1]), covariance, True), ax=ax)
    (ellipse,) = ax.patches
    ends = ellipse.get_patch_transform().transform([(1, 0), (0, 1)]) - (3, 4)
    reach = np.hypot(*ends.T)
    assert sorted(reach) == pytest.approx([0.2, 1.0])
    longest = ends[np.argmax(reach)]
    assert abs(longest @ (c, s)) == pytest.approx(1.0)


def test_normals_end_on_the_lines_of_their_walls_and_hough_space_has_their_lengths():
    """Catches a normal of negative rho that points away from its wall, and one from elsewhere."""
    walls, at = np.array([[(-1, -2), (3, -2)], [(-4, 1), (-2, 5)]]), np.array([1.0, 2.0])
    left, right = course.draw_normals(walls, at=at)
    feet = np.array([line.get_xydata()[1] for line in left.lines[0:4:2]])
    np.testing.assert_allclose(feet[0], (1, -2), atol=1e-12)
    across = np.diff(walls, axis=1)[:, 0]
    assert np.allclose(((feet - at) * across).sum(1), 0)
    assert np.allclose(((feet - walls[:, 0]) @ [[0, 1], [-1, 0]] * across).sum(1), 0)
    rho = [line.get_ydata()[0] for line in right.lines]
    assert np.allclose(np.linalg.norm(feet - at, axis=1), np.abs(rho))
    shown = [[line.get_color() for line in lines] for lines in (left.lines[0:4:2], right.lines)]
    assert shown[0] == shown[1] and len(set(shown[0])) == 2


def squares(ax, index=0):
    """Lower left corners and sides of squares that were drawn."""
    corners = [path.vertices[:4] for path in ax.collections[index].get_paths()]
    return sorted((*c.min(0).tolist(), *(c.max(0) - c.min(0)).tolist()) for c in corners)


@pytest.mark.parametrize("resolution", [1, 4])
def test_chosen_cells_lie_where_the_map_has_them(ax, resolution):
    """Catches rows upside down, x for y, a root that does not begin at 0, and coarser grids."""
    map = QuadtreeMap(resolution=1, size=16, corner=(-3, 7))
    map.insert_scan((-2.5, 7.5), [(10.5, 8.5)])
    course.draw_cells(map, map.to_grid(resolution) > 0.5, ax=ax)
    (left, low, *sides), *rest = squares(ax)
    assert sides == [resolution, resolution] and not rest
    assert left <= 10.5 < left + resolution and low <= 8.5 < low + resolution


def test_classes_are_drawn_at_their_place_the_lowest_row_below(ax):
    """Catches a picture half a pixel off, or upside down; white must be free."""
    map = QuadtreeMap(resolution=0.5, size=4, bias=1)
    map.insert_scan((0.2, 0.2), [(1.2, 0.2)], [(0.2, 1.7)] * 2)
    classes = ros_classes(map)
    course.draw_classes(classes, ax=ax)
    (image,) = ax.images
    assert image.origin == "lower" and (image.get_array() == classes.greys).all()
    rows, columns = classes.greys.shape
    edges = classes.left, classes.left + columns * 0.5, classes.low, classes.low + rows * 0.5
    assert tuple(image.get_extent()) == edges and image.get_clim() == (0, 254)
