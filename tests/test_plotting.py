"""What is drawn: how many lines, where, in which colours, with which labels."""

import base64
import io
import json

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgba
from matplotlib.figure import Figure

import segmap
from segmap import plotting
from segmap.poses import transform
from segmap.reduction import Reduction
from segmap.scans import LaserScan, Log
from segmap.segments import SegmentMap

THREE = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(0, 0.02), (4, 0.02)]], float)
CROSS = np.array([[(0, 0), (4, 3)], [(0, 3), (4, 0)]], float)
SCAN = LaserScan([1.0, 2.0, np.inf, 9.0], np.radians([-90, 0, 45, 90]), max_range=8.0)
LOG = Log("two", [SCAN, SCAN], truth=[(1, 0, 0), (2, 0, np.pi / 2)])
REDUCTION = Reduction(THREE[:2], np.array([0, 1, 0]), 0.0, "by hand")


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
    plotting.figure_png(ax.figure)  # colours by value are known only then
    return [to_hex(c) for c in ax.collections[index].get_edgecolor()]


def dots_of(ax):
    return np.column_stack(ax.lines[0].get_data())


def pixels(png):
    return plt.imread(io.BytesIO(png))[..., :3]


DRAWINGS = {
    "scan": lambda ax: plotting.draw_scan(SCAN, ax=ax),
    "log": lambda ax: plotting.draw_log(LOG, ax=ax),
    "path": lambda ax: plotting.draw_path(LOG.truth, ax=ax),
    "segments": lambda ax: plotting.draw_segments(THREE, ax=ax),
    "before_after": lambda ax: plotting.draw_before_after(THREE, REDUCTION, ax=ax),
    "provenance": lambda ax: plotting.draw_provenance(THREE, REDUCTION, ax=ax),
}


