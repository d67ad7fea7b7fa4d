"""The pseudo-terminal that programs open as a serial port, and everything that goes wrong on it."""

from __future__ import annotations

import contextlib
import os
import select
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ._unit import RATES, Unit

#: The thread looks at the clock so often, seconds.
TICK = 0.005
#: Faults of the wire, by name.
FAULTS = ("flip", "lose", "stale", "stop", "silence", "unplug")
#: What a buffer may hold from before: the end of a scan and a piece of an answer.
STALE = b"0AI0AI0AJ0AK\n\nGD00440\n00P\n"


class Fault(NamedTuple):
    """A fault that happens after so many more bytes; silence lasts some seconds."""

    kind: str
    after: int
    seconds: float = 0.0


class Unplugged(Exception):
    """The wire was pulled out."""


class Wire:
    """Passes bytes on, and spoils them where it was told to.

    Parameters
    ----------
    clock : callable
        Seconds.
    rng : numpy.random.Generator
        Chooses which bit flips.
    """

    def __init__(self, clock: Callable[[], float], rng: np.random.Generator) -> None:
        self.clock, self.rng = clock, rng
        self.happened: list[str] = []
        self._planned: list[Fault] = []
        self._lock = threading.Lock()
        self._mute_until = -np.inf
        self._stopped = False

    def plan(self, fault: Fault) -> None:
        """Add a fault to those that will happen."""
        with self._lock:
            self._planned = sorted([*self._planned, fault], key=lambda f: f.after)

    def passed(self, data: bytes) -> bytes:
        """The bytes that arrive of those that are sent.

        Raises
        ------
        Unplugged
        """
        arrived = b""
        with self._lock:
            while self._planned and self._planned[0].after < len(data):
                fault, *rest = self._planned
                arrived += self._quiet(data[: fault.after])
                data = self._struck(fault, data[fault.after :])
                self._planned = [f._replace(after=max(f.after - fault.after, 0)) for f in rest]
            self._planned = [f._replace(after=f.after - len(data)) for f in self._planned]
            return arrived + self._quiet(data)

    def _struck(self, fault: Fault, data: bytes) -> bytes:
        """The bytes after a fault at the first of them."""
        self.happened.append(fault.kind)
        if fault.kind == "unplug":
            raise Unplugged
        if fault.kind == "flip":
            return bytes([data[0] ^ 1 << int(self.rng.integers(8))]) + data[1:]
        if fault.kind == "lose":
            return data[1:]
        if fault.kind == "stale":
            return STALE + data
        if fault.kind == "silence":
            self._mute_until = self.clock() + fault.seconds
        self._stopped = self._stopped or fault.kind == "stop"
        return data

    def _quiet(self, data: bytes) -> bytes:
        """Nothing while the wire is silent, and nothing of the rest of a reply that stopped."""
        if self.clock() < self._mute_until:
            return b""
        if self._stopped:
            _, end, data = data.partition(b"\n\n")
            self._stopped = not end
        return data


class Device:
    """A pseudo-terminal and the thread that serves it; it holds no reference to its Emulator."""

    def __init__(self, unit: Unit, wire: Wire, link: Path | None) -> None:
        self.unit, self.wire, self.link = unit, wire, link
        self.name = ""
        self._ends: tuple[int, int] | None = None
        self._thread: threading.Thread | None = None
        self._stopping = threading.Event()

    def start(self) -> None:
        """Open the pseudo-terminal, with its link, and serve it in a thread until `stop`."""
        import tty

        master, slave = os.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        self.name, self._ends = os.ttyname(slave), (master, slave)
        try:
            self._make_link()
        except OSError:
            self._free()
            raise
        self._stopping.clear()
        self._thread = threading.Thread(target=self._serve, name="URG emulator", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread, close both ends and remove the link; a second call does nothing."""
        self._stopping.set()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
            self._thread = None
        self._free()

    def _make_link(self) -> None:
        """Link to the device: a link that was left behind is replaced, a file never."""
        if self.link is not None:
            if self.link.is_symlink():
                self.link.unlink()
            self.link.symlink_to(self.name)

    def _free(self) -> None:
        ends, self._ends = self._ends, None
        if self.link is not None and ends and self.link.is_symlink():
            self.link.unlink()
        for end in ends or ():
            os.close(end)

    def _serve(self) -> None:
        waiting = b""
        try:
            while not self._stopping.is_set() and self._ends:
                waiting = self._step(self._ends[0], waiting)
        except Unplugged:
            self._free()

    def _step(self, master: int, waiting: bytes) -> bytes:
        """Read, answer, write once; the bytes that could not be written yet."""
        select.select([master], [master] if waiting else [], [], TICK)
        heard, fits = self._read(master), self._fits(master)
        if fits:
            self.unit.receive(heard)
        elif heard:
            waiting += self.wire.rng.bytes(len(heard))
        if not waiting:
            sent = self.wire.passed(self.unit.transmit())
            waiting = sent if fits else bytes(b ^ 0xA5 for b in sent)
        with contextlib.suppress(BlockingIOError):
            waiting = waiting[os.write(master, waiting) :] if waiting else b""
        return waiting

    def _read(self, master: int) -> bytes:
        try:
            return os.read(master, 4096)
        except BlockingIOError:
            return b""

    def _fits(self, master: int) -> bool:
        """Whether the host talks at the sensor's bit rate: the terminal tells both its ends."""
        import termios

        if self.unit.usb:
            return True
        known: dict[Any, int] = {
            getattr(termios, f"B{rate}"): rate for rate in RATES if hasattr(termios, f"B{rate}")
        }
        speed = termios.tcgetattr(master)[5]
        return known.get(speed) == (self.unit.rate if self.unit.rate in known.values() else None)
