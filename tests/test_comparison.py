"""Methods at equal quality, time against scans, and their pictures and tables."""

from itertools import pairwise
from math import isnan, radians

import matplotlib
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from segmap import METHODS, SegmentMap, readers
from segmap._display import Table
from segmap.experiments import (
    Pace,
    Record,
    _online,
    equal_quality,
    front,
    pareto,
    reduction_at,
)
from segmap.plotting import METHOD_STYLES, draw_curves, draw_online


def record(method, quality, reduction, *, map="hall", filtered=None):
    return Record(map, method, {"t": quality}, filtered, 100, 50, reduction, quality, 0.1)


FUSION = [record("fusion", 0.9, 0.4), record("fusion", 0.8, 0.6), record("fusion", 0.6, 0.7)]

# ------------------------------------------------------------------ at equal quality


def test_between_two_runs_the_value_lies_on_the_line():
    """Catches the nearest run, the mean of all, and a fit through all."""
    for quality, wanted in ((0.9, 0.4), (0.825, 0.55), (0.8, 0.6), (0.65, 0.675), (0.6, 0.7)):
        assert equal_quality(FUSION, quality)[0].reduction == pytest.approx(wanted)


def test_above_the_best_quality_there_is_no_value_but_a_reason():
    """Catches a curve that goes on where nobody has measured."""
    found = equal_quality(FUSION, 0.91)[0]
    assert isnan(found.reduction)
    assert found.reason == "no run of fusion reaches quality 0.91: its best is 0.9"
    assert equal_quality(FUSION, 0.9)[0].reason == ""


def test_below_the_lowest_quality_the_largest_reduction_counts():
    """A map that is better than asked for will do: its reduction has been reached."""
    assert equal_quality(FUSION, 0.1)[0].reduction == 0.7


def test_runs_that_are_beaten_do_not_pull_the_curve_down():
    """Catches a line through every run, in the order of its threshold."""
    bad = [record("fusion", 0.85, 0.1), record("fusion", 0.8, 0.3)]
    assert equal_quality(FUSION + bad, 0.85)[0].reduction == pytest.approx(0.5)
    assert equal_quality(bad[::-1] + FUSION, 0.85)[0].reduction == pytest.approx(0.5)


def test_filtered_and_unfiltered_runs_never_meet():
    """Catches the comparison that A 6.2.3 forbids: they are measured against different maps."""
    other = [record("fusion", 0.85, 0.99, filtered=0.10), record("hybrid", 0.9, 0.99, map="room")]
    found = equal_quality(FUSION + other, 0.85)
    values = {(s.map, s.filtered, s.method): s.reduction for s in found}
    assert values == {
        ("hall", None, "fusion"): pytest.approx(0.5),
        ("hall", 0.10, "fusion"): 0.99,
        ("room", None, "hybrid"): 0.99,
    }
    assert found.reduction("hall", "fusion", filtered=0.10) == 0.99
    assert found.ranking("room") == ["hybrid"]
    with pytest.raises(KeyError, match="no run of hybrid on hall"):
        found.reduction("hall", "hybrid")


def test_ranking_and_table():
    """Catches a method without a value that is ranked, and cells in the wrong row."""
    runs = [*FUSION, record("hybrid", 0.7, 0.9), record("basic", 0.9, 0.7)]
    runs += [record("basic", 0.9, 0.2, filtered=0.10)]
    found = equal_quality(runs, 0.85)
    assert found.ranking("hall") == ["basic", "fusion"]
    assert found.table().head == ("map", "filtered", "fusion", "hybrid", "basic")
    assert found.table().rows == (
        ("hall", "no", "50.0%", "-", "70.0%"),
        ("hall", "0.10 m", "-", "-", "20.0%"),
    )
    assert "<td" in found._repr_html_() and "50.0%" in repr(found)


