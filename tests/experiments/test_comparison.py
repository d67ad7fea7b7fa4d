"""Methods at equal quality, time against scans, and their pictures and tables."""

from itertools import pairwise
from math import isnan

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure
from segmap_course.literal import comparing

from segmap import METHODS
from segmap.experiments import (
    equal_quality,
    front,
    growth,
    pareto,
    reduction_at,
)
from segmap.plotting import draw_curves


def runs(*rows):
    """Runs on the hall, unfiltered, from method, quality and reduction (and map, filtered)."""
    whole = [(*row, "hall", 0.0)[:5] if len(row) == 3 else row for row in rows]
    return pd.DataFrame(whole, columns=["method", "quality", "reduction", "map", "filtered"])


FUSION = [("fusion", 0.9, 0.4), ("fusion", 0.8, 0.6), ("fusion", 0.6, 0.7)]

# ------------------------------------------------------------------ at equal quality


@pytest.mark.parametrize(
    ("quality", "wanted"),
    [(0.9, 0.4), (0.825, 0.55), (0.8, 0.6), (0.65, 0.675), (0.6, 0.7), (0.1, 0.7), (0.91, np.nan)],
)
def test_the_value_lies_on_lines_along_the_runs_that_none_beats(quality, wanted):
    """Catches the nearest run, fits through all, and a curve that goes on above all runs.

    Below all runs the largest reduction counts: a map that is better than asked for will do.
    """
    bad = [("fusion", 0.85, 0.1), ("fusion", 0.8, 0.3)]
    for order in (FUSION, bad + FUSION, FUSION[::-1] + bad):
        found = equal_quality(runs(*order), quality)
        assert found["fusion"].item() == pytest.approx(wanted, nan_ok=True)
        reason = "fusion reaches 0.9 at most" if quality > 0.9 else ""
        assert found["reason"].item() == reason


def test_filtered_and_unfiltered_runs_never_meet():
    """Catches the comparison that A 6.2.3 forbids: they are measured against different maps."""
    other = [("fusion", 0.85, 0.99, "hall", 0.10), ("hybrid", 0.9, 0.99, "room", 0.0)]
    found = equal_quality(runs(*FUSION, *other), 0.85)
    assert list(found) == ["map", "filtered", "fusion", "hybrid", "reason"]
    assert list(found["map"]) == ["hall", "hall", "room"] and list(found["filtered"]) == [0, 0.1, 0]
    np.testing.assert_allclose(found["fusion"], [0.5, 0.99, np.nan])
    np.testing.assert_allclose(found["hybrid"], [np.nan, np.nan, 0.99])


def test_runs_on_an_empty_map_are_on_no_curve():
    """Catches a quality of NaN that nothing beats, and that stands on the front."""
    empty = [("fusion", np.nan, 0.0, "yard", 0.0), ("hybrid", np.nan, 0.0, "hall", 0.0)]
    frame = runs(*FUSION, *empty)
    found = equal_quality(frame, 0.85).set_index("map")
    assert found.loc["hall", "fusion"] == pytest.approx(0.5)
    assert found.loc["hall", "reason"] == "hybrid has no quality, its map is empty"
    assert np.isnan(found.loc["yard", "fusion"])
    assert pareto(frame)["quality"].notna().all()
    assert len(front([(np.nan, 0.0), (0.5, 0.5)])) == 1


@given(st.lists(st.tuples(st.integers(0, 8), st.integers(0, 8)), min_size=1, max_size=20))
def test_the_front_holds_what_nobody_beats_and_better_quality_never_reduces_more(points):
    """Catches equal runs that beat each other, ties that stay twice, points out of order."""
    found = front(points).tolist()
    assert comparing.front(points) == [tuple(run) for run in found]
    beaten = {p for p in points for q in points if q != p and q[0] >= p[0] and q[1] >= p[1]}
    assert found == sorted(map(list, set(points) - beaten))
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in pairwise(found))
    values = [reduction_at(points, quality) for quality in np.linspace(0, 8, 33)]
    plain = [comparing.reduction_at(points, quality) for quality in np.linspace(0, 8, 33)]
    np.testing.assert_allclose(plain, values, rtol=1e-9)
    known = [value for value in values if not isnan(value)]
    assert known == sorted(known, reverse=True) and values[0] == max(r for _, r in points)


def test_pareto_of_all_and_of_each_method():
    """Catches a run that beats others on another map, under a filter, or of another method."""
    frame = runs(
        ("fusion", 0.9, 0.4),
        ("fusion", 0.9, 0.3),
        ("hybrid", 0.8, 0.4),
        ("hybrid", 0.8, 0.4),
        ("hybrid", 0.2, 0.2, "room", 0.0),
        ("hybrid", 0.3, 0.3, "hall", 0.10),
    )
    frame.index = [3, 3, 7, 1, 0, 5]  # as after a concatenation
    assert pareto(frame).equals(frame.iloc[[0, 4, 5]])
    assert pareto(frame, each_method=True).equals(frame.iloc[[0, 2, 3, 4, 5]])


# ------------------------------------------------------------------ time against scans


def test_power_of_growth():
    """Catches a slope of the numbers instead of their logarithms, and a share that is ignored."""
    scans = np.arange(1, 101)
    whole = pd.DataFrame({"scans": scans, "seconds": 3.0 * scans**1.5})
    bent = whole.assign(seconds=np.where(scans < 50, scans, scans**2 / 50))
    assert growth(whole) == pytest.approx(1.5)
    assert growth(bent, after=0.5) == pytest.approx(2.0)
    assert growth(bent) == pytest.approx(1.5, abs=0.4)


# ------------------------------------------------------------------ pictures and tables


def axes():
    return Figure(figsize=(4, 3), dpi=50).subplots()


def test_curves_have_a_colour_for_each_method_everywhere():
    """Catches colours by position, which change with the methods that are drawn."""
    frame = runs(*FUSION, ("hybrid", 0.5, 0.5), ("mine", 0.3, 0.3))
    ax = draw_curves(frame, ax=axes(), quality=0.85)
    ax.legend()
    lines = {line.get_label(): line for line in ax.lines[1:]}
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["fusion", "hybrid", "mine"]
    assert lines["fusion"].get_xydata().tolist() == [[0.6, 0.7], [0.8, 0.6], [0.9, 0.4]]
    assert ax.get_xlabel() == "quality" and ax.get_ylabel() == "reduction"
    other = draw_curves(frame[3:], ax=axes())
    assert other.lines[1].get_color() == lines["hybrid"].get_color()
    every = draw_curves(runs(*((name, 0.5, 0.5) for name in METHODS)), ax=axes()).lines[1:]
    for looks in ([line.get_color() for line in every], [line.get_marker() for line in every]):
        assert len({*looks}) == len(METHODS)
    for where in (("hall", 0.1), ("room", 0.0)):
        with pytest.raises(ValueError, match="frame must hold runs on one map, with one filter"):
            draw_curves(runs(*FUSION, ("fusion", 0.5, 0.5, *where)), ax=axes())
