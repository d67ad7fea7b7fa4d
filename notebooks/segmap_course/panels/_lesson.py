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


class LessonPanel(Panel):
    """A panel whose class body is its lesson: what to move, what to read, and how it is drawn.

    Controls and texts stand in it under their names. `rows` names what stands side by side, `words`
    is the panel in a sentence with the values of both, and `pixels` says how large the picture is.
    """

    method: Any
    rows: tuple[str, ...]
    words: str
    pixels: Any = {}  # noqa: RUF012

    def _begin(self, **first: Any) -> None:
        """Make all parts and draw; `first` are keywords of the method, in its units."""
        bodies = [vars(kind).items() for kind in reversed(type(self).__mro__)]
        self._parts = {n: part for body in bodies for n, part in body if isinstance(part, Part)}
        if unknown := {k for k in first if k not in self._parts or self._parts[k].of is None}:
            raise TypeError(f"{type(self).__name__} has no keyword {', '.join(sorted(unknown))}")
        for name, part in self._parts.items():
            setattr(self, name, part.make(self, name, first.get(name)))
        rows = [tuple(getattr(self, name) for name in row.split()) for row in self.rows]
        self._assemble(*rows, **self.pixels)

    def chosen(self) -> dict[str, Any]:
        """The keywords of the method as the controls stand, in its units."""
        parts = {name: part.of for name, part in self._parts.items() if part.of is not None}
        return {of or name: getattr(self, name).meant() for name, of in parts.items()}

    def __repr__(self) -> str:
        said = {name: getattr(self, name).value for name in self._parts}
        said |= {n: part.says[said[n]] for n, part in self._parts.items() if part.says}
        return f"{type(self).__name__}({self.words.format_map(said)})"


def keyword(
    least: Any = None, most: Any = None, step: Any = None, *, of: str = "", **more: Any
) -> Any:
    """A slider, or a box to tick, for a keyword of the panel's method: its unit and its default.

    The range is as it is read, angles in degrees; `of` is the keyword, where the control has
    another name. More is a `label`, or a `value` at first in place of the default.
    """

    def make(panel: LessonPanel, name: str, first: Any) -> Any:
        given = more if first is None else more | {"value": first}
        return control(panel.method, of or name, least=least, most=most, step=step, **given)

    return Part(make, of)


def slide(
    first: Any, least: Any, most: Any, step: float, unit: str = "m", *, label: str = ""
) -> Any:
    """A slider for anything else; the first three may be functions of the panel.

    `meant()` is its value in metres or radians.
    """

    def make(panel: LessonPanel, name: str, _: Any) -> Any:
        value, low, high = (b(panel) if callable(b) else b for b in (first, least, most))
        made = slider(label or name, value, low, high, step, unit)
        made.meant = lambda: MEANT.get(unit, float)(made.value)
        return made

    return Part(make)


def play(moved: str, **more: int) -> Any:
    """A play button that moves the slider of that name, which stands above it in the class."""
    return Part(lambda panel, name, _: player(getattr(panel, moved), **more))


def tick(label: str, first: bool = False, *, says: tuple[str, str] | None = None) -> Any:
    """A box to tick."""
    return Part(lambda *_: W.Checkbox(value=first, description=label, indent=False), says=says)


def pick(options: Any, label: str = "", kind: Any = W.Dropdown) -> Any:
    """A list to choose from."""
    return Part(lambda _, name, __: kind(options=tuple(options), description=label or name))


def note() -> Any:
    """A text."""
    return Part(lambda *_: text())
