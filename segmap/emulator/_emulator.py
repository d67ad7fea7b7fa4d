"""The emulated sensor at a pseudo-terminal, which programs open as they open a serial port."""

import contextlib
import os
import select
import threading
import time
import weakref
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from ..hokuyo import SensorError
from ._unit import RATES, Unit
from ._wire import FAULTS, Fault, Unplugged, Wire
from ._worlds import World, furnished_room

#: The thread looks at the clock so often, seconds.
TICK = 0.005


class Emulator:
    """A URG-04LX without hardware: `port` is the device to open.

    For Linux and macOS. A thread answers until `stop`, the end of `with`, or until it is forgotten.

    Parameters
    ----------
    world : World or None
        What it sees: `Room`, `Replay`, or any function from the number of a turn to `(769,)`
        millimetres; None for a furnished room.
    protocol : "2.0", "1.1" or "1.1 only"
        What it speaks after power-up; the last has firmware that cannot switch.
    rate : int, bits a second
        That it is left at.
    usb : bool
        False makes it an RS-232 sensor: the rate must match and slows it down.
    speed : float
        Its seconds go by so much faster.
    clock : callable
        Seconds.
    stamp : int, milliseconds
        Its own clock at power-up; it wraps at 2 ** 24.
    streaming, timing : bool
        Left streaming, or in time mode, by a host that crashed.
    link : str or Path or None
        A symbolic link to make, which names the device, the same after `replug`.
    rng : numpy.random.Generator or None
        Of noise on the line.

    Raises
    ------
    SensorError
        On Windows, which has no pseudo-terminals.
    OSError
        Where the link cannot be made, or a file has its name.

    Examples
    --------
    >>> from segmap.hokuyo import UrgSensor
    >>> with Emulator(speed=10) as emulator, UrgSensor(emulator.port) as sensor:
    ...     sensor.scan()  # doctest: +ELLIPSIS
    LaserScan(682 beams, ... valid, t=... s)
    """

    def __init__(
        self,
        world: World | None = None,
        *,
        protocol: str = "2.0",
        rate: int = 19200,
        usb: bool = True,
        speed: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
        stamp: int = 0,
        streaming: bool = False,
        timing: bool = False,
        link: str | Path | None = None,
        rng: np.random.Generator | None = None,
    ) -> None:
        if not hasattr(os, "openpty"):
            raise SensorError("the emulator needs pseudo-terminals: Linux, macOS, or WSL")
        self.unit = Unit(
            world or furnished_room(),
            protocol=protocol,
            rate=rate,
            usb=usb,
            speed=speed,
            clock=clock,
            stamp=stamp,
        )
        self.unit.timing = timing
        if streaming:
            self.unit.start_stream()
        self.wire = Wire(time.monotonic, np.random.default_rng(1) if rng is None else rng)
        self._link = None if link is None else Path(link)
        self._device = _Device(self.unit, self.wire, self._link)
        self._finalizer = weakref.finalize(self, self._device.stop)
        self._device.start()

    @property
    def port(self) -> str:
        """The device to open, or the link to it."""
        return str(self._link or self._device.name)

    def inject(self, kind: str, *, after: int = 0, seconds: float = 0.5) -> None:
        """Let a fault happen.

        Parameters
        ----------
        kind : str
            Of the wire: "flip" a bit, "lose" a byte, "stale" bytes, "stop" in a reply, "silence",
            "unplug". Of the sensor: "status" 50 for each scan until `mend`, clock "wrap".
        after : int
            So many more bytes of the sensor pass before; faults of the sensor come at once.
        seconds : float
            Length of a silence.
        """
        if kind == "status":
            self.unit.trouble = "Motor does not turn."
        elif kind == "wrap":
            self.unit.stamp = (1 << 24) - 50 - 100 * (self.unit.turn() + 2)
        elif kind in FAULTS:
            self.wire.plan(Fault(kind, after, seconds))
        else:
            raise ValueError(f"kind must be one of {(*FAULTS, 'status', 'wrap')}, got {kind!r}")

    def mend(self) -> None:
        """The sensor works well again."""
        self.unit.trouble = ""

    def unplug(self) -> None:
        """Pull the sensor out: the device vanishes."""
        self._device.stop()

    def replug(self) -> None:
        """Plug it in again; without `link` the device may have another name."""
        self._device.stop()
        self._device.start()

    def stop(self) -> None:
        """End the thread and free the device; nothing happens the second time."""
        self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.stop()


class _Device:
    """A pseudo-terminal and the thread that serves it; knows nothing of the Emulator."""

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
        """Name the device, in the place of a link that was left behind, but of no file."""
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
