"""What lesson panels share: a class body that names controls, texts, their rows and a sentence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import ipywidgets as W
import numpy as np

from segmap.panels import Panel, control, player, slider, text

#: Unit in which a slider is read -> what that is in metres or radians.
MEANT: dict[str, Callable[[float], float]] = {
    "degrees": np.radians,
    "cm": lambda read: read / 100,
    "mm": lambda read: read / 1000,
}


@dataclass(frozen=True)
class Part:
    """A control or a text that stands in a class body, and is made anew for each panel.

    `make` is given the panel, the name, and what the control shows at first, or None.
    """

    make: Callable[[Any, str, Any], Any]
    #: The keyword of the panel's method that it sets: None for none, "" for that of its name.
    of: str | None = None
    #: What a sentence says of a box that is not ticked, and of one that is.
    says: tuple[str, str] | None = None
    #: What the list `by` must say for it to count; empty: anything. Else it is greyed.
    only: tuple[str, ...] = ()


class LessonPanel(Panel):
    """A panel whose class body is its lesson: what to move, what to read, and how it is drawn.

    Controls and texts stand in it under their names. `rows` names what stands side by side, `words`
    is the panel in a sentence with the values of both, and `pixels` says how large the picture is.
    """

    method: Any
    #: The list from which a method is chosen, where a panel has several.
    by: Any
    rows: tuple[str, ...]
    words: str
    pixels: Any = {}  # noqa: RUF012

    def _begin(self, **first: Any) -> None:
        """Make all parts and draw; `first` are keywords of the method, in its units, and `by`."""
        bodies = [vars(kind).items() for kind in reversed(type(self).__mro__)]
        self._parts = {n: part for body in bodies for n, part in body if isinstance(part, Part)}
        keywords = {k for k, part in self._parts.items() if part.of is not None or k == "by"}
        if unknown := first.keys() - keywords:
            raise TypeError(f"{type(self).__name__} has no keyword {', '.join(sorted(unknown))}")
        for name, part in self._parts.items():
            setattr(self, name, part.make(self, name, first.get(name)))
        if any(part.only for part in self._parts.values()):
            self.by.observe(self._grey, "value")
            self._grey()
        rows = [tuple(getattr(self, name) for name in row.split()) for row in self.rows]
        self._assemble(*rows, **self.pixels)

    def _grey(self, change: Any = None) -> None:
        """Disable what means nothing to the method that is chosen."""
        for name, part in self._parts.items():
            if part.only:
                getattr(self, name).disabled = self.by.value not in part.only

    def chosen(self) -> dict[str, Any]:
        """The keywords of the method as the controls stand, in its units."""
        parts = {n: part for n, part in self._parts.items() if part.of is not None}
        controls = {name: getattr(self, name) for name in parts}
        counts = {n: p for n, p in parts.items() if not p.only or self.by.value in p.only}
        return {part.of or name: controls[name].meant() for name, part in counts.items()}

    def __repr__(self) -> str:
        states = {name: getattr(self, name).value for name in self._parts}
        states |= {n: part.says[states[n]] for n, part in self._parts.items() if part.says}
        return f"{type(self).__name__}({self.words.format_map(states)})"


def keyword(
    least: Any = None,
    most: Any = None,
    step: Any = None,
    *,
    of: str = "",
    by: tuple[Callable[..., Any], ...] = (),
    **more: Any,
) -> Any:
    """A slider, or a box to tick, for a keyword of the panel's method: its unit and its default.

    The range is as it is read, angles in degrees; `of` is the keyword, where the control has
    another name, and `by` the methods that have it, where the panel has several. More is a `label`,
    or a `value` at first in place of the default.
    """

    def make(panel: LessonPanel, name: str, first: Any) -> Any:
        options = more if first is None else more | {"value": first}
        function = by[0] if by else panel.method
        return control(function, of or name, least=least, most=most, step=step, **options)

    return Part(make, of, only=tuple(function.__name__ for function in by))


def slide(
    first: Any,
    least: Any,
    most: Any,
    step: float,
    unit: str = "m",
    *,
    label: str = "",
    only: tuple[str, ...] = (),
) -> Any:
    """A slider for anything else; the first three may be functions of the panel.

    `meant()` is its value in metres or radians; `only` are the choices of `by` with which it
    counts.
    """

    def make(panel: LessonPanel, name: str, _: Any) -> Any:
        value, low, high = (b(panel) if callable(b) else b for b in (first, least, most))
        handle = slider(label or name, value, low, high, step, unit)
        handle.meant = lambda: MEANT.get(unit, float)(handle.value)
        return handle

    return Part(make, only=only)


def play(moved: str, **more: int) -> Any:
    """A play button that moves the slider of that name, which stands above it in the class."""
    return Part(lambda panel, name, _: player(getattr(panel, moved), **more))


def tick(label: str, first: bool = False, *, says: tuple[str, str] | None = None) -> Any:
    """A box to tick."""
    return Part(lambda *_: W.Checkbox(value=first, description=label, indent=False), says=says)


def pick(options: Any, label: str = "", kind: Any = W.Dropdown) -> Any:
    """A list to choose from."""

    def make(panel: LessonPanel, name: str, first: Any) -> Any:
        chosen = {} if first is None else {"value": first}
        return kind(options=tuple(options), description=label or name, **chosen)

    return Part(make)


def note() -> Any:
    """A text."""
    return Part(lambda *_: text())
