"""A button for files of the browser's machine, which upload.js sends in pieces."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import anywidget
import traitlets


class Upload(anywidget.AnyWidget):
    """Hands each piece of a file to `take(name, size, start, content)`, which tells what is next.

    That is the byte that is awaited now; -1 ends the upload. Of a file of more than `most` bytes
    nothing but name and size comes.
    """

    _esm = (Path(__file__).parent / "upload.js").read_text(encoding="utf-8")
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
