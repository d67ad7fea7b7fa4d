"""One connection to a sensor: opened, asked, found again after unplugging, always shut."""

import contextlib
import time
from collections.abc import Callable, Sequence
from typing import TypeVar

from ._clock import Clock
from ._coding import SensorError
from ._connect import TRIES, Refused, ask, connect, quit, refused
from ._line import LOST, Lines, Port, SensorGone
from ._ports import find_port, open_port
from ._replies import Geometry, Reply, parse_geometry, parse_info

#: Waits between attempts to find an unplugged sensor again double from the first to the last, s.
BACK_OFF = (0.1, 2.0)
#: Statuses that say that it is so already: the laser is on, the stream runs.
ALREADY = {"BM": "02", "MD": "99", "MS": "99"}

Told = TypeVar("Told")


class Session:
    """The port that is open now, if any, and who answers there.

    Parameters
    ----------
    port : str or Port
    rates : sequence of int, bits a second
    patience : float, seconds
    clock : callable
    """

    info: dict[str, str]
    geometry: Geometry
    rate: int

    def __init__(
        self, port: str | Port, rates: Sequence[int], patience: float, clock: Clock
    ) -> None:
        self.port, self.rates, self.clock = port, tuple(rates), clock
        self.patience, self.quiet = patience, 0.3 * patience
        self.opened: Lines | None = None
        #: Whether the laser is on or a stream runs.
        self.busy = False

    @property
    def lines(self) -> Lines:
        """What is said on the open port.

        Raises
        ------
        SensorError
            Where it is closed.
        """
        if self.opened is None:
            raise SensorError("the sensor is closed: make a new UrgSensor")
        return self.opened

    def open(self) -> None:
        """Open the port and ask the sensor who it is; a failure leaves the port free.

        Raises
        ------
        SensorError
        """
        self.busy = False
        try:
            self.opened = Lines(self._open_port(), self.clock)
            self.rate = connect(self.opened, self.rates, self.quiet)
            told, self.geometry = self._told("PP", _limits)
            self.info = parse_info(self.ask("VV").body) | told
        except BaseException:
            self.shut()
            raise

    def find_again(self, gone: SensorGone, seconds: float) -> None:
        """Wait for an unplugged sensor, longer and longer between attempts.

        Raises
        ------
        SensorGone
            Where it does not come back in this time.
        """
        self.shut()
        until, wait = self.clock() + seconds, BACK_OFF[0]
        while (left := until - self.clock()) > 0:
            time.sleep(min(wait, left))
            wait = min(2 * wait, BACK_OFF[1])
            try:
                return self.open()
            except SensorError as error:
                gone = SensorGone(f"not back within {seconds:g} s: {error}")
        raise gone

    def ask(self, command: str) -> Reply:
        """The reply to a command, asked again where it was damaged; no status but success.

        Raises
        ------
        SensorError
        """
        return self._told(command, lambda reply: reply)

    def quit(self) -> None:
        """End a stream and switch the laser off, where either is on."""
        if self.busy:
            self.busy = False
            any(quit(self.lines, self.quiet) == b"00P" for _ in range(TRIES))
            self.lines.silence(0.02)

    def shut(self) -> None:
        """Laser off, port free; whatever happens, the port is closed."""
        lines, self.opened = self.opened, None
        if lines is None:
            return
        try:
            with contextlib.suppress(SensorError):
                any(quit(lines, self.quiet) == b"00P" for _ in range(TRIES))
        finally:
            with contextlib.suppress(*LOST):
                lines.port.close()

    def _open_port(self) -> Port:
        if not isinstance(self.port, str):
            return _hurried(self.port)
        device = find_port() if self.port == "auto" else self.port
        return open_port(device, self.rates[0])

    def _told(self, command: str, parse: Callable[[Reply], Told]) -> Told:
        """What a reply says, asked again where it cannot be read."""
        fault = SensorError("")
        for _ in range(TRIES):
            try:
                return parse(_granted(command, ask(self.lines, command, self.patience)))
            except (SensorGone, Refused):
                raise
            except SensorError as error:
                fault = error
                self.lines.silence(self.quiet / 4)
        raise fault


def _granted(command: str, reply: Reply) -> Reply:
    """A reply whose status says that it is so, or was so already."""
    if reply.status not in ("00", ALREADY.get(command[:2], "00")):
        raise Refused(str(refused(command, reply.status)))
    return reply


def _limits(reply: Reply) -> tuple[dict[str, str], Geometry]:
    """What PP says; one wrong bit in it would turn every scan."""
    told = parse_info(reply.body, strict=True)
    return told, parse_geometry(told)


def _hurried(port: Port) -> Port:
    """A port of the caller's, which must not wait for ever: pyserial's do unless told."""
    if not callable(getattr(port, "read", None)):
        raise TypeError(f"port must be a device, 'auto' or an open serial port, got {port!r}")
    if getattr(port, "timeout", 0.0) is None:
        raise ValueError("the port must have a timeout, as serial.Serial(device, timeout=0.02) has")
    return port
