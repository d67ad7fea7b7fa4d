"""What is drawn of reductions, of the steps of their methods and of runs on several buildings."""

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from segmap import course, plotting
from segmap.experiments import Record, Records, filter_change, thesis_results
from segmap.reduction import fusion, hough, hybrid
from segmap.segments import SegmentMap

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


def segments_of(ax, index):
    return np.array(ax.collections[index].get_segments())


def color_of(collection):
    return to_hex(collection.get_edgecolor()[0])


def run(map, method, quality, seconds=1.0, filtered=None, **thresholds):
    return Record(map, method, thresholds, filtered, 100, 50, 0.5, quality, seconds)


# ------------------------------------------------------------------ maps and results


def test_before_is_left_and_black_after_right_and_blue_at_one_scale():
    """Catches the two exchanged, and maps that look alike because each has its own limits."""
    left, right = plotting.draw_side_by_side(WALLS, WALLS[:1])
    np.testing.assert_array_equal(segments_of(left, 0), WALLS)
    np.testing.assert_array_equal(segments_of(right, 0), WALLS[:1])
    assert [color_of(ax.collections[0]) for ax in (left, right)] == [plotting.MAP, plotting.RESULT]
    assert left.get_title() == "Before: 3 segments" and right.get_title() == "After: 1"
    assert left.get_ylim() == right.get_ylim() and right.get_ylim()[1] >= 3
    assert left.figure.dpi == plotting.DPI


def test_each_case_is_reduced_by_itself_and_lies_over_what_is_left():
    """Catches a title with the map of another case, and inputs hidden under the thick result."""
    cases = {"two": WALLS[:2], "one": WALLS[2:]}
    first, second = course.draw_cases(cases, lambda map: map[:1] + 5)
    for ax, (title, map) in zip((first, second), cases.items(), strict=True):
        assert ax.get_title() == title and ax.get_aspect() == "auto"
        np.testing.assert_array_equal(segments_of(ax, 0), map[:1] + 5)
        np.testing.assert_array_equal(segments_of(ax, 1), map)
        assert [color_of(c) for c in ax.collections] == [plotting.RESULT, plotting.MAP]
    low, high = second.get_ylim()
    assert first.get_ylim() == (low, high) and low <= 0 and high >= 8


def test_marked_segments_lie_over_the_rest_and_all_are_drawn(ax):
    """Catches a mask that is turned round."""
    course.draw_marked(WALLS, [False, True, False], ax=ax)
    np.testing.assert_array_equal(segments_of(ax, 0), WALLS[[0, 2]])
    np.testing.assert_array_equal(segments_of(ax, 1), WALLS[[1]])
    assert [color_of(c) for c in ax.collections] == [plotting.RAW, plotting.ERROR]
    rest, marked = (c.get_linewidth()[0] for c in ax.collections)
    assert marked > rest


@pytest.mark.parametrize("marked", [[True], [0, 1]])
def test_marks_that_do_not_fit_are_refused(marked, ax):
    """Catches indices where a mark for each segment is wanted."""
    with pytest.raises(ValueError, match=r"marked must have shape \(3,\)"):
        course.draw_marked(WALLS, marked, ax=ax)


def test_growth_counts_what_was_seen_up_to_each_scan(ax):
    """Catches counts of single scans, and the first scan drawn at 0."""
    course.draw_growth(SEEN, hybrid(SEEN), ax=ax)
    seen, live = ax.lines
    assert seen.get_xdata().tolist() == [1, 2, 3] and seen.get_ydata().tolist() == [2, 3, 4]
    assert live.get_ydata().tolist() == [1, 2, 2] and live.get_color() == plotting.RESULT


@pytest.mark.parametrize("reduction", [fusion(SEEN), hybrid(SEEN.segments)])
def test_growth_needs_an_on_line_method_and_the_same_scans(reduction, ax):
    """Catches a curve of another drive, cut to the same length."""
    with pytest.raises(ValueError, match="must be an on-line one of these 3 scans"):
        course.draw_growth(SEEN, reduction, ax=ax)


