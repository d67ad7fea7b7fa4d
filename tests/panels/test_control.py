"""Controls of keywords: each kind as its annotation declares it."""

import math
from typing import Annotated, Literal

import numpy as np
import pytest

from segmap import LaserScan
from segmap.arrays import Count, Metres, Radians, RadiansPerMetre, Seconds, Share, at_least, at_most
from segmap.panels import control, slider


def method(
    *,
    many: Count = 7,
    none_yet: Annotated[int, at_least(0)] = 0,
    length: Metres = 0.2,
    thin: Metres = 0.0005,
    pause: Seconds = 2.0,
    share: Share = 0.5,
    angle: Radians = np.radians(10),
    turn: RadiansPerMetre = np.radians(50),
    far: Annotated[float, at_most(math.inf)] = math.inf,
    maybe: Metres | None = None,
    wide: Radians | None = None,
    word: Literal["a", "b"] = "b",
    no_word: Literal["a", "b"] | None = None,
    switch: bool = True,
    bare=3,
    scan: LaserScan | None = None,
): ...


@pytest.mark.parametrize(
    ("name", "kind", "description", "value", "most", "moved", "meant"),
    [
        ("many", "BoundedIntText", "many", 7, 7000, 9, 9),
        ("none_yet", "BoundedIntText", "none yet", 0, 100, 3, 3),
        ("length", "BoundedFloatText", "length [m]", 0.2, 200.0, 0.3, 0.3),
        ("thin", "BoundedFloatText", "thin [m]", 0.0005, 1.0, 0.7, 0.7),
        ("pause", "BoundedFloatText", "pause [s]", 2.0, 2000.0, 0.0, 0.0),
        ("share", "BoundedFloatText", "share", 0.5, 500.0, 0.25, 0.25),
        ("angle", "BoundedFloatText", "angle [degrees]", 10.0, 1e4, 20.0, np.radians(20)),
        ("turn", "BoundedFloatText", "turn [degrees/m]", 50.0, 5e4, 5.0, np.radians(5)),
        ("far", "Text", "far", "inf", None, "3.5", 3.5),
        ("maybe", "Text", "maybe [m]", "", None, " 0.5 ", 0.5),
        ("wide", "Text", "wide [degrees]", "", None, "30", np.radians(30)),
        ("word", "Dropdown", "word", "b", ("a", "b"), "a", "a"),
        ("no_word", "Dropdown", "no word", None, (None, "a", "b"), "a", "a"),
        ("switch", "Checkbox", "switch", True, None, False, False),
        ("bare", "BoundedIntText", "bare", 3, 3000, 4, 4),
    ],
)
def test_a_control_of_each_kind(name, kind, description, value, most, moved, meant):
    """Catches a box that ends below what may be meant, and a default that is not exact."""
    made, usual = control(method, name), method.__kwdefaults__[name]
    assert (type(made).__name__, made.description, made.value) == (kind, description, value)
    assert getattr(made, "max", getattr(made, "options", None)) == most
    assert made.meant() == usual or (usual is None and made.meant() is None)
    made.value = moved
    assert made.meant() == meant
    if kind.startswith("Bounded"):
        assert made.min == 0 or type(made.value) is int
    if kind == "Checkbox":
        assert made.indent is False
    else:
        assert (made.layout.width, made.style.description_width) == ("270px", "165px")


def test_a_slider_needs_both_ends_and_a_step():
    whole = {"least": 1, "most": 45, "step": 1}
    for left_out in whole:
        some = {name: value for name, value in whole.items() if name != left_out}
        assert type(control(method, "angle", **some)).__name__ == "BoundedFloatText"
    made = control(method, "angle", np.radians(7.4), **whole, label="turned by")
    assert (type(made).__name__, made.description) == ("IntSlider", "turned by [degrees]")
    assert (made.min, made.max, made.step, made.value) == (1, 45, 1, 7)
    assert made.meant() == np.radians(7) and made.readout_format == "d"
    fine = control(method, "length", 0.25, least=0.1, most=1.0, step=0.05)
    assert (type(fine).__name__, fine.value, fine.meant()) == ("FloatSlider", 0.25, 0.25)
    assert (fine.readout_format, slider("x", 1, 0, 2, 1.0).readout_format) == (".2f", ".0f")
    assert control(method, "angle", label="it").description == "it [degrees]"
    assert control(method, "scan") is None
    none = control(method, "maybe")
    none.value = "  "
    assert none.meant() is None
    none.value = "long"
    with pytest.raises(ValueError, match=r"maybe \[m\] must be a number or nothing, got 'long'"):
        none.meant()
    with pytest.raises(ValueError, match="angle must be"):
        control(method, "angle", -1.0, **whole)
