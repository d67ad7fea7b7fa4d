"""What the chapters draw: the values that their claims rest on. See `test_drawings` first."""

from dataclasses import replace

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from segmap import course
from segmap.alignment import Candidate, Match, PointStep
from segmap.exports import ros_classes
from segmap.matching import DistanceField
from segmap.metrics import distance_terms
from segmap.plotting import ERROR, GROUPS, RAW, RESULT, figure_png
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap
from segmap.reduction import fusion, hough, hybrid
from segmap.scans import LaserScan
from segmap.segments import SegmentMap, length

SCAN = LaserScan(
    [1.0, 2.0, np.inf, 9.0, 3.0], [-1, 0, 1, 2, 3], sensor_pose=(0.5, 0, 0), max_range=8.0
)
STEP = PointStep(
    np.zeros(3), 0.6, np.array([(0, 1.0), (1, 0.5)]), np.array([(0, 0.0), (1, 0)]), np.array([1, 0])
)
WALLS = np.array([[(0, 0), (4, 0)], [(0, 0.06), (4, 0.03)], [(0, 2), (0, 3)]])
SEEN = SegmentMap(WALLS[[0, 0, 2, 0]], [0, 0, 1, 2])


@pytest.fixture
def ax():
    return Figure(figsize=(4, 3), dpi=50).subplots()


@pytest.fixture(autouse=True)
def agg():
    with matplotlib.rc_context({"backend": "agg"}):
        yield
        plt.close("all")


def lines_of(ax, index=0):
    return np.array(ax.collections[index].get_segments())


# ------------------------------------------------------------------ poses and alignments


def test_a_scan_is_drawn_in_each_frame_with_its_valid_points():
    """Catches a pose used in the wrong picture, and readings at maximum range drawn as walls."""
    frames = {"robot": (0, 0, 0), "map": (3, 4, np.pi / 2)}
    row = course.draw_frames(SCAN, frames, every=1)
    for ax, pose in zip(row, frames.values(), strict=True):
        drawn = np.column_stack(ax.lines[0].get_data())
        np.testing.assert_allclose(drawn, transform(pose, SCAN.points()), atol=1e-12)
    assert [ax.get_title() for ax in row] == [f"In the frame of the {name}" for name in frames]


def test_only_some_beams_are_drawn_and_they_start_at_the_sensor():
    """Catches beams from the turning point of the robot, and a fan that hides the points."""
    (ax,) = course.draw_frames(SCAN, {"map": (3, 4, 0)}, every=2)
    beams = lines_of(ax)
    np.testing.assert_allclose(beams[:, 0], [(3.5, 4), (3.5, 4)])
    np.testing.assert_allclose(beams[:, 1], transform((3, 4, 0), SCAN.points()[[0, 2]]))
    assert len(ax.lines[1].get_xdata()) == 3  # all valid points


def test_each_point_has_a_line_to_its_wall_thin_where_it_weighs_little(ax):
    """Catches lines from wall to wall, and outliers that look as important as the rest."""
    course.draw_icp_step([(0, 0), (1, 0), (2, 0)], STEP, ax=ax)
    np.testing.assert_array_equal(lines_of(ax), [[(0, 1), (0, 0)], [(1, 0.5), (1, 0)]])
    thick, thin = ax.collections[0].get_linewidth()
    assert thick > 3 * thin
    walls, points = (line.get_xydata() for line in ax.lines)
    assert len(walls) == 3 and points.tolist() == STEP.points.tolist()


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


def test_a_candidate_lays_the_second_scan_on_the_first(ax):
    """Catches the first scan moved in place of the second, and the inverse motion."""
    walls, pose = np.array([[(0, 0), (2, 0)]], float), np.array([1, 2, np.pi / 2])
    guess = Candidate(pose, 3.0, 1.0, 2.0, 1, np.empty((0, 5)))
    course.draw_candidate(walls, walls, guess, ax=ax, color=ERROR)
    np.testing.assert_array_equal(lines_of(ax, 0), walls)
    np.testing.assert_allclose(lines_of(ax, 1), [[(1, 2), (1, 4)]])
    assert ax.get_title() == "3.0 m agree, 1.0 m seen through walls"


