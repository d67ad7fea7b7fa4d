"""Pictures of the first lessons: points, poses, one scan in several frames, maps side by side."""

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from segmap import course, plotting
from segmap.poses import transform
from segmap.scans import LaserScan

THREE = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(0, 0.02), (4, 0.02)]], float)
SCAN = LaserScan(
    [1.0, 2.0, np.inf, 9.0, 3.0], [-1, 0, 1, 2, 3], sensor_pose=(0.5, 0, 0), max_range=8.0
)


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


def colors_of(ax, index=0):
    return [to_hex(color) for color in ax.collections[index].get_edgecolor()]


# ------------------------------------------------------------------- points, poses
def test_points_are_drawn_where_they_are(ax):
    """Catches x exchanged with y, and dots joined by a line."""
    points = [(0, 1), (2, 3), (5, 8)]
    assert plotting.draw_points(points, ax=ax, color=plotting.MAP, label="seen") is ax
    (dots,) = ax.lines
    np.testing.assert_array_equal(np.column_stack(dots.get_data()), points)
    assert (dots.get_linestyle(), dots.get_label()) == ("None", "seen")
    assert dots.get_color() == plotting.MAP and ax.get_aspect() == 1


@pytest.mark.parametrize("draw", [plotting.draw_points, plotting.draw_poses])
def test_nothing_is_an_empty_picture_in_metres(draw, ax):
    draw([], ax=ax)
    assert len(ax.lines[0].get_xdata()) == 0 and ax.get_xlabel() == "x [m]"


def test_an_arrow_leaves_each_pose_straight_ahead(ax):
    """Catches a heading in degrees, and an arrow whose tip goes beyond its length."""
    plotting.draw_poses([(0, 0, 0), (1, 2, np.pi / 2)], ax=ax)
    tips = [patch.get_xy() for patch in ax.patches]
    assert tips[0][:, 0].max() == pytest.approx(0.3) and tips[1][:, 1].max() == pytest.approx(2.3)
    assert np.ptp(tips[0][:, 1]) < 0.15 and np.ptp(tips[1][:, 0]) < 0.15


def test_poses_are_joined_in_their_order(ax):
    plotting.draw_poses([(0, 0, 0), (3, 1, 0), (1, 2, 0)], ax=ax, label="way")
    assert np.column_stack(ax.lines[0].get_data()).tolist() == [[0, 0], [3, 1], [1, 2]]
    assert ax.lines[0].get_linestyle() == ":" and ax.lines[0].get_label() == "way"


# ----------------------------------------------------------------------- frames
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


# ------------------------------------------------------------------------- maps
def test_each_map_has_its_title_and_its_segments():
    """Catches titles that stand over the wrong maps."""
    row = plotting.draw_maps({"all": THREE, "two": THREE[:2]}, color=plotting.RESULT)
    assert [ax.get_title() for ax in row] == ["all", "two"]
    np.testing.assert_array_equal(lines_of(row[0]), THREE)
    np.testing.assert_array_equal(lines_of(row[1]), THREE[:2])
    assert set(colors_of(row[1])) == {plotting.RESULT}


def test_maps_are_drawn_at_one_scale():
    """Catches a small map blown up until it looks as large as the other."""
    row = plotting.draw_maps({"all": THREE, "one": THREE[:1] / 10})
    assert row[0].get_xlim() == row[1].get_xlim() and row[0].get_ylim() == row[1].get_ylim()
    assert row[1].get_xlim()[1] > 3.9


def test_segments_have_colours_in_turn_unless_a_colour_is_given():
    row = plotting.draw_maps({"all": THREE})
    assert colors_of(row[0]) == list(plotting.GROUPS[:3])
    both = {"a": THREE, "b": THREE}
    row = plotting.draw_maps(both, color=[plotting.ERROR, plotting.MAP], width=0.5)
    assert all(ax.collections[0].get_linewidth()[0] == 0.5 for ax in row)
    assert [set(colors_of(ax)) for ax in row] == [{plotting.ERROR}, {plotting.MAP}]


def test_truth_lies_green_and_thick_below_each_map():
    """Catches a truth that covers what is compared with it, or that only the first map gets."""
    for ax in plotting.draw_maps({"a": THREE, "b": THREE[:1]}, truth=THREE[1:]):
        np.testing.assert_array_equal(lines_of(ax, 0), THREE[1:])
        assert set(colors_of(ax, 0)) == {plotting.TRUTH}
        below, above = ax.collections
        assert above.get_linewidth()[0] == 2.0
        assert below.get_linewidth()[0] > above.get_linewidth()[0]
        assert below.get_zorder() <= above.get_zorder()


def test_the_scan_is_drawn_below_each_map_even_an_empty_one():
    for ax in plotting.draw_maps({"measured": [], "found": THREE}, scan=SCAN):
        np.testing.assert_allclose(np.column_stack(ax.lines[0].get_data()), SCAN.points())
        assert ax.lines[0].get_color() == plotting.RAW and len(ax.patches) == 1


def test_columns_fold_the_row_and_leave_no_empty_axes():
    row = plotting.draw_maps(dict.fromkeys("abc", THREE), columns=2)
    assert len(row) == 3 and len(row[0].figure.axes) == 3
    middles = [ax.get_position().y0 for ax in row]
    assert middles[0] == pytest.approx(middles[1]) and middles[2] < middles[0]


def test_colours_that_do_not_fit_are_counted():
    with pytest.raises(ValueError, match="color must have 1 entries, one a map, got 2"):
        plotting.draw_maps({"all": THREE}, color=[plotting.MAP, plotting.RESULT])
