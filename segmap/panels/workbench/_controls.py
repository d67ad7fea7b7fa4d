"""Controls made from a function: its signature tells defaults, its docstring the units."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import ipywidgets as W
import numpy as np

from ._recipe import Call

#: A slider goes in twentieths of the default up to ten times it.
STEPS, TIMES = 20, 10
#: The most that a number can be set to, in defaults; and what a count can at least be set to.
MOST, LEAST_MOST = 1000, 100
ENTRY = {"description_width": "130px"}
WRAP: Any = {"flex_flow": "row wrap", "align_items": "center"}
#: `angle, distance : float, radians and metres` in a docstring, however far it is indented.
LISTED = re.compile(r"^ *((?:\w+, )*\w+) : (.+)$", re.MULTILINE)
#: What a docstring says of two things in one line: `step : float, metres, and turn : float`.
ALSO = re.compile(r",? and (\w+) : ")


class Threshold(NamedTuple):
    """One control of a function's argument: `scale` turns what is shown into what is meant."""

    control: Any
    default: Any
    scale: float

    def value(self) -> Any:
        """The argument, in the units of the function."""
        shown = self.control.value
        if isinstance(self.control, W.Text):
            return _number(self.control.description, shown, self.scale)
        if isinstance(self.control, W.FloatSlider | W.BoundedFloatText):
            untouched = shown == _shown(self.default, self.scale)
            return self.default if untouched else _meant(shown, self.scale)
        return shown


class Thresholds:
    """Controls of the thresholds of a function: those that are numbers, words or switches.

    Angles are shown in degrees. The threshold that trades quality for fewer segments gets a slider.

    Parameters
    ----------
    name : str
    function : callable
    varies : str
        The threshold with the slider, or nothing.

    Attributes
    ----------
    controls : dict
        Name of a threshold -> its control.
    view : widget
    """

    def __init__(self, name: str, function: Callable[..., Any], varies: str = "") -> None:
        self.name, self.function, self.varies = name, function, varies
        units = units_of(function)
        kept = inspect.signature(function).parameters.values()
        made = {p.name: _made(p, units.get(p.name, ""), p.name == varies) for p in kept}
        self.thresholds = {key: each for key, each in made.items() if each is not None}
        self.controls = {key: each.control for key, each in self.thresholds.items()}
        first = sorted(self.controls.values(), key=lambda c: not isinstance(c, W.FloatSlider))
        nothing = W.Label("no threshold")
        self.view = W.Box(first or [nothing], layout=W.Layout(**WRAP))

    def call(self) -> Call:
        """The function with the thresholds that are not its defaults, and the one that varies."""
        values = {key: each.value() for key, each in self.thresholds.items()}
        changed = {
            key: value
            for key, value in values.items()
            if key == self.varies or value != self.thresholds[key].default
        }
        angles = frozenset(k for k, each in self.thresholds.items() if each.scale != 1)
        return Call(self.name, self.function, changed, angles)


def units_of(function: Callable[..., Any]) -> Mapping[str, str]:
    """What the docstring of a function says of each argument: type and unit.

    Examples
    --------
    >>> from segmap.alignment import pose_graph
    >>> units_of(pose_graph)["window_angle"]
    'float, radians'
    """
    found: dict[str, str] = {}
    for names, said in LISTED.findall(inspect.getdoc(function) or ""):
        parts = ALSO.split(said)
        found |= _each(names.split(", "), parts[0])
        found |= dict(zip(parts[1::2], parts[2::2], strict=True))
    return found


def _each(names: list[str], said: str) -> dict[str, str]:
    """`float, radians; metres` said of two names, to each its own part."""
    parts = re.split(r"; | and ", said) if len(names) > 1 else [said]
    return {name: parts[min(k, len(parts) - 1)] for k, name in enumerate(names)}


