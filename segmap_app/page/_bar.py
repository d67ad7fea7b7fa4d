"""The work beside the page, one thing at a time: a bar, words, and the time that is left."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import ipywidgets as W

from segmap.files import as_html
from segmap.progress import FIRST_ESTIMATE_S, Compiling, Stopped, time_left, told

from ._job import Worker, said


class Bar:
    """What a listener of `segmap.progress` is told, in the browser.

    Attributes
    ----------
    bar, state : controls
    """

    def __init__(self) -> None:
        self.bar: Any = W.FloatProgress(max=1.0, layout=W.Layout(flex="1 1 90px", width="90px"))
        self.state: Any = W.HTML(layout=W.Layout(flex="3 1 260px"))
        self.state.add_class("segmap-state")  # canvas.js makes it heard when it changes
        self._words, self._begun, self._share, self._under_way = "-", 0.0, 0.0, False
        self._lock = threading.RLock()  # a tick that has begun is shown before the last word

    def say(self, text: str, share: float | None = None) -> None:
        """One line in the place of the one before; what was told until now has ended."""
        with self._lock:
            self._under_way = False
            self._show(text, share)

    def wrong(self, text: str, share: float | None = None) -> None:
        """One line that says why something was not done, in red."""
        with self._lock:
            self.say(text, share)
            self.state.add_class("segmap-wrong")

    def tell(self, share: float, words: str) -> None:
        """Show how much is done of what."""
        with self._lock:
            if share < self._share or words.split()[0] != self._words.split()[0]:
                self._begun = time.monotonic()  # another kind of work
            self._words, self._share, self._under_way = words, share, True
            self.tick()

    def tick(self) -> None:
        """Say it with the time that it takes still, or has taken; nothing where it has ended."""
        with self._lock:
            if self._under_way:
                taken, share = time.monotonic() - self._begun, self._share
                spent = f", {taken:.0f} s so far" if taken >= FIRST_ESTIMATE_S else " ..."
                if isinstance(self._words, Compiling):
                    spent = " ..."
                elif estimate := time_left(taken, share):
                    spent = f", {estimate}"
                self._show(f"{self._words}{spent}", share)

    def _show(self, text: str, share: float | None) -> None:
        self.state.remove_class("segmap-wrong")
        self.state.value = as_html(text)
        if share is not None:
            self.bar.value = self._share = share

    def watch(self, work: threading.Thread) -> None:
        """Let the time go on while a thread works, in silence too."""
        while work.is_alive():
            work.join(1.0)
            if work.is_alive():
                self.tick()


class Work:
    """A worker, the thread that waits for it, and the bar that is told how far it is."""

    _worker: Worker
    _thread: threading.Thread
    _bar: Bar
    #: Greys what cannot be done now; what is done where a function raised, and said of it.
    _settle: Callable[..., None]
    _failed: Callable[[Callable[..., Any]], str]

    def wait(self) -> None:
        """Wait for what a click has begun: a run, or a file that is read."""
        if self._thread.is_alive():
            self._thread.join()

    def _begin(
        self,
        function: Callable[..., Any],
        given: tuple[Any, ...],
        then: Callable[[Any], None],
        failed: Callable[[str], object] = str,
        *,
        words: str = "starting",
    ) -> None:
        """Call a function in the worker, and hand what it returns to another one here.

        Why it did not is said here, and handed to `failed`, nothing where it was stopped.
        """
        if self._thread.is_alive():
            self._bar.wrong("something is running: wait for it, or press Stop, then try again")
            return
        self._bar.tell(0.0, words)
        self._thread = threading.Thread(target=self._wait, args=(function, given, then, failed))
        self._thread.daemon = True
        self._settle(busy=True)
        self._thread.start()
        threading.Thread(target=self._bar.watch, args=[self._thread], daemon=True).start()

    def _wait(
        self,
        function: Callable[..., Any],
        given: tuple[Any, ...],
        then: Callable[[Any], None],
        failed: Callable[[str], object],
    ) -> None:
        try:
            with told(self._bar.tell):
                then(self._worker.do(function, *given))
        except Exception as fault:
            consequence, reason = self._failed(function), said(fault)
            failed("" if isinstance(fault, Stopped) else reason)
            self._bar.wrong(f"{reason}{consequence}", 0.0)
        finally:
            self._settle(busy=False)
