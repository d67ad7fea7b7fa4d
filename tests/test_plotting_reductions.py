"""What is drawn of runs on several buildings."""

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from segmap import course, plotting
from segmap.course import filter_change, thesis_results
from segmap.experiments import select
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


def run(map, method, quality, seconds=1.0, filtered=0.0, **thresholds):
    row = {"map": map, "method": method, "filtered": filtered, "seconds": seconds}
    return pd.DataFrame([{**row, "quality": quality, "reduction": 0.5, **thresholds}])


# ------------------------------------------------------------------ runs on buildings


def test_a_row_for_each_group_and_a_picture_for_each_of_its_buildings():
    """Catches filtered runs among the others, and a legend that names no method."""
    runs = thesis_results()
    axes = course.draw_buildings(runs, runs, filtered=True)
    assert [len(row) for row in axes] == [4, 4] and axes[1][3].get_title() == "usc"
    drawn = axes[0][0].lines[0].get_xydata()
    chosen = select(runs, map="polimi", filtered=True, method="basic_offline")
    np.testing.assert_allclose(drawn, chosen[["quality", "reduction"]])
    names = [text.get_text() for text in axes[0][0].figure.legends[0].get_texts()]
    assert "mean_shift" in names and axes[0][0].get_xlim() == axes[1][3].get_xlim()


def test_quality_against_a_threshold_in_millimetres_without_filtered_runs(ax):
    """Catches metres, a line through filtered runs, and the groups in each other's colours."""
    mine = [run("hall", "fusion", q, tolerance=t) for q, t in ((0.9, 0.02), (0.8, 0.04))]
    other = run("room", "fusion", 0.7, tolerance=0.02)
    noise = pd.concat([*mine, run("hall", "fusion", 0.1, filtered=0.1, tolerance=0.02)])
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
    course.draw_threshold(pd.concat(runs), method="fusion", ax=ax)
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
    course.draw_threshold(pd.concat(runs), method="mean_shift", ax=ax)
    assert ax.lines[0].get_xdata().tolist() == [100, 200] and ax.get_xlabel() == "sigma [mm]"


def test_times_are_of_tight_angles_and_filtered_ones_are_dotted(ax):
    """Catches loose angles in the same line, and shares that are not of the loosest."""
    runs = [
        run("hall", "hybrid", 0.9, seconds, filtered, distance=d, angle=angle)
        for seconds, filtered, d, angle in (
            *((1, 0, 0.1, 0.17), (2, 0, 0.4, 0.17), (9, 0, 0.4, 0.35)),
            *((3, 0.1, 0.1, 0.17), (4, 0.1, 0.4, 0.17)),
        )
    ]
    course.draw_times(pd.concat(runs), ax=ax)
    whole, dotted = ax.lines
    assert whole.get_xydata().tolist() == [[0.25, 1], [1, 2]] and whole.get_label() == "hybrid"
    assert dotted.get_ydata().tolist() == [3, 4] and dotted.get_linestyle() == ":"
    assert ax.get_yscale() == "log" and whole.get_color() == plotting.METHOD_STYLES["hybrid"][0]


def test_the_filter_changes_quality_and_reduction_in_points(ax):
    """Catches rates in place of points, and the axes exchanged."""
    runs = thesis_results()
    course.draw_filter(runs, methods=["fusion", "hybrid"], ax=ax)
    expected = [filter_change(select(runs, map=n), "hybrid") for n in ("polimi", "stanford")]
    np.testing.assert_allclose(ax.lines[1].get_xydata()[:2], 100 * np.array(expected))
    assert ax.lines[1].get_label() == "hybrid"


def test_initials_stand_beside_their_dots(ax):
    course.draw_initials({"hall": (1, 2), "room": (3, 4)}, ax=ax, color=plotting.MAP)
    assert [line.get_xydata().tolist() for line in ax.lines] == [[[1, 2]], [[3, 4]]]
    assert {text.get_text(): text.xy for text in ax.texts} == {"H": (1, 2), "R": (3, 4)}
    assert {line.get_color() for line in ax.lines} == {plotting.MAP}
