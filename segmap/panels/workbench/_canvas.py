"""Maps side by side in the browser, panned and zoomed together; drawn by canvas.js."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import traitlets

from ...arrays import Array

#: What may be shown: the map before, what is left of it, or both beside each other.
SHOWN = ("before", "after", "both")
#: Nothing is pointed at.
NOTHING = [-1, -1]


class Canvas(anywidget.AnyWidget):
    """The map before, and what one or two methods leave of it.

    `pointed` says which of the results, and which of its segments the mouse is on, -1 for none;
    `members` are rows of the map before that went into it. `size` is width and height, metres, of
    what is seen at first; the middle of the map is (0, 0). `shown` is one of `SHOWN`.
    """

    _esm = (Path(__file__).parent / "canvas.js").read_text(encoding="utf-8")
    before = traitlets.Bytes(b"").tag(sync=True)
    first = traitlets.Bytes(b"").tag(sync=True)
    second = traitlets.Bytes(b"").tag(sync=True)
    titles = traitlets.List(traitlets.Unicode()).tag(sync=True)
    size = traitlets.List(traitlets.Float(), [1.0, 1.0]).tag(sync=True)
    pointed = traitlets.List(traitlets.Int(), NOTHING).tag(sync=True)
    members = traitlets.List(traitlets.Int()).tag(sync=True)
    shown = traitlets.Unicode(SHOWN[1]).tag(sync=True)

    def show(self, before: Array, results: list[Array], titles: list[str]) -> None:
        """Show other maps, `(n, 2, 2)`, metres; the view stays where the map covers the same."""
        ends = before.reshape(-1, 2)
        low, high = ends.min(0), ends.max(0)
        middle = (low + high) / 2
        with self.hold_sync():
            self.pointed, self.members, self.titles = NOTHING, [], titles
            self.before = _packed(before, middle)
            self.first, self.second = (
                _packed(results[k], middle) if k < len(results) else b"" for k in (0, 1)
            )
            self.size = [float(side) for side in high - low]

    def save(self, name: str, content: bytes) -> None:
        """Hand a file to the browser, which keeps it among its downloads."""
        self.send({"name": name}, [content])


def _packed(segments: Array, middle: Any) -> bytes:
    """Segments `(n, 2, 2)` about a point, as single floats: a micrometre in ten metres."""
    return np.ascontiguousarray(segments - middle, np.float32).tobytes()
