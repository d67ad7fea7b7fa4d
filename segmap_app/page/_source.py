"""Where the workbench's log comes from: bundled, a path, a file of the browser, a laser (Live)."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import ipywidgets as W

from segmap import arrays, readers
from segmap.files import escape
from segmap.scans import Log
from segmap.sensors import SensorError, ports, spinning_models

from ..drives import HOKUYO, mirror, new_path
from ..files import Session, read_session
from . import _shown
from ._bar import Bar
from ._browser import Upload
from ._choices import LIST_NAME_STYLE, WRAP
from ._job import said
from ._table_columns import TableColumns

#: What the list of bundled logs says of a log of one's own.
OWN = "(a log of your own)"
#: The largest file that is taken from a browser, bytes.
MOST_UPLOAD_BYTES = 100_000_000
LARGEST = "a file up to 100 MB; larger ones by their path"
#: Calls a function elsewhere, hands what it returns to a second one here, or why not to a third.
Begin = Callable[..., None]
#: What is said of a log while there is none: the next run would map another one.
NO_LOG = "no log: choose one"


class Laser:
    """The laser that is carried, as the page's step *Live* names it."""

    def __init__(self) -> None:
        wide: Any = {"style": LIST_NAME_STYLE, "layout": W.Layout(width="auto")}
        models = [HOKUYO]
        with contextlib.suppress(SensorError):  # lds2d is missing: opening says so
            models = [*spinning_models(), HOKUYO]
        self.model: Any = W.Dropdown(options=models, description="laser", **wide)
        hint = "/dev/ttyUSB0; a Hokuyo needs none"
        self.port: Any = W.Combobox(description="port", placeholder=hint, **wide)
        self.mirrored: Any = W.Checkbox(description="the map is mirrored: turn it", indent=False)
        self.mirrored.tooltip = "the angles of this laser count the other way"
        self.start: Any = W.Button(description="Start", tooltip="follow the laser until Stop")
        self.mirrored.layout.width, self.start.layout.width = "auto", "80px"
        self._begun_turned = False
        row = W.Box([self.start, self.mirrored], layout=W.Layout(**WRAP))
        self.view = W.VBox([self.model, self.port, row])
        with contextlib.suppress(SensorError):
            self.list_ports()

    def list_ports(self) -> list[str]:
        """The serial ports that there are now."""
        self.port.options = [port.device for port in ports()]
        return list(self.port.options)

    def named(self) -> tuple[str, str, Path, bool | None]:
        """What `driven` takes, the log in the home folder; a ValueError without a port."""
        model, port = str(self.model.value), str(self.port.value).strip()
        if not port and model != HOKUYO:
            there = ", ".join(self.list_ports()) or "none: plug the laser in"
            raise ValueError(f"choose the port of the {model}, then press Start: {there}")
        self._begun_turned = bool(self.mirrored.value) and model != HOKUYO
        return model, port, Path.home() / new_path(), False if self._begun_turned else None

    @property
    def _is_other(self) -> bool:
        """Whether the tick has changed since *Start*."""
        return bool(self.mirrored.value) != self._begun_turned

    def turning(self, show: Callable[..., object]) -> Callable[..., object]:
        """Show a map that grows, places and words, as the tick is now."""

        def turn(*seen: Any) -> object:
            way = (1, -1 if self._is_other else 1)
            return show(*(each if isinstance(each, str) else each * way for each in seen))

        return turn

    def turned(self, log: Log, path: Path) -> Log:
        """The log of a drive as the tick is now; then the file holds it so."""
        return mirror(path) if self._is_other else log


