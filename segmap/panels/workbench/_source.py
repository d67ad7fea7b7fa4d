"""Where the workbench's log comes from: the bundled ones, a path, or a file of the browser."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import ipywidgets as W

from ... import arrays, readers
from ...scans import Log
from .._control import ENTRY
from . import _shown
from ._choices import WRAP
from ._job import said

#: What the list of bundled logs says of a log of one's own.
OWN = "(a log of your own)"
#: A browser sends a file in one message, and Jupyter takes no larger one; bytes.
MOST = 10_000_000
LARGEST = "up to 10 MB; larger ones by their path"


class Source:
    """A log, the Python `expression` that gives it, and the controls that choose another.

    `taken` is called with each new log, `say` told why there is none.
    """

    log: Log
    expression: str

    def __init__(
        self,
        first: str | Path | Log,
        taken: Callable[[Log], None],
        say: Callable[[str], None],
    ) -> None:
        self._taken, self._say = taken, say
        files = readers.data_file("malaga").parent.glob("*/*.log.gz")
        self.names = sorted(path.parent.name for path in files)
        named: Any = {"description": "or its path", "placeholder": "my.log.gz, then Enter"}
        self.controls: Any = (
            W.Dropdown(options=[OWN, *self.names], description="bundled log", style=ENTRY),
            W.Text(continuous_update=False, style=ENTRY, **named),
            _upload("or upload it"),
        )
        bundled, path, upload = self.controls
        self.about: Any = W.HTML()
        chosen = W.Box([bundled, path, upload, W.Label(LARGEST)], layout=W.Layout(**WRAP))
        self.view = W.VBox([chosen, self.about])
        self.open(first)
        bundled.observe(self._opened, names="value")
        path.observe(self._opened, names="value")
        upload.observe(self._uploaded, names="value")

    def open(self, source: str | Path | Log) -> None:
        """Take the log of a bundled name, of a path, or this one; `ValueError` keeps the other."""
        if isinstance(source, Log):
            self._take(source, f"log  # {source.name!r}, the one given to Workbench")
        elif source in self.names:
            self._take(readers.load(str(source)), f"segmap.load({source!r})")
        else:
            log = readers.read(arrays.file(source, "source"), on_error="skip")
            self._take(log, f'segmap.read({str(source)!r}, on_error="skip")')

    def _take(self, log: Log, expression: str) -> None:
        if not len(log):
            raise ValueError(f"{log.name} must hold one scan at least, got none")
        self.log, self.expression = log, expression
        self.about.value = _shown.about(log)
        self.controls[0].value = log.name if expression == f"segmap.load({log.name!r})" else OWN
        self._taken(log)

    def _opened(self, change: Any) -> None:
        """A bundled log or a path was chosen; the log there is may have set its own name."""
        if change["new"] not in ("", OWN) and self.expression != f"segmap.load({change['new']!r})":
            with telling(self._say):
                self.open(change["new"])

    def _uploaded(self, change: Any) -> None:
        """A file came from the browser: it is read and not kept."""
        for file in change["new"]:
            name = Path(file["name"].replace("\0", "")).name or "upload.log"
            if file["size"] > MOST:
                self._say(f"{name} has {file['size'] / 1e6:.1f} MB: uploads have {LARGEST}")
                continue
            with telling(self._say), tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / name
                path.write_bytes(bytes(file["content"]))
                log = readers.read(path, on_error="skip")
                self._take(log, f'segmap.read({name!r}, on_error="skip")')
        if change["new"]:
            self.controls[2].value = ()


def _upload(description: str) -> Any:
    """A button that takes a file of the browser."""
    try:
        from ._upload import Upload
    except ImportError:  # anywidget is not installed: what is too large breaks the connection
        return W.FileUpload(description=description)
    return Upload(description, MOST)


@contextlib.contextmanager
def telling(say: Callable[[str], None]) -> Iterator[None]:
    """What was refused is a line of text: in a browser nobody sees an exception."""
    try:
        yield
    except (ValueError, OSError) as fault:
        say(said(fault))