def test_each_outcome_has_its_colour_where_it_started(ax):
    """Catches rows drawn as columns, and colours that follow the words that happen to occur."""
    course.draw_basin([["free", "wrong"], ["right", "right"]], [0, 1], [5, 7], ax=ax)
    (mesh,) = ax.collections
    figure_png(ax.figure)
    colors = [to_hex(color) for color in mesh.get_facecolor()]
    assert colors == [GROUPS[0], ERROR, RESULT, RESULT]
    assert ax.get_xlim() == (-0.5, 1.5) and ax.get_ylim() == (4, 8)


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda: course.draw_basin([["right"]], [0, 1], [0]), "outcomes must be"),
        (lambda: course.draw_basin([["right", "lost"]], [0, 1], [0]), "outcomes must be"),
        (lambda: course.draw_marked(WALLS, [True]), r"marked must have shape \(3,\)"),
        (lambda: course.draw_marked(WALLS, [0, 1]), r"marked must have shape \(3,\)"),
        (lambda: course.draw_growth(SEEN, fusion(SEEN)), "an on-line one of these 3 scans"),
        (lambda: course.draw_growth(SEEN, hybrid(WALLS)), "an on-line one of these 3 scans"),
        (
            lambda: course.draw_cells(QuadtreeMap(), np.zeros((3, 4))),
            r"cells must be .* square grid, got shape \(3, 4\)",
        ),
        (
            lambda: course.draw_uncertainty(
                Match(np.zeros(3), np.diag([np.inf] * 3), False, "too few points")
            ),
            "too few points",
        ),
    ],
)
def test_what_cannot_be_drawn_is_named(draw, message):
    with pytest.raises(ValueError, match=message):
        draw()


# ---------------------------------------------------------------- segments and reductions


@pytest.mark.parametrize("pose", [(2.8, 0.75, 0.5), (0.3, 1.0, -0.7), (-3.0, 0.2, 0.1)])
@pytest.mark.parametrize("flip", [1, -1])
def test_the_red_lines_are_as_long_as_the_terms(pose, flip):
    """Catches feet beside the line midway, and the gap from the wrong ends."""
    u = np.array([(0, 0), (2, 0)], float)
    v = transform(pose, [(-0.75, 0.0), (0.75, 0.0)])[::flip]
    axes = course.draw_distance_terms(u, v)
    red = [length(np.array(ax.collections[-1].get_segments())) for ax in axes]
    assert [len(part) for part in red] == [2, 1, 1]
    np.testing.assert_allclose([part.mean() for part in red], distance_terms(u, v))
    for ax, term in zip(axes, distance_terms(u, v), strict=True):
        assert ax.get_title().endswith(f"{term:.2f} m")
        np.testing.assert_array_equal(ax.collections[1].get_segments(), [u, v])


def test_each_case_is_reduced_by_itself_and_lies_over_what_is_left():
    """Catches a title with the map of another case, and inputs hidden under the thick result."""
    cases = {"two": WALLS[:2], "one": WALLS[2:]}
    row = course.draw_cases(cases, lambda map: map[:1] + 5)
    for ax, (title, map) in zip(row, cases.items(), strict=True):
        assert ax.get_title() == title and ax.get_aspect() == "auto"
        np.testing.assert_array_equal(lines_of(ax, 0), map[:1] + 5)
        np.testing.assert_array_equal(lines_of(ax, 1), map)


def test_marked_segments_lie_over_the_rest_and_all_are_drawn(ax):
    """Catches a mask that is turned round."""
    course.draw_marked(WALLS, [False, True, False], ax=ax)
    np.testing.assert_array_equal(lines_of(ax, 0), WALLS[[0, 2]])
    np.testing.assert_array_equal(lines_of(ax, 1), WALLS[[1]])


def test_growth_counts_what_was_seen_up_to_each_scan(ax):
    """Catches counts of single scans, and the first scan drawn at 0."""
    course.draw_growth(SEEN, hybrid(SEEN), ax=ax)
    seen, live = ax.lines
    assert seen.get_xdata().tolist() == [1, 2, 3] and seen.get_ydata().tolist() == [2, 3, 4]
    assert live.get_ydata().tolist() == [1, 2, 2] and live.get_color() == RESULT


def test_a_trade_off_shows_both_rates(ax):
    course.draw_trade_off([1, 2, 3], [0.1, 0.2, 0.3], [0.9, 0.8, 0.7], ax=ax)
    drawn = {line.get_label(): line for line in ax.lines}
    assert drawn["quality"].get_xydata().tolist() == [[1, 0.9], [2, 0.8], [3, 0.7]]
    assert drawn["reduction"].get_ydata().tolist() == [0.1, 0.2, 0.3]


def test_ends_fall_at_right_angles_on_the_line_of_the_merged_wall(ax):
    """Catches feet that are cut off at the ends of the wall."""
    wall = np.array([(0, 0), (2, 1)])
    course.draw_merge([[(-1, 1), (3, 3)]], wall, ax=ax)
    dotted = lines_of(ax, 0)
    np.testing.assert_array_equal(dotted[:, 0], [(-1, 1), (3, 3)])
    assert np.allclose((dotted[:, 1] - dotted[:, 0]) @ (2, 1), 0)
    np.testing.assert_allclose(dotted[:, 1], [(-0.4, -0.2), (3.6, 1.8)], atol=1e-12)


def test_a_strip_holds_what_lies_in_it_with_both_ends_up_to_its_border(ax):
    """Catches a shift with the wrong sign, one end that is enough, and < for <=."""
    walls = np.array([[(0, y), (1, z)] for y, z in ((0, 0), (0.03, 0.07), (0.06, 0.06))])
    course.draw_strip(walls, 0.02, 0.04, ax=ax)
    np.testing.assert_array_equal(lines_of(ax, 0), walls[[0, 2]])
    np.testing.assert_array_equal(lines_of(ax, 1), walls[[1]])
    box = ax.patches[0].get_bbox()
    assert (box.y0, box.y1) == pytest.approx((-0.02, 0.06))


