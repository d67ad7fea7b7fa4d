"""A panel without a kernel: `set_state` is what a browser sends when a control moves."""

import re

import pytest

from segmap.panels._base import FINER, VIEW

#: A panel draws its figure, which takes its time as a picture: most tests only read it.
unpainted = pytest.mark.usefixtures("no_png")


def seen(panel):
    """The picture, the texts, and the panel in words."""
    labels = tuple(v.value for v in vars(panel).values() if type(v).__name__ == "Label")
    return bytes(panel.picture.value), labels, repr(panel)


def assert_answers(panel, control, value, monkeypatch, finer=FINER):
    """Catches a control that is not observed, a drawing that piles up, noise drawn anew at each
    move, a slider that reaches a value which the method refuses, and an empty printed notebook."""
    moved = getattr(panel, control).set_state
    start, before = getattr(panel, control).value, seen(panel)
    bundle = panel._repr_mimebundle_()
    still = bundle["image/png"]
    assert still.startswith(b"\x89PNG") and before[0].startswith(b"\x89PNG")
    assert len(still) < 30_000 and bundle["text/plain"] == repr(panel)
    assert bundle[VIEW]["model_id"] == panel._view.model_id
    assert not re.search(r"0x[0-9a-f]+|Widget|widget", repr(panel))
    width, wide = (int.from_bytes(png[16:20], "big") for png in (still, before[0]))
    assert panel.picture.layout.width == f"{width}px" and wide == finer * width
    moved({"value": value})
    assert all(a != b for a, b in zip(before, seen(panel), strict=True))
    moved({"value": start})
    assert seen(panel)[0] == before[0]
    monkeypatch.setattr("segmap.panels._base.figure_png", lambda figure, **finer: bytes(24))
    for slid in [v for v in vars(panel).values() if type(v).__name__.endswith("Slider")]:
        for end in (slid.min, slid.max):
            slid.set_state({"value": end})
            assert slid.value == end