@pytest.mark.parametrize("name", DRAWINGS)
def test_every_picture_has_equal_scales_and_axes_in_metres(name, ax):
    """Catches walls that look longer in x than in y, and axes without a unit."""
    assert DRAWINGS[name](ax) is ax
    assert ax.get_aspect() == 1 and (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")


@pytest.mark.parametrize("name", DRAWINGS)
def test_without_axes_a_new_figure_is_made_and_with_axes_none(name, ax):
    """Catches a drawing that lands in whatever figure is current."""
    DRAWINGS[name](ax)
    assert plt.get_fignums() == []
    current = plt.figure()
    drawn = DRAWINGS[name](None)
    assert len(plt.get_fignums()) == 2 and drawn.figure is not current
    assert drawn.figure.dpi == plotting.DPI


# ------------------------------------------------------------------- scans, logs
def test_a_scan_is_drawn_where_its_valid_beams_end(ax):
    """Catches readings at maximum range drawn as walls, and a pose that is left out."""
    pose = (1, 1, np.pi / 2)
    plotting.draw_scan(SCAN, pose, ax=ax)
    np.testing.assert_allclose(dots_of(ax), transform(pose, [(0, -1), (2, 0)]), atol=1e-12)
    assert ax.lines[0].get_color() == plotting.RAW


def test_the_robot_points_ahead(ax):
    plotting.draw_scan(SCAN, (5, 5, np.pi / 2), ax=ax)
    corners = ax.patches[0].get_xy()
    assert corners[np.argmax(corners[:, 1])] == pytest.approx((5, 5.15))


def test_beams_run_from_the_sensor_to_their_end_points(ax):
    """Catches beams drawn from the robot's turning point."""
    moved = LaserScan([1.0, np.nan], [0, 1], sensor_pose=(0.5, 0, 0))
    plotting.draw_scan(moved, (0, 2, 0), ax=ax, beams=True)
    np.testing.assert_allclose(lines_of(ax), [[(0.5, 2), (1.5, 2)]])


def test_a_log_is_drawn_at_its_truth_with_a_green_way(ax):
    plotting.draw_log(LOG, ax=ax)
    expected = np.concatenate([transform(p, SCAN.points()) for p in LOG.truth])
    np.testing.assert_allclose(dots_of(ax), expected, atol=1e-12)
    np.testing.assert_allclose(np.column_stack(ax.lines[1].get_data()), LOG.truth[:, :2])
    assert ax.lines[1].get_color() == plotting.TRUTH


def test_a_log_without_truth_is_drawn_at_its_odometry_in_red(ax):
    """Catches odometry that is passed off as truth."""
    raw = LaserScan([1.0], [0.0], odometry=(3, 4, 0))
    plotting.draw_log(Log("raw", [raw]), ax=ax)
    np.testing.assert_allclose(dots_of(ax), [(4, 4)])
    assert ax.lines[1].get_color() == plotting.ERROR


def test_given_poses_are_results_and_scans_without_a_pose_are_left_out(ax):
    plotting.draw_log(LOG, [(0, 0, 0), (np.nan, np.nan, np.nan)], ax=ax)
    assert len(dots_of(ax)) == 2
    assert ax.lines[1].get_color() == plotting.RESULT


def test_a_log_with_no_pose_at_all_draws_nothing(ax):
    plotting.draw_log(Log("blind", [SCAN]), ax=ax)
    assert len(dots_of(ax)) == 0


def test_a_long_log_is_thinned_evenly(ax):
    """Catches a picture of the first scans only."""
    many = LaserScan(np.linspace(1, 2, 50_000), np.zeros(50_000))
    plotting.draw_log(Log("long", [many] * 3, truth=np.zeros((3, 3))), ax=ax)
    drawn = dots_of(ax)[:, 0]
    assert 40_000 < len(drawn) <= 60_000 and drawn[-1] > 1.99


def test_poses_of_another_log_are_refused(ax):
    with pytest.raises(ValueError, match=r"poses must have shape \(2, 3\), one a scan"):
        plotting.draw_log(LOG, np.zeros((3, 3)), ax=ax)


def test_a_path_is_interrupted_where_it_is_unknown(ax):
    rows = np.array([(0, 0, 0), (np.nan,) * 3, (2, 1, 0)])
    plotting.draw_path(rows, ax=ax, label="truth")
    assert np.isnan(ax.lines[0].get_xdata()).tolist() == [False, True, False]
    assert ax.lines[0].get_label() == "truth"


# ----------------------------------------------------------------------- segments
def test_segments_are_drawn_as_one_collection_in_black(ax):
    """Catches a loop of plot calls, which takes a minute for a large map."""
    plotting.draw_segments(SegmentMap(THREE), ax=ax)
    assert len(ax.collections) == 1 and len(ax.lines) == 0
    np.testing.assert_array_equal(lines_of(ax), THREE)
    assert set(colors_of(ax)) == {plotting.MAP}


def test_the_limits_hold_all_segments(ax):
    """Catches a collection that does not count for the limits."""
    plotting.draw_segments(THREE + 100, ax=ax)
    (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
    assert 99 < x0 <= 100 and 104 <= x1 < 105 and 99 < y0 <= 100 and 103 <= y1 < 104


def test_groups_have_a_colour_each_in_turn_and_none_is_grey(ax):
    plotting.draw_segments(THREE, group=[1, -1, 1 + len(plotting.GROUPS)], ax=ax)
    assert colors_of(ax) == [plotting.GROUPS[1], plotting.RAW, plotting.GROUPS[1]]


def test_errors_run_from_grey_to_red_with_the_largest_on_top(ax):
    """Catches errors that are shown in one colour, and hidden under the many good segments."""
    plotting.draw_segments(THREE, error=[0.1, 0.0, 0.05], ax=ax)
    found = colors_of(ax)
    assert found[0] == to_hex(plotting.ERRORS(0.0)) and found[-1] == to_hex(plotting.ERRORS(1.0))
    np.testing.assert_array_equal(lines_of(ax), THREE[[1, 2, 0]])
    assert ax.collections[0].get_clim() == (0, 0.1)
    assert ax.figure.axes[1].get_ylabel() == "error [m]"


@pytest.mark.parametrize("errors", [[0, 0, 0], [1e-17, 0, 1e-16], [np.inf, np.inf, np.inf]])
def test_errors_that_are_none_or_infinite_keep_a_sensible_scale(errors, ax):
    """Catches rounding errors in dark red, and a scale that ends at infinity."""
    plotting.draw_segments(THREE, error=errors, ax=ax)
    assert ax.collections[0].get_clim() == (0, 1e-3)
    worst = plotting.ERRORS(1.0 if np.isinf(errors[0]) else 0.0)
    assert colors_of(ax)[-1] == to_hex(worst)


def test_scans_run_through_the_colours_with_a_scale(ax):
    plotting.draw_segments(THREE, scan=[0, 5, 10], ax=ax)
    assert len(set(colors_of(ax))) == 3
    assert ax.collections[0].get_clim() == (0, 10)
    assert ax.figure.axes[1].get_ylabel() == "scan"


@pytest.mark.parametrize("options", [{}, dict(group=[]), dict(error=[]), dict(scan=[])])
def test_an_empty_map_is_an_empty_picture(options, ax):
    plotting.draw_segments([], ax=ax, **options)
    assert len(ax.collections[0].get_segments()) == 0
    assert plotting.figure_png(ax.figure)[:4] == b"\x89PNG"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (dict(group=[0, 1]), r"group must have shape \(3,\), one value a segment, got \(2,\)"),
        (dict(error=0.1), r"error must have shape \(3,\)"),
        (dict(scan=[0, 1, 2], group=[0, 1, 2]), "only one of scan, group, error, got scan and"),
    ],
)
def test_columns_that_do_not_fit_are_named(options, message, ax):
    with pytest.raises(ValueError, match=message):
        plotting.draw_segments(THREE, ax=ax, **options)


