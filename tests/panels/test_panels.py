"""Panels for any log, without a kernel; lesson panels are tested beside the course."""

import ipywidgets as W
import numpy as np
from driven_panels import RUNS, WALLS, press, unpainted, view_of
from matplotlib.figure import Figure
from segmap_course import SectorPanel

from segmap import SegmentMap
from segmap.panels import ComparePanel, Panel, slider, text


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


@unpainted
def test_the_compare_panel_shows_the_best_run_where_none_is_good_enough():
    """Catches an empty choice, and the run that reduces most."""
    poor = RUNS[(RUNS["method"] == "fusion") & (RUNS["quality"] < 0.97)]
    panel = ComparePanel(WALLS, poor)
    panel.wanted.value = 98
    assert len(poor) > 1 and panel.run["quality"] == poor["quality"].max()
    lost = poor.assign(quality=[np.nan, *poor["quality"][1:]])
    assert ComparePanel(WALLS, lost).run["quality"] == lost["quality"].max()
