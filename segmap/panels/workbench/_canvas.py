"""Maps side by side in the browser, panned and zoomed together; drawn by canvas.js."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
    `summary` says in words what is seen.
    `way` are places of scans, `looked_at` two rows of it. A click on the way is told to `picked`,
    and where one is `drawing`, a rectangle to `drawn`: left, low, right, high.
    """

    _esm = (Path(__file__).parent / "canvas.js").read_text(encoding="utf-8")
    before = traitlets.Bytes(b"").tag(sync=True)
    first = traitlets.Bytes(b"").tag(sync=True)
    second = traitlets.Bytes(b"").tag(sync=True)
    titles = traitlets.List(traitlets.Unicode()).tag(sync=True)
    summary = traitlets.Unicode("").tag(sync=True)
    size = traitlets.List(traitlets.Float(), [1.0, 1.0]).tag(sync=True)
    pointed = traitlets.List(traitlets.Int(), NOTHING).tag(sync=True)
    members = traitlets.List(traitlets.Int()).tag(sync=True)
    shown = traitlets.Unicode(SHOWN[1]).tag(sync=True)
    way = traitlets.Bytes(b"").tag(sync=True)
    looked_at = traitlets.List(traitlets.Int()).tag(sync=True)
    drawing = traitlets.Bool(False).tag(sync=True)

    def __init__(
        self, picked: Callable[[int], None], drawn: Callable[[list[float]], None], **more: Any
    ) -> None:
        super().__init__(**more)
        self._middle: Array = np.zeros(2)
        self._picked, self._drawn = picked, drawn
        self.on_msg(self._told)

    def _told(self, widget: Any, said: dict[str, Any], buffers: Any) -> None:
        if "scan" in said:
            self._picked(int(said["scan"]))
        else:
            corners = np.reshape(said["rectangle"], (2, 2)) + self._middle
            self._drawn(corners.ravel().round(2).tolist())

    def look(self, way: Array, scans: Sequence[int]) -> None:
        """Show a way, `(k, 2)`, metres, and two scans on it; nothing of it where that is empty."""
        with self.hold_sync():
            self.way, self.looked_at = _packed(way, self._middle), [*scans]

    def show(self, before: Array, results: list[Array], titles: list[str]) -> None:
        """Show other maps, `(n, 2, 2)`, metres; the view stays where the map covers the same."""
        ends = before.reshape(-1, 2)
        low, high = ends.min(0), ends.max(0)
        self._middle = middle = (low + high) / 2
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
    """Points `(..., 2)` about one of them, as single floats: a micrometre in ten metres."""
    return np.ascontiguousarray(segments - middle, np.float32).tobytes()
