"""Lasers that turn without end, as RPLidar, LD19 and YDLidar do, read by the package `lds2d`."""

from __future__ import annotations

import contextlib
import weakref
from collections import deque
from collections.abc import Callable, Iterator
from os import PathLike
from typing import Any, Self

import numpy as np

from .. import arrays
from ..arrays import Seconds, checked
from ..display import pip_install
from ..poses.motions import wrap
from ..scans import LaserScan
from ._host import host_time
from ._lines import PULLED_OUT_ERRORS, Port
from ._port import checked_port, open_port
from ._protocol import SensorError, SensorGone, Silent

#: Bytes without a whole turn; after this many it is another laser or bit rate, or it stands.
FRUITLESS_BYTES = 20_000
#: Turns whose median lasts as long as a turn does.
PERIOD_TURNS = 5
#: In a silence of so many seconds, and of a whole turn, nobody knows how many turns were lost.
LEAST_SILENCE_S = 0.2
#: Degrees that an angle may fall back between two measurements; more: a part of a turn was lost.
MOST_BACK_DEG = 20.0
#: Degrees from a measurement to the next: a YDLidar corrects its angles by 8 where it meets a wall.
MOST_STEP_DEG = 10.0
#: Measurements in a row that must follow each other; fewer were read out of step.
LEAST_RUN = 4
#: A laser has a way once it has swept so many degrees.
SURE_WAY_DEG = 90.0

#: Models of which the makers' manuals are known: all count clockwise, seen from above. The value is
#: whether DTR must be set for the motor to run; None where it does not matter. `lds2d` has more.
KNOWN_MODELS: dict[str, bool | None] = {
    **dict.fromkeys(("LD06", "LD19", "STL19P")),
    **{"RPLIDAR-A1": False, "RPLIDAR-C1": None, "YDLIDAR-X2": None, "YDLIDAR-X4": True},
}


class SpinningLaser:
    """A low-cost laser that turns without end: use it as a context manager.

    Each scan is a whole turn, wherever it began, with its beams counter-clockwise, their own angles
    and their delays. A range of 0 is no measurement; a beam of quality 0 is one like any other.
    Tried on emulated bytes of an LD19 and an RPLidar A1 and on single packets of the makers'
    manuals, not on real lasers.

    Parameters
    ----------
    model : str
        As `spinning_models()` has them: LD19, RPLIDAR-A1, YDLIDAR-X4, ...
    port : str or Path or Port
        A device, as /dev/ttyUSB0, or an open port that does not wait for ever.
    clockwise : bool or None
        Which way its angles count, seen from above; None as the maker says, else it is assumed.
    timeout : float, seconds
        To wait for bytes.
    clock : callable
        Seconds of the host, which only go on; the scans' times are on it.

    Attributes
    ----------
    delivered : int
        Scans handed over.
    assumed : tuple of str
        What neither the maker nor the caller says.

    Raises
    ------
    SensorError
        Where it cannot be opened or falls silent, with what to do.

    Examples
    --------
    >>> with SpinningLaser("LD19", "/dev/ttyUSB0") as laser:  # doctest: +SKIP
    ...     for scan in laser.scans():
    ...         print(scan)
    """

    @checked
    def __init__(
        self,
        model: str,
        port: str | PathLike[str] | Port,
        *,
        clockwise: bool | None = None,
        timeout: Seconds = 2.0,
        clock: Callable[[], float] = host_time,
    ) -> None:
        self.model = arrays.instance(model, "model", str).upper().replace("_", "-")
        driver = _lds2d().core.driver_for(self.model)
        if driver is None:
            arrays.one_of(self.model, "model", spinning_models())
        self.assumed: tuple[str, ...] = ("the beams of a turn follow each other evenly in time",)
        if clockwise is None and self.model not in KNOWN_MODELS:
            self.assumed += (f"the angles of the {self.model} count clockwise",)
        self._turn = 1.0 if clockwise is False else -1.0
        self._clock = arrays.function(clock, "clock", "without arguments, of seconds")
        arrays.number(arrays.call_given(clock, "clock"), "clock()", unit="seconds")
        self.delivered = 0
        rate, port = driver.DEFAULT_BAUD, checked_port(port)
        opened = open_port(port, rate) if isinstance(port, str) else port
        name = getattr(opened, "port", None) or "the port"
        words = f"is there a {self.model} at {name}, at {rate} bit/s, and does it turn?"
        self._transport = _Transport(opened, timeout, clock, words)
        self._driver = driver(self._transport)
        dtr = KNOWN_MODELS.get(self.model)
        self._leave = weakref.finalize(self, _leave, self._driver, opened, dtr)
        with contextlib.suppress(AttributeError, *PULLED_OUT_ERRORS):  # a pseudo-terminal has none
            if dtr is not None:
                opened.dtr = dtr  # type: ignore[attr-defined]
            opened.reset_input_buffer()  # type: ignore[attr-defined]
        with contextlib.suppress(_lds2d().NotSupportedError):
            self._driver.start()

    def scans(self) -> Iterator[LaserScan]:
        """Turn after turn, until the loop is left: 360 degrees of motion, whichever way.

        Raises
        ------
        SensorError
            Where nothing comes, nothing that can be read, or the laser is unplugged or closed.
        """
        beams: list[tuple[float, float, float]] = []
        line, way, swept, period = self._transport, 0.0, 0.0, 0.0
        line.arrived, line.waited = self._clock(), 0.0
        ends = deque([line.arrived], PERIOD_TURNS + 1)
        for point in _in_step(self._driver.points()):
            if line.waited > max(period, LEAST_SILENCE_S):
                beams, swept, line.waited = [], 0.0, 0.0
                ends = deque([line.arrived], PERIOD_TURNS + 1)
            swept += _motion(point.angle_deg - beams[-1][0], way) if beams else 0.0
            if not way and abs(swept) > SURE_WAY_DEG:
                way = float(np.sign(swept))
            if abs(swept) >= 360:
                ends.append(line.arrived)
                period = float(np.median(np.diff(ends)))
                line.fruitless, self.delivered = 0, self.delivered + 1
                yield self._scan(np.array(beams), ends[-1], period)
                beams, swept = [], way * (abs(swept) % 360)
            beams.append((point.angle_deg, point.dist_mm, abs(swept) / 360))

    def _scan(self, beams: Any, end: float, period: float) -> LaserScan:
        """Beams `(n, 3)`, degrees, millimetres and the share of the turn, as a scan."""
        angles, millimetres = wrap(self._turn * np.radians(beams[:, 0])), beams[:, 1]
        ranges, order = np.where(millimetres > 0, millimetres / 1000, np.nan), np.argsort(angles)
        return LaserScan(
            ranges[order],
            angles[order],
            time=end - period,
            delays=np.minimum(beams[order, 2], 1.0) * period,
        )

    def close(self) -> None:
        """Stop the motor where the host can, and free the port; another thread may call it."""
        self._transport.closed = True
        self._leave()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        open_ = "open" if self._leave.alive else "closed"
        return f"SpinningLaser({self.model}, {open_}, {self.delivered} scans)"


