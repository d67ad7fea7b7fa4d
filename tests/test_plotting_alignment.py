"""Pictures of alignments: which colour says what, and what is counted."""

import json
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from segmap import course, load, plotting
from segmap.alignment import Alignment, Candidate, Graph, Match, PointStep, Rejected, odometry
from segmap.metrics import distance_terms
from segmap.plotting import MAP
from segmap.poses import transform
from segmap.scans import LaserScan, Log
from segmap.segments import length

SCAN = LaserScan([1.0, 2.0], [0.0, 0.5])
LOG = Log("four", [SCAN] * 4)
POSES = np.array([(0, 0, 0), (1, 0, 0.1), (2, 1, 0.2), (0, 1, 0.3)], float)
USED = np.array([True, True, False, True])
REASONS = ("", "", "turning", "")
STEPS = np.array([(0, 1), (1, 2), (2, 3), (0, 3)])
GRAPH = Graph(STEPS, np.zeros((4, 3)), np.arange(4) == 3, np.zeros(4), (Rejected(1, 3, "far"),))
WITH_GRAPH = Alignment(POSES, USED, 0.0, "pose_graph", REASONS, GRAPH)
PLAIN = Alignment(POSES, np.full(4, True), 0.0, "odometry", ("",) * 4)


@pytest.fixture
def ax():
    return Figure(figsize=(4, 3), dpi=50).subplots()


def legend_of(ax):
    return sorted(text.get_text() for text in ax.get_legend().get_texts())


def line(ax, color, style="-"):
    (found,) = [
        x for x in ax.lines if x.get_color() == color and x.get_linestyle() in (style, "None")
    ]
    return np.column_stack(found.get_data())


def test_points_of_used_scans_are_grey_and_the_others_left_out(ax):
    """Catches a scan nobody could place drawn as if it were map."""
    plotting.draw_alignment(LOG, WITH_GRAPH, ax=ax)
    expected = [transform(pose, SCAN.points()) for pose in POSES[USED]]
    np.testing.assert_allclose(line(ax, plotting.RAW), np.concatenate(expected))


def test_the_way_is_blue_and_whole_and_unused_scans_are_red_crosses(ax):
    """Catches a way that jumps over the scans that were carried."""
    plotting.draw_alignment(LOG, WITH_GRAPH, ax=ax)
    np.testing.assert_array_equal(line(ax, plotting.RESULT), POSES[:, :2])
    np.testing.assert_array_equal(line(ax, plotting.ERROR), POSES[[2], :2])


def test_loops_are_blue_and_rejected_ones_red_and_dashed(ax):
    """Catches steps drawn as loops, and the two exchanged."""
    plotting.draw_alignment(LOG, WITH_GRAPH, ax=ax)
    closed, rejected = ax.collections
    assert to_hex(closed.get_color()[0]) == plotting.RESULT
    assert to_hex(rejected.get_color()[0]) == plotting.ERROR
    np.testing.assert_array_equal(closed.get_segments(), [POSES[[0, 3], :2]])
    np.testing.assert_array_equal(rejected.get_segments(), [POSES[[1, 3], :2]])
    assert closed.get_linestyle() != rejected.get_linestyle()


def test_the_legend_counts_what_there_is_and_nothing_else(ax):
    plotting.draw_alignment(LOG, WITH_GRAPH, ax=ax)
    assert legend_of(ax) == ["1 loop", "1 rejected loop", "1 scan not used", "pose_graph"]
    bare = plotting.draw_alignment(LOG, PLAIN, ax=Figure().subplots())
    assert legend_of(bare) == ["odometry"] and len(bare.collections) == 0


