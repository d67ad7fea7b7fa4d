"""The line that programs open, a pseudo-terminal, and the thread that serves it."""

from __future__ import annotations

import os
import select
import threading
from typing import Any, Self

from .._protocol import SensorError

#: Bytes read at once.
READ_PIECE_BYTES = 4096
#: The thread looks at the clock so often, seconds.
TICK = 0.005


class Terminal:
    """A pseudo-terminal that programs open as a serial port."""

    def __init__(self) -> None:
        if not hasattr(os, "openpty"):
            raise SensorError("the emulator needs pseudo-terminals: Linux, macOS, or WSL; or tcp=0")
        #: What a program opens.
        self.name = ""
        self._ends: tuple[int, ...] = ()  # the emulator's, and the one that programs open

    def open(self) -> None:
        """Make the line."""
        import tty

        master, slave = os.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        self.name, self._ends = os.ttyname(slave), (master, slave)

    def close(self) -> None:
        """Cut it; a second call does nothing."""
        ends, self._ends = self._ends, ()
        for end in ends:
            os.close(end)

    def wait(self, seconds: float, *, writing: bool) -> None:
        """Until something comes, or can be written, at most so long."""
        select.select(self._ends[:1], self._ends[:1] if writing else (), (), seconds)

    def read(self) -> bytes:
        """What has come."""
        try:
            return os.read(self._ends[0], READ_PIECE_BYTES)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> int:
        """How many of these bytes went."""
        try:
            return os.write(self._ends[0], data) if data else 0
        except BlockingIOError:
            return 0


class PluggedIn:
    """A unit at one end of a line, and the thread that serves it: `port` is what to open.

    The unit takes bytes of the host, `receive(bytes)`, and has some to send, `transmit()`.
    """

    #: What makes the line.
    line: Any = Terminal

    def __init__(self, unit: Any) -> None:
        self.unit, self._end = unit, self.line()
        self._thread: threading.Thread | None = None
        self._stopping = threading.Event()
        self._failure: Exception | None = None
        self.start()

    @property
    def port(self) -> str:
        """What to open; after another start it may have another name."""
        return str(self._end.name)

    def start(self) -> None:
        """Open the line and serve it in a thread until `stop`."""
        self._end.open()
        self._stopping.clear()
        self._thread = threading.Thread(target=self._run, name="URG emulator", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread and cut the line, as who pulls it out; raises what ended it, once."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        self._end.close()
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure

    def _run(self) -> None:
        """Read, answer and write, again and again; what the unit raises cuts the line."""
        waiting = b""  # could not be written yet
        try:
            while not self._stopping.is_set():
                self._end.wait(TICK, writing=bool(waiting))
                self.unit.receive(self._end.read())
                waiting = waiting or self.unit.transmit()
                waiting = waiting[self._end.write(waiting) :]
        except EOFError:  # it was pulled out
            self._end.close()
        except Exception as error:
            self._failure = error
            self._end.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
