"""What the library draws: how many lines, where, with which labels. See `test_drawings` first."""

import base64
import io
import json
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgba
from matplotlib.figure import Figure

from segmap import plotting
from segmap.alignment import Alignment, Graph
from segmap.alignment.graph import Rejected
from segmap.plotting import ERROR, GROUPS, MAP, RAW, RESULT, TRUTH
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap
from segmap.reduction import Reduction
from segmap.scans import LaserScan, Log
from segmap.segments import SegmentMap

THREE = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(0, 0.02), (4, 0.02)]], float)
CROSS = np.array([[(0, 0), (4, 3)], [(0, 3), (4, 0)]], float)
SCAN = LaserScan([1.0, 2.0, np.inf, 9.0], np.radians([-90, 0, 45, 90]), max_range=8.0)
LOG = Log("two", [SCAN, SCAN], truth=[(1, 0, 0), (2, 0, np.pi / 2)])
REDUCTION = Reduction(THREE[:2], np.array([0, 1, 0]), 0.0, "by hand")
POSES = np.array([(0, 0, 0), (1, 0, 0.1), (2, 1, 0.2), (0, 1, 0.3)], float)
USED = np.array([True, True, False, True])
STEPS = np.array([(0, 1), (1, 2), (2, 3), (0, 3)])
GRAPH = Graph(STEPS, np.zeros((4, 3)), np.arange(4) == 3, np.zeros(4), (Rejected(1, 3, "far"),))
LOOPED = Alignment(POSES, USED, 0.0, "pose_graph", ("", "", "turning", ""), GRAPH)
PLAIN = Alignment(POSES, np.full(4, True), 0.0, "odometry", ("",) * 4)
FOUR = Log("four", [SCAN] * 4, truth=[(1, 1, 0), (np.nan,) * 3, (3, 2, 0), (2, 2, 0)])


pytestmark = pytest.mark.usefixtures("agg")


def lines_of(ax, index=0):
    return np.array(ax.collections[index].get_segments())


def colors_of(ax, index=0):
    plotting.figure_png(ax.figure)  # colours by value are known only then
    return [to_hex(c) for c in ax.collections[index].get_edgecolor()]


def dots_of(ax, index=0):
    return np.column_stack(ax.lines[index].get_data())