@pytest.mark.parametrize("quality", [0.0, -0.1, 1.1, 85.0, np.nan])
def test_quality_is_a_share(quality):
    """Catches per cent."""
    with pytest.raises(ValueError, match="quality must be above 0 and at most 1"):
        equal_quality(FUSION, quality)


POINTS = st.lists(st.tuples(st.integers(0, 8), st.integers(0, 8)), min_size=1, max_size=20)


@given(POINTS)
def test_the_front_holds_what_nobody_beats(points):
    """Catches equal runs that beat each other, and ties that stay twice."""
    found = front(points).tolist()
    unbeaten = {
        p for p in points if not any(q != p and q[0] >= p[0] and q[1] >= p[1] for q in points)
    }
    assert found == sorted(map(list, unbeaten))
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in pairwise(found))


@given(POINTS)
def test_better_quality_never_reduces_more(points):
    """Catches an interpolation over points that are not in order."""
    values = [reduction_at(points, quality) for quality in np.linspace(0, 8, 33)]
    known = [value for value in values if not isnan(value)]
    assert known == sorted(known, reverse=True)
    assert values[0] == max(r for _, r in points)


def test_pareto_of_all_and_of_each_method():
    """Catches a record that beats others on another map, under a filter, or of another method."""
    runs = [
        record("fusion", 0.9, 0.4),
        record("fusion", 0.9, 0.3),
        record("hybrid", 0.8, 0.4),
        record("hybrid", 0.8, 0.4),
        record("hybrid", 0.2, 0.2, map="room"),
        record("hybrid", 0.3, 0.3, filtered=0.10),
    ]
    assert list(pareto(runs)) == [runs[0], *runs[4:]]
    assert list(pareto(runs, each_method=True)) == [runs[0], *runs[2:]]


# ------------------------------------------------------------------ time against scans