def test_a_trade_shows_reduction_blue_and_quality_red(ax):
    course.draw_trade_off([1, 2, 3], [0.1, 0.2, 0.3], [0.9, 0.8, 0.7], ax=ax)
    drawn = {line.get_label(): line for line in ax.lines}
    assert drawn["quality"].get_xydata().tolist() == [[1, 0.9], [2, 0.8], [3, 0.7]]
    assert drawn["reduction"].get_ydata().tolist() == [0.1, 0.2, 0.3]
    colors = drawn["reduction"].get_color(), drawn["quality"].get_color()
    assert colors == (plotting.RESULT, plotting.ERROR) and ax.get_legend() is not None


# ------------------------------------------------------------------ steps of methods


def test_ends_fall_at_right_angles_on_the_line_of_the_merged_wall(ax):
    """Catches feet that are cut off at the ends of the wall."""
    wall = np.array([(0, 0), (2, 1)])
    course.draw_merge([[(-1, 1), (3, 3)]], wall, ax=ax)
    dotted = segments_of(ax, 0)
    np.testing.assert_array_equal(dotted[:, 0], [(-1, 1), (3, 3)])
    assert np.allclose((dotted[:, 1] - dotted[:, 0]) @ (2, 1), 0)
    np.testing.assert_allclose(dotted[:, 1], [(-0.4, -0.2), (3.6, 1.8)], atol=1e-12)
    assert [color_of(c) for c in ax.collections[1:]] == [plotting.RESULT, plotting.MAP]


def test_a_strip_holds_what_lies_in_it_with_both_ends_up_to_its_border(ax):
    """Catches a shift with the wrong sign, one end that is enough, and < for <=."""
    walls = np.array([[(0, y), (1, z)] for y, z in ((0, 0), (0.03, 0.07), (0.06, 0.06))])
    course.draw_strip(walls, 0.02, 0.04, ax=ax)
    np.testing.assert_array_equal(segments_of(ax, 0), walls[[0, 2]])
    np.testing.assert_array_equal(segments_of(ax, 1), walls[[1]])
    assert [color_of(c) for c in ax.collections] == [plotting.MAP, plotting.ERROR]
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
    assert found == [plotting.GROUPS[k] for k in (0, 0, 1)]


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
    assert [line.get_color() for line in normals] == list(plotting.GROUPS[:2])
    assert [to_hex(c) for c in ax.collections[0].get_edgecolor()] == list(plotting.GROUPS[:2])


# ------------------------------------------------------------------ runs on buildings


def test_a_row_for_each_group_and_a_picture_for_each_of_its_buildings():
    """Catches filtered runs among the others, and a legend that names no method."""
    runs = thesis_results()
    axes = course.draw_buildings(runs, runs, filtered=True)
    assert [len(row) for row in axes] == [4, 4] and axes[1][3].get_title() == "usc"
    drawn = axes[0][0].lines[0].get_xydata()
    chosen = runs.select(map="polimi", filtered=True, method="basic_offline")
    np.testing.assert_allclose(drawn, [(r.quality, r.reduction) for r in chosen])
    names = [text.get_text() for text in axes[0][0].figure.legends[0].get_texts()]
    assert "mean_shift" in names and axes[0][0].get_xlim() == axes[1][3].get_xlim()


def test_quality_against_a_threshold_in_millimetres_without_filtered_runs(ax):
    """Catches metres, a line through filtered runs, and the groups in each other's colours."""
    mine = Records([run("hall", "fusion", q, tolerance=t) for q, t in ((0.9, 0.02), (0.8, 0.04))])
    other = Records([run("room", "fusion", 0.7, tolerance=0.02)])
    noise = Records([*mine, run("hall", "fusion", 0.1, filtered=0.1, tolerance=0.02)])
    course.draw_threshold(other, noise, method="fusion", ax=ax)
    assert [line.get_xydata().tolist() for line in ax.lines] == [
        [[20, 0.7]],
        [[20, 0.9], [40, 0.8]],
    ]
    assert [line.get_color() for line in ax.lines] == [plotting.RAW, plotting.RESULT]
    assert [text.get_text() for text in ax.texts] == ["R", "H"]
    assert ax.get_xlabel() == "tolerance [mm]"


