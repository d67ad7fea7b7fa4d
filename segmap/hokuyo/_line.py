"""Whole lines from a port, within a bounded time and of a bounded length."""

import time
from collections.abc import Callable, Iterator
from typing import Protocol

from ._coding import SensorError

try:
    from termios import error as TerminalError
except ImportError:  # Windows
    TerminalError = OSError  # type: ignore[misc, assignment]

#: No line of the protocol is longer, block or information, in bytes.
LONGEST = 512
#: No reply has more lines: 769 steps of three characters are 37 blocks.
MOST_LINES = 64
#: A sensor that talks on for so long without an answer is not going to give one, seconds.
PATIENCE = 3.0
#: What ports raise when they are pulled out.
LOST = (OSError, TerminalError)


class SensorGone(SensorError):
    """The port vanished: the sensor was unplugged, or its power failed."""


class Port(Protocol):
    """What a serial port must be able to do: `serial.Serial` is one.

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


class Lines:
    """Lines of a port, read with deadlines.

    Parameters
    ----------
    port : Port
    clock : callable
        Seconds that only go on.
    """

    def __init__(self, port: Port, clock: Callable[[], float] = time.monotonic) -> None:
        self.port = port
        self.clock = clock
        self.kept = b""
        #: Lines that the last `reply` dropped before its echo.
        self.strange = 0

    def write(self, text: bytes) -> None:
        """Send bytes.

        Raises
        ------
        SensorGone
        """
        try:
            self.port.write(text)
        except LOST as error:
            raise _gone(error) from error

    def set_rate(self, rate: int) -> None:
        """Talk at so many bits a second from now on.

        Raises
        ------
        SensorError
            Where the port cannot.
        """
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
            self.kept += self.read()
            if b"\n" not in self.kept and self.clock() >= until:
                return None
        line, _, self.kept = self.kept.partition(b"\n")
        return line.removesuffix(b"\r")

    def reply(self, echo: bytes, seconds: float) -> list[bytes] | None:
        """A reply from its echo to before its empty line; None where none comes in this time.

        Lines before the echo are dropped: they belong to something else.

        Raises
        ------
        SensorError
            Where it does not end, or is cut short.
        """
        until, self.strange = self.clock() + seconds, 0
        for line in self.until(until, seconds):
            if line == echo:
                return self._rest([line], until)
            self.strange += 1
        return None

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

    def _rest(self, found: list[bytes], until: float) -> list[bytes]:
        while line := self.line(max(until - self.clock(), 0.05)):
            found.append(line)
            if len(found) > MOST_LINES:
                raise SensorError(f"a reply of more than {MOST_LINES} lines: its end was lost")
        if line is None:
            raise SensorError(f"the reply to {_shown(found[0])} stopped before its end")
        return found

    def silence(self, quiet: float, at_most: float = PATIENCE) -> bool:
        """Read and drop what comes until nothing comes for a while; False where it goes on."""
        self.kept, begun = b"", self.clock()
        last = begun
        while self.clock() - last < quiet:
            if self.read():
                last = self.clock()
            if self.clock() - begun > at_most:
                return False
        return True

    def read(self) -> bytes:
        """What waits, or the next byte within the port's own timeout.

        Raises
        ------
        SensorGone
        """
        try:
            return self.port.read(min(max(self.port.in_waiting, 1), 1 << 16))
        except LOST as error:  # serial.SerialException is an OSError
            raise _gone(error) from error


def _shown(line: bytes) -> str:
    return line[:20].decode("ascii", "replace")


def _gone(error: BaseException) -> SensorGone:
    return SensorGone(f"the sensor is gone ({error}): plug it in and open it again")