def test_before_is_black_over_a_thick_blue_after_and_both_are_counted(ax):
    """Catches the roles exchanged: the reduced map is the blue one."""
    plotting.draw_before_after(SegmentMap(THREE), REDUCTION, ax=ax)
    assert [len(lines_of(ax, k)) for k in (0, 1)] == [2, 3]
    assert set(colors_of(ax, 0)) == {plotting.RESULT} and set(colors_of(ax, 1)) == {plotting.MAP}
    assert ax.collections[0].get_linewidth()[0] > ax.collections[1].get_linewidth()[0]
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert texts == ["after: 2 segments", "before: 3 segments"]


def test_each_output_shares_its_colour_with_the_inputs_that_made_it(ax):
    """Catches colours by input index, and a dropped input with the colour of the last output."""
    before = np.concatenate([THREE, [[(9, 9), (9, 9)]]])
    reduction = Reduction(THREE[:2], np.array([1, 0, 1, -1]), 0.0)
    plotting.draw_provenance(before, reduction, ax=ax)
    outputs, inputs = (colors_of(ax, k) for k in (0, 1))
    assert outputs == list(plotting.GROUPS[:2])
    assert inputs == [outputs[1], outputs[0], outputs[1], plotting.RAW]


def test_a_reduction_of_another_map_is_refused(ax):
    with pytest.raises(ValueError, match=r"reduction.parents must have shape \(2,\)"):
        plotting.draw_provenance(THREE[:2], REDUCTION, ax=ax)


# ------------------------------------------------------------------------ colours
def seen_without(cones, colors):
    """sRGB colours as the colour-blind see them (Machado, Oliveira, Fernandes 2009)."""
    light = np.array([to_rgba(color)[:3] for color in colors])
    linear = np.where(light <= 0.04045, light / 12.92, ((light + 0.055) / 1.055) ** 2.4)
    mixed = np.clip(linear @ np.transpose(cones), 0, 1)
    return np.where(mixed <= 0.0031308, 12.92 * mixed, 1.055 * mixed ** (1 / 2.4) - 0.055)