def test_centres_go_from_black_dots_to_those_of_their_group(ax):
    """Catches ways drawn across the centres in place of along the steps."""
    ways = np.array([[(0, 0), (1, 0), (5, 5)], [(0.4, 0), (0.6, 0), (5, 5)]])
    course.draw_centres(ways, [0, 0, 1], ax=ax)
    assert [line.get_xydata().tolist() for line in ax.lines] == ways.swapaxes(0, 1).tolist()
    start, end = ax.collections
    np.testing.assert_array_equal(start.get_offsets(), ways[0])
    np.testing.assert_array_equal(end.get_offsets(), ways[1])
    found = [to_hex(c) for c in end.get_facecolor()]
    assert found == [GROUPS[k] for k in (0, 0, 1)]


def test_normals_end_on_the_lines_of_their_walls_in_their_colours(ax):
    """Catches a normal of negative rho that points away from its wall."""
    walls = np.array([[(-1, -2), (3, -2)], [(-4, 1), (-2, 5)]])
    course.draw_normals(walls, ax=ax)
    normals = ax.lines[0:4:2]
    feet = np.array([line.get_xydata()[1] for line in normals])
    np.testing.assert_allclose(feet[0], (0, -2), atol=1e-12)
    assert np.allclose(np.linalg.norm(feet, axis=1), abs(hough(walls)[:, 0]))
    across = np.diff(walls, axis=1)[:, 0]
    assert np.allclose((feet * across).sum(1), 0)
    assert [line.get_color() for line in normals] == list(GROUPS[:2])
    assert [to_hex(c) for c in ax.collections[0].get_edgecolor()] == list(GROUPS[:2])


# ---------------------------------------------------------------- quadtrees and matching


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


@pytest.mark.parametrize(("start", "end"), [((0, 0), (14, 5)), ((9, 2), (0, 0)), ((0, 9), (-3, 1))])
def test_the_mask_is_at_the_end_of_a_ray(ax, start, end):
    """Catches a mask at the start of rays to the left, whose cells come in the other order."""
    course.draw_ray(start, end, ax=ax)
    (crossed, spared), (line,) = (squares(ax, k) for k in (0, 1)), ax.lines
    assert len(crossed) + len(spared) == max(abs(end[0] - start[0]), abs(end[1] - start[1])) + 1
    assert len(spared) == 2 and (*end, 1, 1) in spared and (*start, 1, 1) in crossed
    assert line.get_xydata().tolist() == [[k + 0.5 for k in start], [k + 0.5 for k in end]]
    assert [to_hex(part.get_facecolor()[0]) for part in ax.collections] == [RESULT, RAW]
    for (low, high), k in ((ax.get_xlim(), 0), (ax.get_ylim(), 1)):
        assert (low, high) == (min(start[k], end[k]), max(start[k], end[k]) + 1)


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


def test_a_profile_is_in_degrees_and_its_peaks_are_red(ax):
    """Catches radians on an axis of degrees, and dots that are not on the line."""
    course.draw_profile(np.radians([-90, 0, 90, 180]), [1, 3, 0, 2], ax=ax)
    line, dots = ax.lines
    np.testing.assert_allclose(line.get_xydata(), [(-90, 1), (0, 3), (90, 0), (180, 2)])
    np.testing.assert_allclose(dots.get_xydata(), [(0, 3), (180, 2)])
    assert line.get_color() == RESULT and dots.get_color() == ERROR


def test_a_field_lies_where_its_window_is(ax):
    """Catches rows upside down, x for y, and a bar without its unit."""
    map = QuadtreeMap(resolution=0.5, size=8)
    map.insert_scan((1, 1), [(3.25, 1.25)])
    field = DistanceField(map, (2, 1, 4, 2))
    course.draw_field(field, ax=ax)
    (image,), (_, bar) = ax.images, ax.figure.axes
    left, right, low, high = image.get_extent()
    assert (left, low, right, high) == field.bounds and image.origin == "lower"
    assert image.get_array()[0, 2] == 0 and (image.get_array() == field.distance).all()
    assert bar.get_ylabel() == "distance [m]"


def test_trials_have_a_mark_a_matcher_and_the_thesis_is_red(ax):
    one = course.Trial("it", "hill climbing", "field", 0, 0.013, 0.03, 0.01, 900, 800, 0.1)
    two, lost = replace(one, median=0.02), replace(one, matcher="hill climbing, thesis")
    course.draw_trials([one, lost, two], ax=ax)
    assert [line.get_label() for line in ax.lines] == ["hill climbing", "hill climbing, thesis"]
    assert [line.get_color() for line in ax.lines] == [RESULT, ERROR]
    assert ax.lines[0].get_marker() != ax.lines[1].get_marker()
    np.testing.assert_allclose(ax.lines[0].get_xydata(), [(900, 13), (900, 20)])