class Source:
    """A log, the Python `expression` that gives it, and the controls that choose another.

    `taken` is called with each new log, and its session where it has one; `bar` is told why there
    is none, and `begin` reads in the worker. From when another log is asked for until it is there,
    or one that is, it is not `ready`.
    """

    log: Log
    expression: str

    def __init__(
        self,
        first: str | Path | Log,
        taken: Callable[[Log, Session | None], None],
        bar: Bar,
        begin: Begin,
    ) -> None:
        self._taken, self._bar, self._begin = taken, bar, begin
        self._folder, self.ready = "", True  # of an upload
        self._drop: Callable[[], object] = str
        files = readers.data_file("malaga").parent.glob("*/*.log.gz")
        self.names = sorted(path.parent.name for path in files)
        named: Any = {"style": LIST_NAME_STYLE, "layout": W.Layout(width="auto")}
        hint = "my.log.gz, then Enter"
        self.controls: Any = (
            W.Dropdown(options=[OWN, *self.names], description="bundled log", **named),
            W.Text(continuous_update=False, description="or its path", placeholder=hint, **named),
            Upload("or upload it", MOST_UPLOAD_BYTES, self.take),
        )
        bundled, path, upload = self.controls
        self.about = W.HTML()
        self.columns, self._given = TableColumns(self._read_columns), ("", "")
        sent = W.Box([upload, W.Label(LARGEST)], layout=W.Layout(**WRAP))
        self.view = W.VBox([bundled, path, sent, self.columns.view, self.about])
        self.open(first)
        bundled.observe(self._opened, names="value")
        path.observe(self._opened, names="value")

    def open(self, source: str | Path | Log, expression: str = "") -> None:
        """Take the log of a bundled name, of a path, or this one; `ValueError` keeps the other."""
        if isinstance(source, Log):
            words = f"log  # {source.name!r}, the one given to Workbench"
            self._take(source, expression or words)
        elif source in self.names:
            self._take(readers.load(str(source)), f"segmap.load({source!r})")
        else:
            self._take(
                read_source(arrays.file(source, "source")),
                f'segmap.read({str(source)!r}, on_error="skip")',
            )

    def _take(self, found: Log | Session, expression: str) -> None:
        session = found if isinstance(found, Session) else None
        log = found if isinstance(found, Log) else found.log
        if not len(log):
            raise ValueError(f"{log.name} must hold one scan at least, got none")
        self._taken(log, session)
        self.log, self.expression, self.ready = log, expression, True
        self.about.value = _shown.about_html(log)
        self.controls[0].value = log.name if expression == f"segmap.load({log.name!r})" else OWN

    def _opened(self, change: Any) -> None:
        """A bundled log or a path was chosen; the log there is may have set its own name."""
        name = change["new"]
        is_open = self.expression == f"segmap.load({name!r})" and self.ready
        if name in self.names and not is_open:
            self.columns.show()
            with telling(self._refused):
                self.open(name)
        elif name not in ("", OWN, *self.names):
            self._read(Path.cwd(), str(Path(name).expanduser()))

    def _read(self, folder: str | Path, name: str) -> None:
        expression = f'segmap.read({name!r}, on_error="skip")'
        self._given = place = (str(folder), name)
        self._bar.tell(0.0, words := f"reading {escape(Path(name).name)}")
        with contextlib.suppress(ValueError, OSError):
            self.columns.show(_table_in(*place))
        take = partial(self._take, expression=expression)
        self._begin(_read_in_folder, place, take, self._refused, words=words)

    def _read_columns(self, columns: list[str], view: tuple[float, float] | None) -> None:
        """Read the table again by what its columns are now."""
        folder, name = self._given
        way = f"columns={columns!r}" + (f", view={view!r}" if view else "")
        expression = f'segmap.readers.read_csv({name!r}, {way}, on_error="skip")'
        self._begin(
            _read_table_in_folder,
            (folder, name, columns, view),
            lambda log: self._take(log, expression),
            self._refused,
        )

    def _refused(self, text: str) -> None:
        """Say why a log that was asked for is not there; nothing is run now."""
        self.ready, self.controls[0].value, self.about.value = False, OWN, NO_LOG
        self._bar.wrong(text)

    def take(self, name: str, size: int, start: int, content: bytes) -> int:
        """Keep a piece of a file of the browser, and read it when it is whole; what comes next."""
        with telling(self._refused):
            return self._taken_in(escape(Path(name.replace("\0", "")).name), size, start, content)
        return -1

    def take_drive(self, log: Log, path: Path) -> None:
        """Take the log of a drive, as one that is read from its file."""
        self.columns.show()
        self._take(log, f'segmap.read({str(path)!r}, on_error="skip")')

    def _taken_in(self, name: str, size: int, start: int, content: bytes) -> int:
        """The same."""
        name = name or "upload.log"
        if size > MOST_UPLOAD_BYTES:
            raise ValueError(f"{name} has {size / 1e6:.1f} MB: only {LARGEST}")
        if start == 0:
            self.stop()
            self.ready, self.about.value = False, NO_LOG
            self._folder = folder = tempfile.mkdtemp()
            self._drop = weakref.finalize(self, partial(shutil.rmtree, folder, ignore_errors=True))
        if not self._folder:  # it was stopped
            return -1
        with (Path(self._folder) / name).open("ab") as file:
            if file.tell() != start:
                return file.tell()
            end = start + file.write(content)
        self._bar.tell(
            end / max(size, 1), f"uploading {name}, {end / 1e6:.0f} of {size / 1e6:.0f} MB"
        )
        if end >= size:
            self._read(self._folder, name)
        return end if end < size else -1

    def stop(self) -> None:
        """Take no more of what the browser sends, and forget what it has sent."""
        self._drop()
        self._folder = ""


def read_source(path: Path) -> Log | Session:
    """A log, or a session by the end of its name."""
    ours = path.suffix.lower() == ".segmap"
    return read_session(path) if ours else readers.read(path, on_error="skip")


def _read_in_folder(folder: str, name: str) -> Log | Session:
    """A log by its name in a folder, so that what is said of it is what its user knows."""
    with contextlib.chdir(folder):
        try:
            return read_source(Path(name))
        except readers.LogError as fault:  # what follows there is for who writes Python
            raise ValueError(". ".join(str(fault).split("\n")[:2])) from fault


def _read_table_in_folder(
    folder: str, name: str, columns: list[str], view: tuple[float, float] | None
) -> Log:
    """A table in a folder, whose columns are named."""
    with contextlib.chdir(folder):
        return readers.read_csv(name, columns=columns, view=view, on_error="skip")


def _table_in(folder: str, name: str) -> readers.ColumnChoices | None:
    """What the columns of a table may be, and its first rows; None of a log that is none."""
    with contextlib.chdir(folder):
        try:
            if readers.format_of(name) != "table":
                return None
        except readers.UnknownFormat:
            pass
        return readers.column_choices(name)


@contextlib.contextmanager
def telling(say: Callable[[str], object]) -> Iterator[None]:
    """What was refused is a line of text: in a browser nobody sees an exception."""
    try:
        yield
    except (ValueError, OSError) as fault:
        say(said(fault))