@pytest.mark.parametrize(
    "cones",
    [
        np.eye(3),
        [
            (0.367322, 0.860646, -0.227968),
            (0.280085, 0.672501, 0.047413),
            (-0.01182, 0.04294, 0.968881),
        ],
        [
            (0.152286, 1.052583, -0.204868),
            (0.114503, 0.786281, 0.099216),
            (-0.003882, -0.048116, 1.051998),
        ],
    ],
    ids=["all", "no green", "no red"],
)
def test_the_colours_with_a_meaning_can_be_told_apart(cones):
    """Catches grey dots with a green way of the same lightness: one reader in twelve loses it."""
    named = (plotting.RAW, plotting.MAP, plotting.RESULT, plotting.TRUTH, plotting.ERROR)
    seen = seen_without(cones, named)
    gaps = np.linalg.norm(seen[:, None] - seen, axis=-1)
    assert gaps[np.triu_indices(len(named), 1)].min() > 0.25


# ------------------------------------------------------------------- as bytes
@pytest.mark.parametrize(
    ("value", "color"),
    [(SCAN, plotting.ERROR), (LOG, plotting.TRUTH), (SegmentMap(CROSS), plotting.MAP)]
    + [(Reduction(CROSS, np.array([0, 1]), 0.0), plotting.RESULT)],
)
def test_a_thumbnail_is_a_small_png_that_shows_the_thing_in_its_colour(value, color):
    """Catches a picture that is empty. Of a scan the robot is looked for."""
    png = plotting.thumbnail(value)
    picture = pixels(png)
    assert picture.shape == (240, 320, 3) and len(png) < 30_000
    middle = picture[20:200, 70:250] if color != plotting.MAP else picture[80:150, 130:210]
    assert (np.linalg.norm(middle - to_rgba(color)[:3], axis=-1) < 0.3).sum() >= 10
    assert plt.get_fignums() == []


@pytest.mark.parametrize("value", [SegmentMap([]), Log("no", []), LaserScan([], [])])
def test_even_nothing_has_a_thumbnail(value):
    assert pixels(plotting.thumbnail(value)).shape == (240, 320, 3)


def test_the_thumbnail_of_a_log_without_poses_shows_its_first_scan():
    """Catches empty axes for Hokuyo text, which knows neither odometry nor truth."""
    bare = LaserScan([1.0, 2.0, 1.5], [0.0, 0.5, 1.0])
    assert plotting.thumbnail(Log("bare", [bare, bare])) == plotting.thumbnail(bare)


@pytest.mark.parametrize("value", [SCAN, LOG, SegmentMap(THREE), REDUCTION])
def test_a_notebook_gets_text_and_a_picture_as_base64(value):
    """Catches bytes, which a notebook file cannot hold."""
    bundle = json.loads(json.dumps(value._repr_mimebundle_()))
    assert bundle["text/plain"] == repr(value)
    assert base64.b64decode(bundle["image/png"]) == plotting.thumbnail(value)


def test_the_same_drawing_gives_the_same_bytes_and_names_no_version():
    first, again = (plotting.thumbnail(SegmentMap(THREE)) for _ in range(2))
    assert first == again and b"atplotlib" not in first


def test_a_figure_becomes_a_png_without_leaving_its_canvas():
    """Catches a figure of pyplot that can no longer be shown."""
    figure, _ = plt.subplots(figsize=(2, 1), dpi=30)
    canvas = figure.canvas
    assert pixels(plotting.figure_png(figure)).shape == (30, 60, 3)
    assert figure.canvas is canvas


@pytest.mark.parametrize("name", ["room", "malaga"])
def test_a_real_map_fits_into_a_small_picture(name):
    """Catches pictures of megabytes in the chapters."""
    log = segmap.load(name)[::4]
    map = segmap.build_map(log, log.truth)
    ax = plotting.draw_before_after(map, segmap.fusion(map))
    assert 3_000 < len(plotting.figure_png(ax.figure)) < 40_000