WALLS = SegmentMap(np.random.default_rng(0).uniform(0, 9, (50, 2, 2)), np.arange(50) // 5)


def test_pace_adds_up_and_ends_with_the_last_scan(tmp_path, monkeypatch):
    """Catches seconds of single scans taken for the total, and a last scan that is lost."""
    found = METHODS["basic_online"](WALLS)
    pace = Pace.of(found, {"distance": 0.2}, every=4)
    assert pace.scans.tolist() == [4, 8, 10] and pace.live[-1] == len(found)
    assert pace.seconds[-1] == pytest.approx(found.scan_seconds.sum())
    assert pace.seconds[0] == pytest.approx(found.scan_seconds[:4].sum())
    (tmp_path / "records" / "online").mkdir(parents=True)
    _online.write_pace([pace, Pace.of(found, {})], tmp_path / "records" / "online" / "hall.csv")
    monkeypatch.setattr(readers._bundled, "PLACES", (tmp_path,))
    back, all_scans = _online.load_pace("hall")
    assert back.thresholds == {"distance": 0.2} and len(all_scans.scans) == 10
    np.testing.assert_array_equal(back.live, pace.live)
    np.testing.assert_allclose(back.seconds, pace.seconds, atol=1e-6)
    with pytest.raises(ValueError, match="name must be of hall, got 'room'"):
        _online.load_pace("room")


def test_power_of_growth():
    """Catches a slope of the numbers instead of their logarithms, and a share that is ignored."""
    scans = np.arange(1, 101)
    assert Pace("x", {}, scans, 3.0 * scans**1.5, scans).growth() == pytest.approx(1.5)
    bent = np.where(scans < 50, scans, scans**2 / 50)
    assert Pace("x", {}, scans, bent, scans).growth(0.5) == pytest.approx(2.0)
    assert Pace("x", {}, scans, bent, scans).growth(0.25) == pytest.approx(1.5, abs=0.5)


def test_pace_is_for_on_line_methods():
    with pytest.raises(ValueError, match="must be of an on-line method, got Reduction"):
        Pace.of(METHODS["fusion"](WALLS), {})


# ------------------------------------------------------------------ pictures and tables


def axes():
    return Figure(figsize=(4, 3), dpi=50).subplots()


def test_curves_have_a_colour_for_each_method_everywhere():
    """Catches colours by position, which change with the methods that are drawn."""
    runs = [*FUSION, record("hybrid", 0.5, 0.5), record("mine", 0.3, 0.3)]
    ax = draw_curves(runs, ax=axes(), quality=0.85)
    ax.legend()
    colors = {line.get_label(): line.get_color() for line in ax.lines[1:]}
    assert colors["fusion"] == METHOD_STYLES["fusion"][0] and "mine" in colors
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["fusion", "hybrid", "mine"]
    curve = next(line for line in ax.lines if line.get_label() == "fusion")
    assert curve.get_xydata().tolist() == [[0.6, 0.7], [0.8, 0.6], [0.9, 0.4]]
    assert ax.get_xlabel() == "quality" and ax.get_ylabel() == "reduction"
    other = draw_curves(runs[3:], ax=axes())
    assert other.lines[1].get_color() == METHOD_STYLES["hybrid"][0]


@pytest.mark.parametrize(
    "other", [record("fusion", 0.5, 0.5, filtered=0.1), record("fusion", 0.5, 0.5, map="room")]
)
def test_curves_of_different_maps_are_refused(other):
    """Catches a picture that compares filtered runs with unfiltered ones."""
    with pytest.raises(ValueError, match="records must be of one map, filtered or not"):
        draw_curves([*FUSION, other], ax=axes())


def test_every_method_has_its_style_and_all_differ():
    assert set(METHOD_STYLES) >= set(METHODS)
    for column in zip(*list(METHOD_STYLES.values()), strict=True):
        assert len(set(column)) in (2, len(METHOD_STYLES))  # lines: whole or dashed


def test_online_times_begin_at_nothing_and_add_up():
    found = METHODS["basic_online"](WALLS)
    pace = Pace.of(found, {"distance": 0.2, "angle": radians(10)}, every=5)
    ax = draw_online([found, pace], ax=axes())
    first, second = ax.lines
    assert first.get_ydata()[0] == 0 and first.get_xdata()[-1] == 10
    assert first.get_ydata()[-1] == pytest.approx(found.scan_seconds.sum())
    assert second.get_label() == "basic_online: distance 0.2, angle 0.175"
    assert first.get_linestyle() != second.get_linestyle()
    assert ax.get_ylabel() == "total time [s]"


def test_without_axes_a_figure_is_made():
    with matplotlib.rc_context({"backend": "agg"}):
        assert draw_curves(FUSION).figure is not None


def test_the_table_of_methods_is_that_of_the_thesis():
    """A's table 2.16 for the methods that it implements, and A 7 for the one it only names."""
    rows = {row[0]: row[1:6] for row in METHODS.table().rows}
    ends = "end points"
    assert rows["basic_offline"] == ("A 4.1", "2 -> 1", "off-line", "segments", ends)
    assert rows["basic_online"] == ("A 4.1", "2 -> 1", "on-line", "segments", ends)
    assert rows["hybrid"][:4] == ("A 4.2", "2 -> 1", "on-line", "segments")
    assert "rho, theta" in rows["hybrid"][4] and "count" in rows["hybrid"][4]
    assert rows["fusion"] == ("A 4.4", "m -> 1", "off-line", "segments", ends)
    assert rows["hybrid_fusion"][0] == "A 7"
    assert rows["mean_shift"] == ("A 4.3", "m -> n", "off-line", "segments", ends)
    assert METHODS._repr_html_().count("<tr>") == 1 + len(METHODS)
    assert "0x" not in repr(METHODS)


def test_a_table_escapes_and_refuses_ragged_rows():
    assert "&lt;b&gt;" in Table(["<b>"], [["x"]])._repr_html_()
    with pytest.raises(ValueError, match="2 cells"):
        Table(["a", "b"], [["x"]])
    assert repr(Table(["a", "b"], [])) == "a  b"