def test_axes_are_equal_and_in_metres_and_given_ones_are_used(ax):
    assert plotting.draw_alignment(LOG, WITH_GRAPH, ax=ax) is ax
    assert ax.get_aspect() == 1 and (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")


def test_an_alignment_of_another_log_is_refused(ax):
    with pytest.raises(ValueError, match="this log of 2 scans, got one of 4"):
        plotting.draw_alignment(LOG[:2], PLAIN, ax=ax)


def test_an_empty_alignment_is_an_empty_picture(ax):
    nothing = odometry(Log("none", []))
    plotting.draw_alignment(Log("none", []), nothing, ax=ax)
    assert plotting.figure_png(ax.figure)[:4] == plotting.thumbnail(nothing)[:4] == b"\x89PNG"


@pytest.mark.parametrize("alignment", [WITH_GRAPH, PLAIN, odometry(load("malaga"))])
def test_a_notebook_shows_an_alignment(alignment):
    """Catches a cell that fails because an alignment was drawn as a map of segments."""
    bundle = json.loads(json.dumps(alignment._repr_mimebundle_()))
    assert bundle["text/plain"] == repr(alignment)
    assert len(bundle["image/png"]) < 30_000


def test_a_thumbnail_marks_what_was_not_used():
    """Catches a picture that looks the same for a method that failed."""
    graph_only = Alignment(POSES, np.full(4, True), 0.0, "pose_graph", ("",) * 4, GRAPH)
    pictures = {plotting.thumbnail(a) for a in (WITH_GRAPH, PLAIN, graph_only)}
    assert len(pictures) == 3


# ---------------------------------------------------------------------- steps of ICP
STEP = PointStep(
    np.zeros(3), 0.6, np.array([(0, 1.0), (1, 0.5)]), np.array([(0, 0.0), (1, 0)]), np.array([1, 0])
)


def test_each_point_has_a_red_line_to_its_wall_thin_where_it_weighs_little(ax):
    """Catches lines from wall to wall, and outliers that look as important as the rest."""
    course.draw_icp_step([(0, 0), (1, 0), (2, 0)], STEP, ax=ax)
    (lines,) = ax.collections
    np.testing.assert_array_equal(lines.get_segments(), [[(0, 1), (0, 0)], [(1, 0.5), (1, 0)]])
    assert to_hex(lines.get_color()[0]) == plotting.ERROR
    assert lines.get_linewidth()[0] > 3 * lines.get_linewidth()[1]
    np.testing.assert_array_equal(line(ax, plotting.RESULT), STEP.points)
    assert len(line(ax, plotting.RAW)) == 3


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


def test_what_did_not_match_has_no_ellipse(ax):
    none = Match(np.zeros(3), np.diag([np.inf] * 3), False, "too few points")
    with pytest.raises(ValueError, match="too few points"):
        course.draw_uncertainty(none, ax=ax)


# ---------------------------------------------------------------------- candidates and basins
def test_a_candidate_lays_the_second_scan_on_the_first(ax):
    """Catches the first scan moved in place of the second, and the inverse motion."""
    walls, pose = np.array([[(0, 0), (2, 0)]], float), np.array([1, 2, np.pi / 2])
    guess = Candidate(pose, 3.0, 1.0, 2.0, 1, np.empty((0, 5)))
    course.draw_candidate(walls, walls, guess, ax=ax, color=plotting.ERROR)
    below, above = ax.collections
    np.testing.assert_array_equal(below.get_segments(), walls)
    np.testing.assert_allclose(above.get_segments(), [[(1, 2), (1, 4)]])
    assert [to_hex(part.get_color()[0]) for part in (below, above)] == [MAP, plotting.ERROR]
    assert ax.get_title() == "3.0 m agree, 1.0 m seen through walls"


def test_each_outcome_has_its_colour_where_it_started(ax):
    """Catches rows drawn as columns, and colours that follow the words that happen to occur."""
    course.draw_basin([["free", "wrong"], ["right", "right"]], [0, 1], [5, 7], ax=ax)
    (mesh,) = ax.collections
    plotting.figure_png(ax.figure)
    colors = [to_hex(color) for color in mesh.get_facecolor()]
    assert colors == [plotting.GROUPS[0], plotting.ERROR, plotting.RESULT, plotting.RESULT]
    assert ax.get_xlim() == (-0.5, 1.5) and ax.get_ylim() == (4, 8)


@pytest.mark.parametrize("bad", [[["right"]], [["right", "lost"]]])
def test_outcomes_must_be_known_and_one_a_start(bad, ax):
    with pytest.raises(ValueError, match="outcomes must be"):
        course.draw_basin(bad, [0, 1], [0], ax=ax)


# ---------------------------------------------------------------------- several ways of one log
SOME = np.array([(1, 1, 0), (np.nan,) * 3, (3, 2, 0), (2, 2, 0)])
TRUE = Log("true", [SCAN] * 4, truth=SOME)


def test_drift_is_drawn_at_the_scans_whose_truth_is_known(ax):
    """Catches errors drawn at the wrong scans, and those of a way that is only moved as a whole."""
    ways = {"b": SOME + (0, 5, 0), "a": POSES, "graph": replace(WITH_GRAPH, poses=SOME)}
    plotting.draw_position_errors(TRUE, ways, ax=ax)
    assert [x.get_xdata().tolist() for x in ax.lines] == [[0, 2, 3]] * 3
    colors = [plotting.RAW, plotting.ERROR, plotting.RESULT]
    assert [x.get_color() for x in ax.lines] == colors
    np.testing.assert_allclose(ax.lines[0].get_ydata(), 0, atol=1e-12)
    np.testing.assert_allclose(ax.lines[1].get_ydata(), [0, 0, 1], atol=1e-12)
    assert legend_of(ax) == ["a", "b", "graph"] and "[m]" in ax.get_ylabel()


def test_drift_needs_truth(ax):
    with pytest.raises(ValueError, match="must have truth"):
        plotting.draw_position_errors(LOG, {"a": POSES}, ax=ax)


def test_ways_of_a_log_stand_side_by_side_and_odometry_is_red():
    """Catches a way drawn below another's title, and one that hides that it is odometry."""
    log = load("room")[:5]
    ways = {"wheels": log.odometry, "truth": log.truth, "found": odometry(log)}
    axes = plotting.draw_alignments(log, ways, size=(2, 2))
    assert [ax.get_title() for ax in axes] == list(ways)
    ends = [ax.lines[1].get_xydata()[-1] for ax in axes]
    np.testing.assert_array_equal(
        ends, [p[-1, :2] for p in (log.odometry, log.truth, log.odometry)]
    )
    colors = [ax.lines[1].get_color() for ax in axes]
    assert colors == [plotting.ERROR, plotting.RESULT, plotting.RESULT]
    assert [ax.get_legend() is None for ax in axes] == [True, True, False]
    assert len({ax.get_xlim() for ax in axes}) == 1
    plt.close(axes[0].figure)


# ---------------------------------------------------------------------- distances
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
    plt.close(axes[0].figure)
