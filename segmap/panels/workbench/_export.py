"""Buttons that hand the reduced map to other programs."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ipywidgets as W

from ...exports import write_segments
from ._controls import WRAP

#: What `exports.write_segments` writes.
FORMATS = (".csv", ".npz", ".svg", ".geojson", ".wkt", ".dxf")


def export_buttons(export: Callable[[str], None]) -> Any:
    """A button for each format, which calls `export` with it."""
    buttons = [W.Button(description=end, layout=W.Layout(width="auto")) for end in FORMATS]
    for button in buttons:
        button.on_click(lambda pressed: export(pressed.description))
    return W.Box([W.Label("Save the first result as"), *buttons], layout=W.Layout(**WRAP))


def written(name: str, map: Any) -> bytes:
    """The content of a file of that name: a map in the format that its end asks for."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write_segments(path, map)
        return path.read_bytes()
