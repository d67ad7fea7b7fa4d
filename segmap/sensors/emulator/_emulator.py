"""The emulated sensor: its unit, its line, and the thread that serves both."""

from __future__ import annotations

import threading
import time
import weakref
from typing import Annotated, Any, Self

import numpy as np

from ... import arrays
from ...arrays import Count, Seconds, at_least, checked
from ._device import WIRE_FAULTS, Fault, Listener, Speaker, Terminal, Unplugged, Wire
from ._unit import Unit, World
from ._worlds import ModelName, Room, furnished_room

#: The thread looks at the clock so often, seconds.
TICK = 0.005


class Device:
    """A line and the thread that serves it; it holds no reference to its Emulator."""

    def __init__(self, unit: Speaker, wire: Wire, end: Terminal | Listener) -> None:
        self.unit, self.wire, self.end = unit, wire, end
        self._thread: threading.Thread | None = None
        self._stopping = threading.Event()
        self._failure: Exception | None = None

    def start(self) -> None:
        """Open the line and serve it in a thread until `stop`."""
        self.end.open()
        self._stopping.clear()
        self._thread = threading.Thread(target=self._run, name="URG emulator", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread and cut the line, and raise what ended it; then a call does nothing."""
        self._stopping.set()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
            self._thread = None
        self.end.close()
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure

    def _run(self) -> None:
        """Serve until the end; what the world raises cuts the line."""
        try:
            self._serve()
        except Exception as error:
            self._failure = error
            self.end.close()

    def _serve(self) -> None:
        """Read, answer and write, again and again."""
        waiting = b""  # could not be written yet
        while not self._stopping.is_set():
            self.end.wait(TICK, writing=bool(waiting))
            self.unit.receive(self.end.read())
            if not waiting:
                try:
                    waiting = self.wire.passed(self.unit.transmit())
                except Unplugged:
                    self.end.close()
                    return
            waiting = waiting[self.end.write(waiting) :]


class PluggedIn:
    """A unit behind the end of a line that is served: `port` is what to open."""

    def __init__(
        self, unit: Speaker, end: Terminal | Listener, rng: np.random.Generator | None
    ) -> None:
        self.wire = Wire(time.monotonic, np.random.default_rng(1) if rng is None else rng)
        self._end, self._device = end, Device(unit, self.wire, end)
        self._finalizer = weakref.finalize(self, self._device.stop)
        self._device.start()

    @property
    def port(self) -> str:
        """The device to open, or the address where it is reached by TCP."""
        return self._end.name

    @checked
    def inject(
        self,
        kind: str,
        *,
        after: Annotated[Count, at_least(0)] = 0,
        seconds: Annotated[Seconds, at_least(0)] = 0.5,
    ) -> None:
        """Plan a fault of the wire, `after` so many more bytes of the sensor.

        "flip" a bit, "lose" a byte, "stale" bytes, "stop" in a reply, "silence" for some seconds,
        "unplug".
        """
        arrays.one_of(kind, "kind", WIRE_FAULTS)
        self.wire.plan(Fault(kind, after, seconds))

    def unplug(self) -> None:
        """Pull the sensor out: the device vanishes, the address refuses."""
        self._device.stop()

    def replug(self) -> None:
        """Plug it in again; a device may have another name."""
        self._device.stop()
        self._device.start()

    def stop(self) -> None:
        """End the thread and free the device; raises what the world raised, once."""
        self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


class Emulator(PluggedIn):
    """A sensor without hardware: `port` is the device or the address to open.

    A device needs Linux or macOS. A thread answers until `stop`, the end of `with`, or until it is
    forgotten. Over TCP one program at a time is served, and others are turned away; a program that
    leaves does not stop the sensor.

    Parameters
    ----------
    world : World or None
        What it sees: `Room`, or any function from the number of a turn to the millimetres
        of all steps, `(769,)` of a URG-04LX, `(1081,)` of a UST-10LX; None for a furnished room.
    model : "URG-04LX" or "UST-10LX"
    tcp : str or None
        `[host:]port` to be reached at by TCP instead of a pseudo-terminal; port 0 takes a free one.
    rng : numpy.random.Generator or None
        Of noise on the line.
    **settings
        Of the sensor itself: `protocol`, `rate`, `usb`, `speed`, `clock`, `stamp`, `streaming` and
        `timing`, as `Unit` says.

    Raises
    ------
    SensorError
        On Windows, which has no pseudo-terminals, without `tcp`.
    OSError
        Where the TCP port is taken.

    Examples
    --------
    >>> from segmap.sensors import UrgSensor
    >>> with Emulator(speed=10) as emulator, UrgSensor(emulator.port) as sensor:
    ...     sensor.scan()  # doctest: +ELLIPSIS
    LaserScan(682 beams, ... valid, t=... s)
    """

    @checked
    def __init__(
        self,
        world: World | None = None,
        *,
        model: ModelName = "URG-04LX",
        tcp: str | None = None,
        rng: np.random.Generator | None = None,
        **settings: Any,
    ) -> None:
        if tcp is not None and not settings.get("usb", True):
            raise ValueError("tcp does not go with usb=False: that is of a device")
        if isinstance(world, Room) and world.model != model:
            raise ValueError(f"model must be {world.model!r}, as the world's is, got {model!r}")
        seen = furnished_room(model) if world is None else world
        self.unit = Unit(seen, model=model, **settings)
        end = Terminal() if tcp is None else Listener(arrays.instance(tcp, "tcp", str))
        super().__init__(self.unit, end, rng)

    def inject(self, kind: str, *, after: int = 0, seconds: float = 0.5) -> None:
        """Plan a fault: of the wire, or of the sensor, at once.

        Those of the sensor are "status" 50 for each scan until `mend`, and clock "wrap".
        """
        if kind == "status":
            self.unit.fail("Motor does not turn.")
        elif kind == "wrap":
            self.unit.wrap_clock()
        else:
            super().inject(kind, after=after, seconds=seconds)

    def mend(self) -> None:
        """Repair the sensor: its scans are whole again."""
        self.unit.fail("")
