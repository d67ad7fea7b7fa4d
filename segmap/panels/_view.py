"""What is seen of a drawing: buttons that zoom into its maps and move what is seen."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import ipywidgets as W
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..arrays import Array

#: By how much one press enlarges.
ZOOM_STEP = 2**0.5
#: The largest enlargement.
MOST_ZOOM = 64.0
#: One press moves by this part of what is seen.
SHIFT = 0.25
#: Of a picture with one map, about: the part of its width and height that is within the frame.
PART_IN_FRAME = (0.86, 0.76)
#: Label of a button -> what it is for, and its name on the panel.
BUTTONS = {
    "+": "zoom in",
    "\N{MINUS SIGN}": "zoom out",
    "\N{LEFTWARDS ARROW}": "look further left",
    "\N{RIGHTWARDS ARROW}": "look further right",
    "\N{UPWARDS ARROW}": "look further up",
    "\N{DOWNWARDS ARROW}": "look further down",
    "reset": "all controls as they were at first, and the whole picture",
}


class View:
    """Zoom and middle of what is seen, shared by all maps of a figure (axes of equal scales).

    `zoom` is 1 where the whole drawing is seen; `middle` is that of what is seen, in parts of the
    whole from its own middle. `changed` is called where another part is to be seen, `reset` for the
    last of the `buttons`.
    """

    def __init__(self, changed: Callable[[], None], reset: Callable[[], None]) -> None:
        self._changed = changed
        self._whole: list[tuple[Axes, Array]] = []
        self.whole()
        self.buttons: list[Any] = []
        for label, tip in BUTTONS.items():
            width = W.Layout(width="64px" if label.isalpha() else "36px")
            self.buttons.append(W.Button(description=label, tooltip=tip, layout=width))
        near, far, *arrows, first = self.buttons
        near.on_click(lambda _: self.enlarge(ZOOM_STEP))
        far.on_click(lambda _: self.enlarge(1 / ZOOM_STEP))
        for button, way in zip(arrows, ((-1, 0), (1, 0), (0, 1), (0, -1)), strict=True):
            button.on_click(lambda _, way=way: self.move(*way))
        first.on_click(lambda _: reset())

    def whole(self) -> None:
        """See the whole drawing from now on."""
        self.zoom, self.middle = 1.0, np.zeros(2)

    def enlarge(self, factor: float) -> None:
        """Zoom in, or out with a factor below 1; never out of the whole drawing."""
        self.zoom = float(np.clip(self.zoom * factor, 1.0, MOST_ZOOM))
        self.move(0, 0)

    def move(self, x: float, y: float) -> None:
        """Look to the side, by a share of what is seen; never beyond the whole drawing."""
        most = (1 - 1 / self.zoom) / 2
        self.middle = np.clip(self.middle + SHIFT / self.zoom * np.array([x, y]), -most, most)
        self._changed()

    def take(self, figure: Figure) -> Figure:
        """Remember the limits of a new drawing as the whole of it, and set those that are seen."""
        maps = [ax for ax in figure.axes if ax.get_aspect() == 1]
        self._whole = [(ax, np.array([ax.get_xlim(), ax.get_ylim()]).T) for ax in maps]
        return self.set(figure)

    def set(self, figure: Figure) -> Figure:
        """Set, in place, the limits that are seen now."""
        for ax, (low, high) in self._whole:
            centre = (low + high) / 2 + self.middle * (high - low)
            half = (high - low) / 2 / self.zoom
            if self.zoom > 1 and len(figure.axes) == 1:  # a part fills the picture
                ratio = np.divide(*(figure.get_size_inches() * PART_IN_FRAME))
                half = np.maximum(half, half[::-1] * (ratio, 1 / ratio))
            first, last = centre - half, centre + half
            ax.set(xlim=(first[0], last[0]), ylim=(first[1], last[1]))
        return figure
