"""Ports of sensors, and lines from one within bounded time and of bounded length."""

from __future__ import annotations

import errno
import time
from collections.abc import Callable, Iterator
from os import PathLike, fspath
from typing import Any, NamedTuple, Protocol

from .. import arrays
from ._protocol import SensorError
from ._tcp import is_address, open_tcp, parse_address

try:
    from termios import error as TerminalError
except ImportError:  # Windows
    TerminalError = OSError  # type: ignore[misc, assignment]

#: No line of the protocol is longer, block or information, in bytes.
LONGEST = 512
#: No reply has more lines: 2161 steps of three characters are 102 blocks.
MOST_LINES = 128
#: A sensor that has talked for so long without an answer is not going to give one, seconds.
ENDLESS = 3.0
#: What ports raise when they are pulled out; serial.SerialException is an OSError.
LOST = (OSError, TerminalError)
#: USB vendor of Hokuyo.
VENDOR = 0x15D1
#: A read comes back after this, seconds, with what there is.
READ = 0.02
#: A sensor that takes nothing for so long has gone, seconds.
WRITE = 1.0

_ADVICE = {
    errno.EACCES: "you may not use it: join the group that owns it, `dialout` on Debian and Ubuntu",
    errno.EPERM: "you may not use it: join the group that owns it, `dialout` on Debian and Ubuntu",
    errno.ENOENT: "it is not there: is the sensor plugged in? `python -m segmap.hokuyo list` tells"
    "; one on Ethernet is named as tcp://192.168.0.10",
    errno.EBUSY: "another program uses it: close that first",
    errno.EAGAIN: "another program uses it: close that first",
}


class SensorGone(SensorError):
    """The port vanished: the sensor was unplugged, or its power failed."""


class Refused(SensorError):
    """A status that stays the same when the command is sent again."""


class Silent(SensorError):
    """The sensor says nothing at all: its power or its cable may be gone where no port tells so."""


class PortInfo(NamedTuple):
    """A serial port: its device, its description, and whether Hokuyo made what is plugged in."""

    device: str
    description: str
    is_hokuyo: bool


def ports() -> list[PortInfo]:
    """Serial ports of this computer, Hokuyo's first.

    Raises
    ------
    SensorError
        Without pyserial.
    """
    listed = _pyserial("serial.tools.list_ports").comports()
    found = [PortInfo(p.device, str(p.description), p.vid == VENDOR) for p in listed]
    return sorted(found, key=lambda port: (not port.is_hokuyo, port.device))


def find_port() -> str:
    """The device of the one Hokuyo that is plugged in.

    Raises
    ------
    SensorError
        Where there is none, or more than one.
    """
    devices = [port.device for port in ports() if port.is_hokuyo]
    if len(devices) == 1:
        return devices[0]
    if devices:
        raise SensorError(f"{len(devices)} sensors are plugged in, name one of {devices}")
    raise SensorError(
        "no Hokuyo (USB vendor 15d1) is plugged in: plug it in and wait a few seconds; one on an "
        "RS-232 adapter must be named, as /dev/ttyUSB0 is, one on Ethernet as tcp://192.168.0.10"
    )


def open_port(device: str, rate: int) -> Port:
    """Open a serial port that no other program uses, and keep others from it; or an address.

    Raises
    ------
    SensorError
    ValueError
        For what begins as an address, `tcp:`, and is none.
    """
    arrays.instance(device, "device", str)
    arrays.whole(rate, "rate")
    if is_address(device):
        return open_tcp(device)
    serial = _pyserial("serial")
    settings = {"timeout": READ, "write_timeout": WRITE, "exclusive": True}
    try:
        opened: Port = serial.Serial(device, rate, **settings)
    except (*LOST, ValueError) as error:
        raise SensorError(f"cannot open {device}: {_advice(error)}") from error
    return opened


def checked_port(port: str | PathLike[str] | Port) -> str | Port:
    """A device, or an open port that does not wait for ever: pyserial's do unless told."""
    if isinstance(port, str | PathLike):
        device = fspath(port)
        if is_address(device):
            parse_address(device)
        return device
    if not callable(getattr(port, "read", None)):
        raise ValueError(f"port must be a device, 'auto', an address or an open port, got {port!r}")
    if getattr(port, "timeout", 0.0) is None:
        raise ValueError("the port must have a timeout, as serial.Serial(device, timeout=0.02) has")
    return port


def _advice(error: BaseException) -> str:
    number = getattr(error, "errno", None)
    if "exclusively lock" in str(error):
        number = errno.EBUSY
    return _ADVICE.get(number, str(error)) if number is not None else str(error)