def spinning_models() -> tuple[str, ...]:
    """A name of each model, those with known manuals first; a SensorError without `lds2d`."""
    models = _lds2d()
    drivers = {models.core.driver_for(name): name for name in models.available_models()}
    documented = {models.core.driver_for(name) for name in KNOWN_MODELS}
    return (*KNOWN_MODELS, *(name for driver, name in drivers.items() if driver not in documented))


class _Transport:
    """What a driver reads from and writes to; it raises where the port has nothing to say."""

    def __init__(self, port: Port, seconds: float, clock: Callable[[], float], advice: str) -> None:
        self._port, self._seconds, self._clock, self._advice = port, seconds, clock, advice
        self.fruitless, self.arrived, self.waited, self.closed = 0, clock(), 0.0, False

    def read(self, size: int) -> bytes:
        """At most so many bytes, at least one."""
        begun, late = self._clock(), False
        while not late:
            waited = self._clock() - begun  # before it is read: this program may have been slow
            late = waited >= self._seconds
            heard = self._ask(lambda: self._port.read(min(max(self._port.in_waiting, 1), size)))
            if heard:
                self.fruitless, self.arrived = self.fruitless + len(heard), self._clock()
                self.waited = max(self.waited, waited)
                if self.fruitless > FRUITLESS_BYTES:
                    words = f"{self.fruitless} bytes and no whole turn in them"
                    raise SensorError(f"{words}: {self._advice}")
                return heard
        raise Silent(f"nothing came for {self._seconds:g} s: {self._advice}")

    def write(self, data: bytes) -> int:
        """Send bytes."""
        return self._ask(lambda: self._port.write(data)) or 0

    def close(self) -> None:
        """Free the port."""
        self._port.close()

    def _ask(self, call: Callable[[], Any]) -> Any:
        try:
            return call()
        except (*PULLED_OUT_ERRORS, TypeError) as error:  # a port that is closed meanwhile
            if self.closed:
                raise SensorError("the sensor is closed: make a new SpinningLaser") from None
            words = f"the sensor is gone ({error}): plug it in, open it again"
            raise SensorGone(f"{words}; {self._advice}") from error


def _in_step(points: Iterator[Any]) -> Iterator[Any]:
    """Measurements that follow each other: bytes that are read out of step make angles that jump.

    An RPLidar has two check bits in five bytes, so one in four of such readings looks right.
    """
    run: list[Any] = []
    angle, count = 0.0, 0
    for point in points:
        is_near = abs((point.angle_deg - angle + 180) % 360 - 180) <= MOST_STEP_DEG
        angle, count = point.angle_deg, count + 1 if is_near else 1
        run = [*run, point] if is_near else [point]
        if count >= LEAST_RUN:
            yield from run
            run = []


def _motion(difference: float, way: float) -> float:
    """Degrees from one measurement to the next, though a part of the turn may have been lost.

    `way` is 1 where angles grow, -1 where they fall, and 0 where that is not known yet.
    """
    if not way:
        return (difference + 180) % 360 - 180
    return way * ((way * difference + MOST_BACK_DEG) % 360 - MOST_BACK_DEG)


def _leave(driver: Any, port: Port, dtr: bool | None) -> None:
    """Stop the motor and free the port; whatever happens, the port is closed."""
    try:
        with contextlib.suppress(SensorError, _lds2d().NotSupportedError):
            driver.stop()
        if dtr is not None:
            port.dtr = not dtr  # type: ignore[attr-defined]
    except (AttributeError, TypeError, *PULLED_OUT_ERRORS):
        pass
    finally:
        with contextlib.suppress(*PULLED_OUT_ERRORS):
            port.close()


def _lds2d() -> Any:
    try:
        import lds2d
    except ImportError as error:
        raise SensorError(f"such lasers need lds2d: {pip_install('live')}") from error
    return lds2d
