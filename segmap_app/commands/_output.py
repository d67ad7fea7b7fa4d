"""What a command says, in a user's words: numbers with units, faults in one plain line."""

from __future__ import annotations

import json
import math
import os
import re
import signal
import socket
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from segmap.files import escape
from segmap.progress import Compiling, time_left, told
from segmap.readers import HeadError, LogError, UnknownFormat
from segmap.scans import Log

if TYPE_CHECKING:
    from tqdm import tqdm

#: What a user can mend: a damaged log, a wrong argument, a full disk, a missing package.
FAULTS = (ValueError, OSError, ImportError, MemoryError)
#: Exit code where a log gave no map.
NO_MAP = 3
#: Time after Control-C at which the program ends in the middle of a compiled loop, seconds.
STOP_PATIENCE_S = 0.5


class Usage(ValueError):
    """A command that is not understood."""


def percent(share: float) -> str:
    """A share to a tenth of a per cent."""
    return f"{100 * share:.1f} %"


def metres(value: float) -> str:
    """A length: millimetres below a tenth of a metre."""
    return f"{1000 * value:.1f} mm" if abs(value) < 0.1 else f"{value:.2f} m"


def seconds(value: float) -> str:
    """A time: milliseconds below a tenth of a second."""
    return f"{1000 * value:.0f} ms" if value < 0.1 else f"{value:.1f} s"


class Report:
    """What a command says of one log: a line a thing, or all of it as one JSON object at the end.

    `found` holds it by the words that begin the lines: the text of each and the figures in it.

    Examples
    --------
    >>> report = Report("it.log", json=True)
    >>> report.line("extracted", "3 segments", segments=3)
    >>> report.end()
    {"source": "it.log", "extracted": {"text": "3 segments", "segments": 3}}
    """

    def __init__(self, source: str, *, json: bool = False, quiet: bool = False) -> None:
        self._json, self._quiet = json, quiet
        self.found: dict[str, Any] = {"source": source}
        self._last: dict[str, Any] = {}
        self._assumed: tuple[str, ...] = ()

    def begin(self, log: Log, title: str) -> None:
        """Which log comes now."""
        self.found["log"], self._assumed = log.name, log.assumed
        self.say(title)

    def say(self, text: str = "") -> None:
        """Print a line that is no figure of the log; in JSON there is no place for it."""
        if not (self._json or self._quiet):
            print_line(text)

    def line(self, word: str, text: str, **figures: Any) -> None:
        """One thing about the log, below its name; without a word it belongs to the line before."""
        if word:
            self._last = {"text": text} | {k: for_json(v) for k, v in figures.items()}
            self.found[word] = self._last
        else:
            self._last.setdefault("notes", []).append(text)
        self.say(f"  {word:<9} {text}")

    def assumptions(self) -> None:
        """What the file of the log does not say and was taken to be so: beside the verdict."""
        if self._assumed:
            self.line("assumed", "; ".join(self._assumed), facts=list(self._assumed))

    def for_session(self) -> dict[str, Any]:
        """All of it as a session holds it: halves of letters in a name are written out."""
        text = json.dumps(self.found, ensure_ascii=False)
        escaped = re.sub(r"[\ud800-\udfff]", lambda half: rf"\\u{ord(half[0]):x}", text)
        return dict(json.loads(escaped))

    def end(self) -> None:
        """Print the object, where JSON was asked for."""
        if self._json:
            print_line(json.dumps(self.found))


def for_json(value: Any) -> Any:
    """A figure as JSON can hold it: nothing in the place of NaN."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def print_line(text: str = "") -> None:
    """Print one line; a bar that is shown moves below it."""
    from tqdm import tqdm

    tqdm.write(escape(text), file=sys.stdout)
    sys.stdout.flush()


def print_error(text: str) -> None:
    """Say beside the output what went wrong."""
    lines = "\n".join(map(escape, text.split("\n")))
    print(f"segmap: {lines}", file=sys.stderr)


def reason(error: BaseException) -> str:
    """Why something failed, in one line; of what is no log, or asks, also what to do."""
    if isinstance(error, UnknownFormat | HeadError):
        return str(error)
    if isinstance(error, LogError) and error.line:
        return f"{error} (--skip leaves damaged lines out)"
    if isinstance(error, OSError) and error.strerror:
        return f"{escape(error.filename)}: {error.strerror}" if error.filename else error.strerror
    if isinstance(error, MemoryError):
        return "there is not enough memory for this"
    return " ".join(str(error).split()) or type(error).__name__


@contextmanager
def plain_warnings() -> Iterator[None]:
    """Show the warnings of the library as short lines, each once for each log that deserves it."""

    def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        """One line for a warning of the library."""
        from tqdm import tqdm  # it draws the bar anew below the line

        if issubclass(category, UserWarning):
            tqdm.write(f"warning: {escape(message)}", file=sys.stderr)

    with warnings.catch_warnings():
        warnings.simplefilter("always", UserWarning)
        warnings.showwarning = show
        yield


def progress(total: int, unit: str) -> tqdm[Any]:
    """A bar on a terminal, and nothing elsewhere, nor where there is one step only."""
    from tqdm import tqdm

    hidden = True if total == 1 else None
    return tqdm(total=total, unit=unit, disable=hidden, leave=False)


@contextmanager
def progress_bars(*, quiet: bool = False) -> Iterator[None]:
    """Show on a terminal how far long work says it is, below the bar that `progress` makes."""
    if quiet or not sys.stderr.isatty():
        yield
        return
    from tqdm import tqdm

    bars: list[tqdm[Any]] = []
    shape = "{desc} |{bar}|"

    def show(share: float, words: str) -> None:
        """Let the bar go on, or begin anew with other work."""
        if not bars:
            bars.append(tqdm(total=1.0, delay=0.5, miniters=0, leave=False, bar_format=shape))
        (bar,) = bars
        if share < bar.n or words.split()[0] != bar.desc.split(" ")[0]:
            bar.reset()
        rest = "" if isinstance(words, Compiling) else time_left(time.time() - bar.start_t, share)
        bar.bar_format = f"{shape} {rest}"
        bar.set_description_str(escape(words), refresh=False)
        bar.update(share - bar.n)

    try:
        with told(show):
            yield
    finally:
        for bar in bars:
            bar.close()


@contextmanager
def stop_early() -> Iterator[None]:
    """End at Control-C also where a compiled loop runs, which hears nothing of it."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard, told_of = socket.socketpair()
    told_of.setblocking(False)
    ended = threading.Event()

    def watch() -> None:
        """Wait for the signal, and then for the program to end by itself."""
        if heard.recv(1) and not ended.wait(STOP_PATIENCE_S):
            print_error("stopped")
            os._exit(130)

    before = signal.set_wakeup_fd(told_of.fileno())
    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        signal.set_wakeup_fd(before)
        told_of.close()
        watcher.join()
        heard.close()