def _made(parameter: inspect.Parameter, said: str, varies: bool) -> Threshold | None:
    """The control of one argument; None where it has no default, or one that is no plain value."""
    default = parameter.default
    scale = math.pi / 180 if re.search(r"radians(?! a\b)", said) else 1.0
    unit = "deg" if scale != 1 else "m" if "metre" in said and "radians" not in said else ""
    label = f"{parameter.name} [{unit}]" if unit else parameter.name
    named: Any = {"description": label, "style": ENTRY}
    words = re.findall(r'"(\w+)"', said)
    if parameter.kind is not parameter.KEYWORD_ONLY:
        return None
    if isinstance(default, bool):
        return Threshold(W.Checkbox(default, indent=False, description=label), default, 1.0)
    if isinstance(default, int):
        most = max(LEAST_MOST, MOST * default)
        box = W.BoundedIntText(default, max=most, layout=_wide(), **named)
        return Threshold(box, default, 1.0)
    if isinstance(default, float) and math.isfinite(default):
        make = _slider if varies and default > 0 else _entry
        return Threshold(make(_shown(default, scale), named), float(default), scale)
    if words and (default is None or default in words):
        options = [*([None] if default is None else []), *words]
        choice = W.Dropdown(options=options, value=default, layout=_wide(), **named)
        return Threshold(choice, default, 1.0)
    if (default is None and "float" in said) or default == math.inf:
        text = "" if default is None else str(default)
        return Threshold(W.Text(text, placeholder="none", layout=_wide(), **named), default, scale)
    return None


def _slider(default: float, named: Any) -> Any:
    step, digits = default / STEPS, max(0, 2 - math.floor(math.log10(default)))
    return W.FloatSlider(
        value=default,
        min=step,
        max=TIMES * default,
        step=step,
        readout_format=f".{digits}f",
        continuous_update=False,
        layout=W.Layout(width="420px", max_width="100%"),
        **named,
    )


def _entry(default: float, named: Any) -> Any:
    most = max(1.0, MOST * default)
    return W.BoundedFloatText(default, min=0, max=most, step=None, layout=_wide(), **named)


def _wide() -> Any:
    return W.Layout(width="220px")


def _shown(value: float, scale: float) -> float:
    """A number in the unit of its control, without the digits that a conversion adds."""
    return float(f"{value / scale:.6g}")


def _meant(shown: float, scale: float) -> float:
    short = float(f"{shown:.6g}")
    return short if scale == 1 else float(np.radians(short))


def _number(name: str, text: str, scale: float) -> float | None:
    """A number that somebody typed; nothing means none."""
    if not text.strip():
        return None
    try:
        return _meant(float(text), scale)
    except ValueError:
        raise ValueError(f"{name} must be a number or nothing, got {text!r}") from None


class Choice:
    """A choice of one function of several, and the thresholds of the one that is chosen.

    Each keeps its settings while another is chosen.

    Parameters
    ----------
    name : str
        In the browser.
    functions : mapping
        Name -> function and the threshold that gets a slider; the words for none: None.
    first : str
        The one chosen at first.

    Attributes
    ----------
    picker : dropdown
    view : widget

    Examples
    --------
    >>> from segmap.reduction import fusion
    >>> choice = Choice("method", {"none": None, "fusion": (fusion, "tolerance")}, "none")
    >>> choice.value = "fusion"
    >>> choice["tolerance"].value = 0.06
    >>> choice.call().words()
    'tolerance 0.06'
    """

    def __init__(
        self,
        name: str,
        functions: Mapping[str, tuple[Callable[..., Any], str] | None],
        first: str,
    ) -> None:
        self._functions = functions
        self._made: dict[str, Thresholds] = {}
        self.picker: Any = W.Dropdown(
            options=list(functions), value=first, description=name, style=ENTRY
        )
        self._box = W.VBox()
        self.view = W.VBox([self.picker, self._box])
        self.picker.observe(self._chosen, names="value")
        self._chosen()

    @property
    def value(self) -> str:
        """The name that is chosen."""
        return str(self.picker.value)

    @value.setter
    def value(self, name: str) -> None:
        self.picker.value = name

    def __getitem__(self, threshold: str) -> Any:
        """The control of a threshold of the function that is chosen."""
        return self._made[self.value].controls[threshold]

    def controls(self) -> list[Any]:
        """The controls of the function that is chosen."""
        return list(self._made[self.value].controls.values()) if self.value in self._made else []

    def call(self) -> Call | None:
        """What is chosen, with its thresholds."""
        return self._made[self.value].call() if self.value in self._made else None

    def _chosen(self, change: Any = None) -> None:
        name, about = self.value, self._functions[self.value]
        if about is not None and name not in self._made:
            self._made[name] = Thresholds(name, *about)
        self._box.children = [] if about is None else [self._made[name].view]
