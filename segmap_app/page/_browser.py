"""What runs in the browser: maps side by side (canvas.js), and a button for files (upload.js)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import traitlets

from segmap.arrays import Array

#: What may be shown: the map before, what is left of it, or both beside each other.
SHOWN = ("before", "after", "both")
SCRIPTS_FOLDER = Path(__file__).parent
SCRIPTS = ("measure.js", "canvas.js")
#: Nothing is pointed at.
NOTHING = [-1, -1]


class Upload(anywidget.AnyWidget):
    """Hands each piece of a file to `take(name, size, start, content)`, which tells what is next.

    That is the byte that is awaited now; -1 ends the upload. Of a file of more than `most` bytes
    nothing but name and size comes.
    """

    _esm = (SCRIPTS_FOLDER / "upload.js").read_text(encoding="utf-8")
    description = traitlets.Unicode("").tag(sync=True)
    most = traitlets.Int().tag(sync=True)

    def __init__(
        self, description: str, most: int, take: Callable[[str, int, int, bytes], int]
    ) -> None:
        super().__init__(description=description, most=most)
        self._take = take
        self.on_msg(self._received)

    def _received(self, widget: Any, said: dict[str, Any], buffers: list[memoryview]) -> None:
        content = bytes(buffers[0]) if buffers else b""
        name, size, start = str(said["name"]), int(said["size"]), int(said["start"])
        self.send({"next": self._take(name, size, start, content)})


class Canvas(anywidget.AnyWidget):
    """The map before, and what one or two methods leave of it, with layers of what led to it.

    `pointed` says which of the results, and which of its segments the mouse is on, -1 for none;
    `members` are rows of the map before that went into it. `size` is width and height, metres, of
    what is seen at first; `middle` is the place of the map in its middle. `shown` is one of
    `SHOWN`, `layers` are drawn with it, `tool` is what a click does. `summary` says what is seen.
    `other` is what another run left. `way` are places of scans, `looked_at` two rows of it. While
    `growing`, walls, points, way and robot alone are drawn. `told` is called with what the page
    says: a place of the way that was clicked as `scan`, a `rectangle` that was drawn (left, low,
    right, high), what was `measured` and its `size`, the `run` of the table that is to be shown.
    `unsaved` maps are asked about before they are left.
    """

    _esm = "".join((SCRIPTS_FOLDER / name).read_text(encoding="utf-8") for name in SCRIPTS)
    _css = (SCRIPTS_FOLDER / "canvas.css").read_text(encoding="utf-8")
    before = traitlets.Bytes(b"").tag(sync=True)
    first = traitlets.Bytes(b"").tag(sync=True)
    second = traitlets.Bytes(b"").tag(sync=True)
    other = traitlets.Bytes(b"").tag(sync=True)
    titles = traitlets.List(traitlets.Unicode()).tag(sync=True)
    summary = traitlets.Unicode("").tag(sync=True)
    size = traitlets.List(traitlets.Float(), [1.0, 1.0]).tag(sync=True)
    middle = traitlets.List(traitlets.Float(), [0.0, 0.0]).tag(sync=True)
    pointed = traitlets.List(traitlets.Int(), NOTHING).tag(sync=True)
    members = traitlets.List(traitlets.Int()).tag(sync=True)
    shown = traitlets.Unicode(SHOWN[1]).tag(sync=True)
    layers = traitlets.List(traitlets.Unicode()).tag(sync=True)
    tool = traitlets.Unicode("look").tag(sync=True)
    way = traitlets.Bytes(b"").tag(sync=True)
    sure = traitlets.Bytes(b"").tag(sync=True)
    loops = traitlets.Bytes(b"").tag(sync=True)
    points = traitlets.Bytes(b"").tag(sync=True)
    free = traitlets.Bytes(b"").tag(sync=True)
    looked_at = traitlets.List(traitlets.Int()).tag(sync=True)
    drawing = traitlets.Bool(False).tag(sync=True)
    growing = traitlets.Bool(False).tag(sync=True)
    unsaved = traitlets.Bool(False).tag(sync=True)

    def __init__(self, told: Callable[[dict[str, Any]], None], **more: Any) -> None:
        super().__init__(**more)
        self.on_msg(lambda widget, said, buffers: told(said))

    def show(
        self,
        before: Array,
        results: list[Array],
        titles: list[str],
        layers: Mapping[str, Array] = {},
    ) -> None:
        """Show other maps, `(n, 2, 2)`, metres; the view stays where the map covers the same.

        Layers are `way`, `(k, 2)`, `sure`, `(k,)`, and `loops`, `(m, 2, 2)`; others are no more.
        """
        ends = before.reshape(-1, 2)
        with self.hold_sync():
            self._frame(ends.min(0), ends.max(0))
            self.pointed, self.members, self.titles, self.growing = NOTHING, [], titles, False
            self.before = self.packed(before)
            self.first, self.second = (
                self.packed(results[k]) if k < len(results) else b"" for k in (0, 1)
            )
            self.other = self.points = self.free = b""
            self.sure = np.ascontiguousarray(layers.get("sure", ()), np.float32).tobytes()
            for name in ("way", "loops"):
                setattr(self, name, self.packed(layers.get(name, np.zeros((0, 2)))))

    def beside(self, segments: Array, title: str) -> None:
        """Show what another run left beside these maps."""
        with self.hold_sync():
            self.titles = [*self.titles, "", ""][:3] + [title]
            self.other = self.packed(segments)

    def grow(self, way: Array, points: Array, walls: Array, words: str) -> None:
        """Show what is placed, metres: places `(k, 2)`, points `(n, 2)`, walls `(m, 2, 2)`."""
        with self.hold_sync():
            self.clear()
            seen = np.vstack([way, points, walls.reshape(-1, 2)])
            self._frame(seen.min(0), seen.max(0))
            self.way, self.points, self.before = map(self.packed, (way, points, walls))
            self.titles, self.growing = [words], True

    def clear(self) -> None:
        """Show nothing."""
        with self.hold_sync():
            self.before = self.first = self.second = self.other = self.sure = self.loops = b""
            self.way = self.points = self.free = b""
            self.pointed, self.members, self.looked_at = NOTHING, [], []
            self.titles, self.summary, self.growing = [], "", False

    def _frame(self, low: Array, high: Array) -> None:
        self.middle, self.size = ((low + high) / 2).tolist(), (high - low).tolist()

    def packed(self, places: Array) -> bytes:
        """Places `(..., 2)` about the middle, as single floats: a micrometre in ten metres."""
        return np.ascontiguousarray(places - np.array(self.middle), np.float32).tobytes()

    def save(self, name: str, content: bytes) -> None:
        """Hand a file to the browser, which keeps it among its downloads."""
        self.send({"name": name}, [content])
