"""A button for files of the browser's machine, by upload.js: what is too large is not sent."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anywidget
import traitlets


class Upload(anywidget.AnyWidget):
    """Takes files of at most `most` bytes; `value` is as that of a `FileUpload`.

    A larger one comes with its name and size alone.
    """

    _esm = (Path(__file__).parent / "upload.js").read_text(encoding="utf-8")
    description = traitlets.Unicode("").tag(sync=True)
    most = traitlets.Int().tag(sync=True)
    value: Any = traitlets.Tuple()

    def __init__(self, description: str, most: int) -> None:
        super().__init__(description=description, most=most)
        self.on_msg(self._taken)

    def _taken(self, widget: Any, said: dict[str, Any], buffers: list[memoryview]) -> None:
        content = buffers[0] if buffers else b""
        self.value = ({"name": said["name"], "size": said["size"], "content": content},)