def _pyserial(module: str) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise SensorError("the port needs pyserial: pip install 'segmap[laser]'") from error


# ------------------------------------------------------------------------------ lines
class Port(Protocol):
    """What a port must be able to do: `serial.Serial` is one.

    `read` returns what comes within the port's own short timeout, perhaps nothing.
    """

    baudrate: int

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""

    def read(self, size: int = 1, /) -> bytes:
        """At most so many bytes."""

    def write(self, data: bytes, /) -> int | None:
        """Send bytes."""

    def close(self) -> None:
        """Free the port."""


class Heard(NamedTuple):
    """Lines of a reply, None where none came, and how many others were dropped before it."""

    lines: list[bytes] | None
    strange: int


class Lines:
    """Lines of a port, read with deadlines.

    Parameters
    ----------
    port : Port
    clock : callable
        Seconds that only go on.
    timeout : float, seconds
        To wait for an answer. After a silence of three tenths of it, no more is expected.
    """

    def __init__(
        self, port: Port, clock: Callable[[], float] = time.monotonic, timeout: float = 1.0
    ) -> None:
        self.port, self.clock, self.timeout = port, clock, timeout
        self.quiet = 0.3 * timeout
        self.kept = b""

    def write(self, text: bytes) -> None:
        """Send bytes, or raise SensorGone."""
        try:
            self.port.write(text)
        except LOST as error:
            raise _gone(error) from error

    def set_rate(self, rate: int) -> None:
        """Talk at so many bits a second from now on; a SensorError where the port cannot."""
        try:
            self.port.baudrate = rate
        except (*LOST, ValueError) as error:
            raise SensorError(f"the port cannot talk at {rate} bit/s ({error})") from error
        self.kept = b""

    def line(self, seconds: float) -> bytes | None:
        """The next line without its end; None where none comes in this time.

        Raises
        ------
        SensorGone
        SensorError
            Where a line has no end.
        """
        until = self.clock() + seconds
        while b"\n" not in self.kept:
            if len(self.kept) > LONGEST:
                self.kept = b""
                raise SensorError(f"{LONGEST} bytes without an end of line: is the bit rate right?")
            self.kept += self._read()
            if b"\n" not in self.kept and self.clock() >= until:
                return None
        line, _, self.kept = self.kept.partition(b"\n")
        return line.removesuffix(b"\r")

    def reply(self, echo: bytes, seconds: float) -> Heard:
        """A reply from its echo to before its empty line, where one comes in this time.

        Lines before the echo are dropped: they belong to something else.

        Raises
        ------
        SensorError
            Where it does not end, or is cut short.
        """
        until, strange = self.clock() + seconds, 0
        for line in self.until(until, seconds):
            if line == echo:
                return Heard(self._rest([line], until), strange)
            strange += 1
        return Heard(None, strange)

    def until(self, deadline: float, quiet: float) -> Iterator[bytes]:
        """Lines until this time, or until nothing more comes for so long, seconds.

        What has come in time counts, though a busy host looks at it late.
        """
        late = 0
        while late < MOST_LINES:
            left = max(deadline - self.clock(), 0.0)
            late += left == 0.0
            try:
                line = self.line(min(quiet, left))
            except SensorGone:
                raise
            except SensorError:
                continue
            if line is None:
                return
            yield line

    def silence(self, quiet: float) -> bool:
        """Read and drop what comes until nothing comes for a while; False where it goes on."""
        self.kept, begun = b"", self.clock()
        last = begun
        while self.clock() - last < quiet:
            if self._read():
                last = self.clock()
            if self.clock() - begun > ENDLESS:
                return False
        return True

    def _rest(self, found: list[bytes], until: float) -> list[bytes]:
        while line := self.line(max(until - self.clock(), 0.05)):
            found.append(line)
            if len(found) > MOST_LINES:
                raise SensorError(f"a reply of more than {MOST_LINES} lines: its end was lost")
        if line is None:
            echo = found[0][:20].decode("ascii", "replace")
            raise SensorError(f"the reply to {echo} stopped before its end")
        return found

    def _read(self) -> bytes:
        """The bytes that wait, or the next one that comes within the port's own timeout."""
        try:
            return self.port.read(min(max(self.port.in_waiting, 1), 1 << 16))
        except LOST as error:
            raise _gone(error) from error


def _gone(error: BaseException) -> SensorGone:
    return SensorGone(f"the sensor is gone ({error}): plug it in and open it again")
