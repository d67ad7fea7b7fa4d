"""A panel without a kernel: `set_state` is what a browser sends when a control moves."""

import re

import ipywidgets as W
import numpy as np
import pytest
from conftest import without_pictures

from segmap import SegmentMap
from segmap.experiments import sweep
from segmap.simulation import URG_04LX, drive, rectangular_room, simulate

#: What a browser with a kernel shows in the place of the picture.
VIEW = "application/vnd.jupyter.widget-view+json"
ROOM = rectangular_room(4.0, 3.0)
LOG = simulate(
    ROOM, drive([(1, 1), (3, 1)], step=0.5), sensor=URG_04LX, rng=np.random.default_rng(2)
)
WALLS = SegmentMap([[(0, y), (2, y)] for y in (0.0, 0.03, 0.10, 0.15, 1.0)])
#: Two that touch at (2, 0), six degrees apart: rho of both is near 0 there, and not elsewhere.
LEANING = SegmentMap([[(0, 0), (2, 0)], [(1.95, 0), (3.9, 0.2)], [(9, 9), (9, 9.1)]])

RUNS = sweep(
    {"walls": WALLS},
    ["hybrid", "fusion", "mean_shift"],
    {
        "fusion": {"tolerance": [0.02, 0.06, 0.2]},
        "hybrid": {"distance": [0.02, 0.2]},
        "mean_shift": {"sigma": [0.05, 0.5]},
    },
)

#: A panel draws its figure, which takes its time as a picture: most tests only read it.
unpainted = pytest.mark.usefixtures("no_png")


def view_of(panel):
    """The widget that a browser is given of a panel."""
    (model,) = (panel._repr_mimebundle_()[VIEW]["model_id"],)
    return W.widgets.widget._instances[model]


def parts_of(view):
    """A widget and all that lie in it."""
    return [view, *(part for child in getattr(view, "children", ()) for part in parts_of(child))]


def controls(panel):
    """Name -> what of a panel a reader moves."""
    told = (W.Label, W.HTML, W.Play, W.Button, W.Image)
    found = {n: v for n, v in vars(panel).items() if isinstance(v, W.ValueWidget)}
    return {name: part for name, part in found.items() if not isinstance(part, told)}


def press(view, keys):
    """Click the buttons below a picture: + and - zoom, < > ^ v move, 0 resets."""
    found = [part for part in parts_of(view) if type(part) is W.Button][-7:]
    for key in keys:
        found["+-<>^v0".index(key)].click()


def seen(panel):
    """The picture, the texts, and the panel in words."""
    labels = tuple(v.value for v in vars(panel).values() if type(v).__name__ == "Label")
    return bytes(panel.picture.value), labels, repr(panel)


def assert_answers(panel, control, value, monkeypatch):
    """Catches a control that is not observed, a drawing that piles up, noise drawn anew at each
    move, a slider that reaches a value which the method refuses, and an empty printed notebook."""
    moved = getattr(panel, control).set_state
    start, before = getattr(panel, control).value, seen(panel)
    bundle = panel._repr_mimebundle_()
    still = bundle["image/png"]
    assert still.startswith(b"\x89PNG") and before[0].startswith(b"\x89PNG")
    assert len(still) < 30_000 and bundle["text/plain"] == repr(panel)
    assert bundle[VIEW]["model_id"]
    assert not re.search(r"0x[0-9a-f]+|Widget|widget", repr(panel))
    width, wide = (int.from_bytes(png[16:20], "big") for png in (still, before[0]))
    high = int.from_bytes(still[20:24], "big")  # of a window it takes 60 % of the height at most
    limit = f"min({min(900, wide)}px, {60 * width / high:.0f}vh)"
    assert panel.picture.layout.max_width == limit and wide == 2 * width
    moved({"value": value})
    assert all(a != b for a, b in zip(before, seen(panel), strict=True))
    moved({"value": start})
    assert seen(panel)[0] == before[0]
    without_pictures(monkeypatch)
    for slid in [v for v in vars(panel).values() if type(v).__name__.endswith("Slider")]:
        for end in (slid.min, slid.max):
            slid.set_state({"value": end})
            assert slid.value == end