def legend_of(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def pixels(png):
    return plt.imread(io.BytesIO(png))[..., :3]


# ------------------------------------------------------------------- scans, logs, poses
def test_a_scan_is_drawn_where_its_valid_beams_end_and_the_robot_points_ahead(ax):
    """Catches readings at maximum range drawn as walls, and beams from the turning point."""
    pose = (1, 1, np.pi / 2)
    plotting.draw_scan(SCAN, pose, ax=ax)
    np.testing.assert_allclose(dots_of(ax), transform(pose, [(0, -1), (2, 0)]), atol=1e-12)
    corners = ax.patches[0].get_xy()
    assert corners[np.argmax(corners[:, 1])] == pytest.approx((1, 1.15))
    moved = LaserScan([1.0, np.nan], [0, 1], sensor_pose=(0.5, 0, 0))
    plotting.draw_scan(moved, (0, 2, 0), ax=ax, beams=True)
    np.testing.assert_allclose(lines_of(ax), [[(0.5, 2), (1.5, 2)]])


@pytest.mark.parametrize(
    ("log", "poses", "color"),
    [
        (LOG, None, TRUTH),
        (LOG, LOG.truth, RESULT),
        (Log("raw", [replace(SCAN, odometry=tuple(p)) for p in LOG.truth]), None, ERROR),
    ],
)
def test_a_log_is_drawn_at_its_poses_whose_colour_tells_their_origin(log, poses, color, ax):
    """Catches odometry that is passed off as truth."""
    plotting.draw_log(log, poses, ax=ax)
    expected = np.concatenate([transform(p, SCAN.points()) for p in LOG.truth])
    np.testing.assert_allclose(dots_of(ax), expected, atol=1e-12)
    np.testing.assert_allclose(dots_of(ax, 1), LOG.truth[:, :2])
    assert ax.lines[1].get_color() == color


def test_scans_and_places_that_are_unknown_are_left_out(ax):
    """Catches, of a long log, a picture of the first scans only."""
    plotting.draw_log(LOG, [(0, 0, 0), (np.nan, np.nan, np.nan)], ax=ax)
    assert len(dots_of(ax)) == 2
    rows = np.array([(0, 0, 0), (np.nan,) * 3, (2, 1, 0)])
    plotting.draw_path(rows, ax=ax, label="truth")
    assert np.isnan(ax.lines[-1].get_xdata()).tolist() == [False, True, False]
    many = LaserScan(np.linspace(1, 2, 50_000), np.zeros(50_000))
    long = plotting.draw_log(Log("long", [many] * 3, truth=np.zeros((3, 3))))
    drawn = dots_of(long)[:, 0]
    assert 40_000 < len(drawn) <= 60_000 and drawn[-1] > 1.99


# ----------------------------------------------------------------------- segments, maps


@pytest.mark.parametrize(
    ("values", "most", "ends"),
    [
        ([0.1, 0.0, 0.05], 0.1, (0.0, 1.0)),
        ([0, 0, 0], 1e-3, (0.0, 0.0)),
        ([1e-17, 0, 1e-16], 1e-3, (0.0, 0.0)),
        ([np.inf] * 3, 1e-3, (1.0, 1.0)),
    ],
)
def test_errors_run_through_their_colours_with_a_scale(values, most, ends, ax):
    """Catches good segments on top of bad ones, rounding errors in dark red, an infinite scale."""
    plotting.draw_segments(THREE, error=values, ax=ax)
    found = colors_of(ax)
    assert ax.collections[0].get_clim() == (0, most)
    assert ax.figure.axes[1].get_ylabel() == "error [m]"
    assert [found[0], found[-1]] == [to_hex(plotting.ERRORS(end)) for end in ends]
    np.testing.assert_array_equal(lines_of(ax), THREE[np.argsort(values, kind="stable")])


def test_a_thick_after_lies_over_a_thin_before_and_both_are_counted(ax):
    """Catches the roles exchanged: the reduced map is the blue one, and nothing hides it."""
    plotting.draw_before_after(SegmentMap(THREE), REDUCTION, ax=ax)
    assert [len(lines_of(ax, k)) for k in (0, 1)] == [2, 3]
    assert set(colors_of(ax, 0)) == {RESULT} and set(colors_of(ax, 1)) == {MAP}
    after, before = ax.collections
    assert after.get_linewidth()[0] > before.get_linewidth()[0]
    assert after.get_zorder() > before.get_zorder()
    assert legend_of(ax) == ["after: 2 segments", "before: 3 segments"]


def test_each_output_shares_its_colour_with_the_inputs_that_made_it(ax):
    """Catches colours by input index, and a dropped input with the colour of the last output."""
    before = np.concatenate([THREE, [[(9, 9), (9, 9)]]])
    plotting.draw_provenance(before, Reduction(THREE[:2], np.array([1, 0, 1, -1]), 0.0), ax=ax)
    outputs, inputs = (colors_of(ax, k) for k in (0, 1))
    assert outputs == list(GROUPS[:2]) and inputs == [outputs[1], outputs[0], outputs[1], RAW]
    in_turn = plotting.draw_segments(THREE, group=[1, -1, 1 + len(GROUPS)])
    assert colors_of(in_turn) == [GROUPS[1], RAW, GROUPS[1]]


# --------------------------------------------------------------------------- alignments
def test_an_alignment_shows_what_was_used_and_what_was_not(ax):
    """Catches a scan nobody could place drawn as if it were map, and a path that jumps over it."""
    plotting.draw_alignment(FOUR, LOOPED, ax=ax)
    drawn = {line.get_color(): np.column_stack(line.get_data()) for line in ax.lines}
    expected = [transform(pose, SCAN.points()) for pose in POSES[USED]]
    np.testing.assert_allclose(drawn[RAW], np.concatenate(expected))
    np.testing.assert_array_equal(drawn[RESULT], POSES[:, :2])
    np.testing.assert_array_equal(drawn[ERROR], POSES[[2], :2])
    closed, rejected = ax.collections
    np.testing.assert_array_equal(closed.get_segments(), [POSES[[0, 3], :2]])
    np.testing.assert_array_equal(rejected.get_segments(), [POSES[[1, 3], :2]])
    assert [to_hex(part.get_color()[0]) for part in (closed, rejected)] == [RESULT, ERROR]
    names = ["1 loop", "1 rejected loop", "1 scan not used", "pose_graph"]
    assert sorted(legend_of(ax)) == names
    assert legend_of(plotting.draw_alignment(FOUR, PLAIN)) == ["odometry"]


# --------------------------------------------------------------------------- quadtrees
def tree():
    """Free to the right of the sensor, a hit at the right edge, unknown above."""
    map = QuadtreeMap(resolution=1, size=16, bias=1)
    map.insert_scan((0.5, 0.5), [(15.5, 0.5)])
    return map


def test_each_point_has_the_grey_of_its_leaf_and_leaves_leave_no_gap():
    """Catches occupied drawn white, rows upside down, x exchanged with y, seams of squares."""
    map, ax = tree(), Figure(figsize=(4, 4), dpi=64).add_axes((0, 0, 1, 1))
    plotting.draw_quadtree(map, ax=ax, outlines=False).axis("off")
    ax.set(xlim=(0, 16), ylim=(0, 16))
    image = pixels(plotting.figure_png(ax.figure))[::-1]
    centres = np.arange(16) + 0.5
    at = (centres * len(image) / 16).astype(int)
    places = np.stack(np.meshgrid(centres, centres), -1).reshape(-1, 2)
    expected = 1 - map.occupancy(places).reshape(16, 16)
    for channel in range(3):
        np.testing.assert_allclose(image[np.ix_(at, at)][..., channel], expected, atol=0.01)
    assert (expected[0, 15], expected[0, 0], expected[15, 0]) == (0, 1, 0.5)
    assert set(np.unique(image.round(2))) == {0.0, 0.5, 1.0}


def test_the_part_that_was_hit_is_shown(ax):
    """Catches a room of 4 m as a dot in a root of 655 m."""
    map = QuadtreeMap(resolution=0.1)
    assert plotting.draw_quadtree(map, ax=ax).get_xlim() == (0, 51.2)
    map.insert_scan((1, 1), [(2, 1), (-200, 1)], [(0, 900.0)])
    (left, right), (low, high) = plotting.draw_quadtree(map, ax=ax).get_xlim(), ax.get_ylim()
    assert -220 < left < -200 < 2 < right < 20 and high - low < 40


# ------------------------------------------------------------------------ as bytes
@pytest.mark.parametrize(
    ("value", "color"),
    [
        *((SCAN, ERROR), (LOG, TRUTH), (SegmentMap(CROSS), MAP), (LOOPED, RESULT), (tree(), MAP)),
        (Reduction(CROSS, np.array([0, 1]), 0.0), RESULT),
    ],
    ids=lambda value: type(value).__name__,
)
def test_a_notebook_gets_text_and_a_small_picture_in_the_colour_of_the_thing(value, color):
    """Catches bytes, which a notebook file cannot hold, and a picture that is empty."""
    bundle = json.loads(json.dumps(value._repr_mimebundle_()))
    png = base64.b64decode(bundle["image/png"])
    assert bundle["text/plain"] == repr(value) and png == plotting.thumbnail(value)
    assert pixels(png).shape == (240, 320, 3) and len(png) < 30_000 and b"atplotlib" not in png
    middle = pixels(png)[20:205, 70:300]
    assert (np.linalg.norm(middle - to_rgba(color)[:3], axis=-1) < 0.3).sum() >= 10
    assert plt.get_fignums() == []
