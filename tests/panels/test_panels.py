"""Panels for any log, without a kernel; lesson panels are tested beside the course."""

import ipywidgets as W
import numpy as np
import pytest
from driven_panels import LEANING, RUNS, WALLS, press, unpainted, view_of
from matplotlib.figure import Figure
from segmap_course import HybridPanel, SectorPanel

from segmap import SegmentMap
from segmap.panels import ComparePanel, Panel, slider, text


def test_boxes_and_rows_of_buttons_are_as_wide_as_they_need():
    """Catches names of one panel that do not stand alike, and a box that is pushed aside."""
    box, way = W.Checkbox(description="x"), W.ToggleButtons(description="way")
    moved, longer = slider("a", 1, 0, 2, 1), W.Dropdown(description="some name of more letters")
    button = W.Button(description="b" * 60)

    class Named(Panel):
        """Has controls of each kind."""

        def __init__(self):
            self._assemble((moved, button, box, way, longer, text()))

        def _draw(self, figure: Figure) -> None:
            figure.subplots()

    Named()
    assert {p.style.description_width for p in (moved, way, longer)} == {"26ch"}
    assert moved.layout.width == longer.layout.width == "calc(26ch + 250px)"
    assert (way.layout.width, button.layout.width) == (None, None)
    assert (box.indent, box.layout.width, box.layout.margin) == (False, "auto", "2px 16px 2px 2px")


class Counter(Panel):
    """Counts its drawings."""

    def __init__(self):
        self.drawn = 0
        self.position, self.label = slider("position", 1, 0, 9, 1, ""), text()
        self._assemble((self.position, self.label))

    def _draw(self, figure: Figure) -> None:
        self.drawn += 1
        figure.subplots().set_aspect(1)
        self.label.value = str(self.position.value)


def test_one_move_is_one_drawing():
    """Catches a panel that redraws when its own texts change, or twice a move."""
    panel = Counter()
    panel.position.value = 4
    assert panel.drawn == 2 and panel.label.value == "4"
    panel.position.value = 4
    assert panel.drawn == 2


def test_reset_goes_back_to_what_was_shown_first_and_draws_once(figures):
    """Catches a panel left as a chapter's cell drove it, and one that forgets its first setting."""
    panel = Counter()
    panel.position.value = 4  # as chapter 09 does before it shows its panel
    panel._repr_mimebundle_()
    panel.position.value = 7
    press(view_of(panel), "++++")
    assert np.ptp(figures[-1].axes[0].get_xlim()) < 0.5
    panel._repr_mimebundle_()
    before = panel.drawn
    panel.reset()
    assert panel.position.value == 4 == int(panel.label.value) and panel.drawn == before + 1
    assert figures[-1].axes[0].get_xlim() == (0, 1)
    panel.position.value = 5
    assert panel.label.value == "5"


def test_a_play_button_begins_where_its_slider_is(monkeypatch):
    """Catches a link that starts with the button: in a browser the slider went to 0 by itself."""
    links = []
    monkeypatch.setattr(W, "jslink", lambda source, target: links.append((source, target)))
    panel = SectorPanel(SegmentMap(WALLS.segments, [0, 0, 1, 1, 1], sensors=[(1, -1)] * 2))
    assert links == [((panel.scan, "value"), (panel.play, "value"))]


def test_zoom_stays_until_all_is_reset_and_nothing_is_reduced_anew(figures):
    """Catches a view that recomputes, a Hough space that moves, and a part that jumps."""
    panel = HybridPanel(LEANING)
    left, right = figures[-1].axes
    view = view_of(panel)
    found, whole, hough_limits = panel.reduction, left.get_ylim(), right.get_xlim()
    press(view, "+")
    assert figures[-1].axes == [left, right]
    part = left.get_ylim()
    assert panel.reduction is found and right.get_xlim() == hough_limits
    panel.distance.value = 0.5
    assert figures[-1].axes[0].get_ylim() == pytest.approx(part)
    assert np.ptp(part) < np.ptp(whole)
    press(view, "0")
    assert figures[-1].axes[0].get_ylim() == whole and panel.distance.value == 0.20


@unpainted
def test_the_compare_panel_begins_with_fusion_wherever_it_stands():
    assert ComparePanel(WALLS, RUNS[::-1]).method.value == "fusion"
    assert ComparePanel(WALLS, RUNS[RUNS["method"] == "hybrid"]).method.value == "hybrid"


@unpainted
def test_the_compare_panel_shows_the_best_run_where_none_is_good_enough():
    """Catches an empty choice, and the run that reduces most."""
    poor = RUNS[(RUNS["method"] == "fusion") & (RUNS["quality"] < 0.97)]
    panel = ComparePanel(WALLS, poor)
    panel.wanted.value = 98
    assert len(poor) > 1 and panel.run["quality"] == poor["quality"].max()
    lost = poor.assign(quality=[np.nan, *poor["quality"][1:]])
    assert ComparePanel(WALLS, lost).run["quality"] == lost["quality"].max()