def test_letters_of_lines_that_end_together_do_not_cover_each_other(ax):
    """Catches eight letters on one heap."""
    runs = [run(name, "fusion", 0.5, tolerance=0.04) for name in ("ash", "box", "cot")]
    runs += [run("den", "fusion", 0.9, tolerance=0.04)]
    course.draw_threshold(Records(runs), method="fusion", ax=ax)
    places = {text.get_text(): text.xy[1] for text in ax.texts}
    low, high = ax.get_ylim()
    assert np.diff(sorted(places.values())).min() >= 0.05 * (high - low)
    assert places["D"] == 0.9 and places["A"] < places["B"] < places["C"]
    assert np.mean([places[k] for k in "ABC"]) == pytest.approx(0.5)


@pytest.mark.parametrize("method", ["hybrid", "nothing"])
def test_runs_at_several_angles_make_no_line(method, ax):
    """Catches a line that goes back and forth between two angles."""
    with pytest.raises(ValueError, match=f"method must be run over one length, {method} is over"):
        course.draw_threshold(thesis_results(), method=method, ax=ax)


def test_a_threshold_that_stays_the_same_does_not_count(ax):
    """Catches mean shift refused because its records name the bandwidth."""
    runs = [run("hall", "mean_shift", 0.5, sigma=s, bandwidth=0.9) for s in (0.1, 0.2)]
    course.draw_threshold(Records(runs), method="mean_shift", ax=ax)
    assert ax.lines[0].get_xdata().tolist() == [100, 200] and ax.get_xlabel() == "sigma [mm]"


def test_times_are_of_tight_angles_and_filtered_ones_are_dotted(ax):
    """Catches loose angles in the same line, and shares that are not of the loosest."""
    runs = [
        run("hall", "hybrid", 0.9, seconds, filtered, distance=d, angle=angle)
        for seconds, filtered, d, angle in (
            *((1, None, 0.1, 0.17), (2, None, 0.4, 0.17), (9, None, 0.4, 0.35)),
            *((3, 0.1, 0.1, 0.17), (4, 0.1, 0.4, 0.17)),
        )
    ]
    course.draw_times(Records(runs), ax=ax)
    whole, dotted = ax.lines
    assert whole.get_xydata().tolist() == [[0.25, 1], [1, 2]] and whole.get_label() == "hybrid"
    assert dotted.get_ydata().tolist() == [3, 4] and dotted.get_linestyle() == ":"
    assert ax.get_yscale() == "log" and whole.get_color() == plotting.METHOD_STYLES["hybrid"][0]


def test_the_filter_changes_quality_and_reduction_in_points(ax):
    """Catches rates in place of points, and the axes exchanged."""
    runs = thesis_results()
    course.draw_filter(runs, methods=["fusion", "hybrid"], ax=ax)
    expected = [filter_change(runs.select(map=n), "hybrid") for n in ("polimi", "stanford")]
    np.testing.assert_allclose(ax.lines[1].get_xydata()[:2], 100 * np.array(expected))
    assert ax.lines[1].get_label() == "hybrid"


def test_initials_stand_beside_their_dots(ax):
    course.draw_initials({"hall": (1, 2), "room": (3, 4)}, ax=ax, color=plotting.MAP)
    assert [line.get_xydata().tolist() for line in ax.lines] == [[[1, 2]], [[3, 4]]]
    assert {text.get_text(): text.xy for text in ax.texts} == {"H": (1, 2), "R": (3, 4)}
    assert {line.get_color() for line in ax.lines} == {plotting.MAP}


ALONE = {
    "marked": lambda: course.draw_marked(WALLS, [True] * 3),
    "growth": lambda: course.draw_growth(SEEN, hybrid(SEEN)),
    "trade": lambda: course.draw_trade_off([1], [0.5], [0.5]),
    "merge": lambda: course.draw_merge(WALLS[:1], WALLS[1]),
    "strip": lambda: course.draw_strip(WALLS, 0.0, 0.1),
    "centres": lambda: course.draw_centres(np.zeros((2, 1, 2)), [0]),
    "normals": lambda: course.draw_normals(WALLS),
    "times": lambda: course.draw_times(thesis_results().select(map="usc")),
    "initials": lambda: course.draw_initials({"hall": (1, 2)}),
}


@pytest.mark.parametrize("name", ALONE)
def test_without_axes_a_new_figure_is_made(name):
    """Catches a drawing that lands in whatever figure is current."""
    current = plt.figure()
    drawn = ALONE[name]().figure
    assert drawn is not current and len(plt.get_fignums()) == 2 and drawn.dpi == plotting.DPI
