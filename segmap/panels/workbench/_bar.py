"""How far the work is: a bar, words, and the time that is left."""

from __future__ import annotations

import threading
import time
from typing import Any

import ipywidgets as W

from ...compiled import COMPILING
from ...files import as_html
from ...progress import EARLY, time_left


class Bar:
    """What a listener of `segmap.progress` is told, in the browser.

    Attributes
    ----------
    bar, state : controls
    """

    def __init__(self) -> None:
        self.bar: Any = W.FloatProgress(max=1.0, layout=W.Layout(flex="1 1 90px", width="90px"))
        self.state: Any = W.HTML()
        self.state.add_class("segmap-state")  # canvas.js makes it heard when it changes
        self._words, self._begun, self._share = "-", 0.0, 0.0

    def say(self, text: str, share: float | None = None) -> None:
        """One line in the place of the one before."""
        self.state.value = as_html(text)
        if share is not None:
            self.bar.value = self._share = share

    def tell(self, share: float, words: str) -> None:
        """Show how much is done of what."""
        if share < self._share or words.split()[0] != self._words.split()[0]:
            self._begun = time.monotonic()  # another kind of work
        self._words, self._share = words, share
        self.tick()

    def tick(self) -> None:
        """Say it with the time that it takes still, or has taken."""
        taken, share = time.monotonic() - self._begun, self._share
        spent = f", {taken:.0f} s so far" if taken >= EARLY else " ..."
        if not self._words.startswith(COMPILING) and (left := time_left(taken, share)):
            spent = f", {left}"
        self.say(f"{self._words}{spent}", share)

    def watch(self, work: threading.Thread) -> None:
        """Let the time go on while a thread works, in silence too."""
        while work.is_alive():
            work.join(1.0)
            if work.is_alive():
                self.tick()
