"""A control of a keyword of a function: its annotation says label, unit and what may be chosen."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import ipywidgets as W

from ..arrays import Declared, Quantity, declared, described
from ._base import slider

#: The most that a number can be set to, in defaults.
MOST_DEFAULTS = 1000
#: What a count can at least be set to.
LEAST_COUNT_LIMIT = 100
ENTRY = {"description_width": "165px"}


def control(
    function: Callable[..., Any],
    name: str,
    value: Any = None,
    *,
    least: float | None = None,
    most: float | None = None,
    step: float | None = None,
    label: str = "",
) -> Any:
    """A control of a keyword of a function, as its annotation declares it.

    Numbers get a slider where a range is given, else a box to write in; words a list, switches a
    box to tick. Angles are read in degrees: `value` of the control is what is read, and
    `meant()` the same in the unit of the function.

    Parameters
    ----------
    value
        At first, in the unit of the function; None takes the function's default.
    least, most, step
        Of the slider, as they are read.
    label
        In place of the name of the keyword; the tooltip has that name, and its sentence of the
        docstring.

    Returns
    -------
    widget or None
        None where the keyword is no plain value.

    Examples
    --------
    >>> from segmap.reduction import hybrid
    >>> angle = control(hybrid, "angle", least=1, most=45, step=1)
    >>> angle.description, angle.value
    ('angle [degrees]', 10)
    >>> angle.value = 20
    >>> f"{angle.meant():.3f} radians"
    '0.349 radians'
    """
    first = inspect.signature(function).parameters[name].default
    rule = declared(function).get(name) or Declared(type(first), Quantity(), (), False)
    first = first if value is None else rule.check(value, name)
    unit = {"metres": "m", "seconds": "s"}.get(rule.unit, rule.read_unit)
    label = label or name.replace("_", " ")
    if least is not None and most is not None and step is not None:
        read = _as_read(rule, first)
        field = slider(
            label, round(read) if isinstance(step, int) else read, least, most, step, unit
        )
    else:
        field = _entry(rule, first, f"{label} [{unit}]" if unit else label)
    if field is not None:
        field.meant = partial(_value_in, field, rule, first)
        field.tooltip = f"{name}: {described(function).get(name, '')}".replace("`", "").rstrip(": ")
    return field


def _entry(rule: Declared, first: Any, label: str) -> Any:
    named: Any = {"description": label, "style": ENTRY, "layout": W.Layout(width="270px")}
    if rule.words:
        options = [*([None] if rule.optional else []), *rule.words]
        return W.Dropdown(options=options, value=first, **named)
    if rule.kind is bool:
        return W.Checkbox(first, indent=False, description=label)
    if rule.kind is int:
        return W.BoundedIntText(first, max=max(LEAST_COUNT_LIMIT, MOST_DEFAULTS * first), **named)
    if rule.kind is not float:
        return None
    if first is None or first == math.inf:
        return W.Text("" if first is None else str(first), placeholder="none", **named)
    read = _as_read(rule, first)
    return W.BoundedFloatText(read, min=0, max=max(1.0, MOST_DEFAULTS * read), step=None, **named)


def _as_read(rule: Declared, value: float) -> float:
    """As it is read, without the digits that a conversion adds."""
    return float(f"{rule.read(value):.6g}")


def _value_in(field: Any, rule: Declared, first: Any) -> Any:
    """What a control says, in the unit of the function; what was not touched is exact."""
    read = field.value
    if isinstance(field, W.Text):
        if not read.strip():
            return None
        try:
            read = float(read)
        except ValueError:
            raise ValueError(
                f"{field.description} must be a number or nothing, got {read!r}"
            ) from None
    if rule.kind is not float or rule.words:
        return read
    if first is not None and read == _as_read(rule, first):
        return first
    return rule.meant(float(f"{read:.12g}"))  # a slider adds digits


def folded(name: str, box: Any, tooltip: str = "") -> Any:
    """A button that shows and hides a box; it is hidden at first."""
    button = W.ToggleButton(False, description=name, tooltip=tooltip)
    button.layout.width, button.layout.flex, box.layout.display = "auto", "none", "none"

    def fold(change: Any) -> None:
        box.layout.display = "flex" if change["new"] else "none"

    button.observe(fold, names="value")
    return button
