"""Whole lines from a port, within a bounded time and of a bounded length."""

import time
from collections.abc import Callable
from typing import Protocol

from ._coding import SensorError

#: No line of the protocol is longer, block or information.
LONGEST = 512


class Port(Protocol):
    """What a serial port must be able to do: `serial.Serial` is one."""

    def read(self, size: int = 1) -> bytes: ...
    def write(self, data: bytes) -> int | None: ...
    def close(self) -> None: ...


class Lines:
    """Lines of a port, read with deadlines.

    Parameters
    ----------
    port : Port
        Whose `read(n)` returns what there is, at most n bytes, within its own short timeout.
    clock : callable
        Seconds that only go on.
    """

    def __init__(self, port: Port, clock: Callable[[], float] = time.monotonic) -> None:
        self.port = port
        self.clock = clock
        self.kept = b""

    def write(self, text: bytes) -> None:
        """Send bytes.

        Raises
        ------
        SensorError
            Where the port is gone.
        """
        try:
            self.port.write(text)
        except OSError as error:
            raise _gone(error) from error

    def line(self, seconds: float) -> bytes | None:
        """The next line without its end; None where none comes in this time.

        Raises
        ------
        SensorError
            Where the port is gone, or a line has no end.
        """
        until = self.clock() + seconds
        while b"\\n" not in self.kept:
            if len(self.kept) > LONGEST:
                self.kept = b""
                raise SensorError(f"{LONGEST} bytes without an end of line: is the bit rate right?")
            if self.clock() > until:
                return None
            self.kept += self._read()
        line, _, self.kept = self.kept.partition(b"\\n")
        return line.removesuffix(b"\\r")

    def reply(self, seconds: float) -> list[bytes] | None:
        """Lines up to an empty one, which is left out; None where it does not come in this time."""
        until, found = self.clock() + seconds, list[bytes]()
        while (line := self.line(max(until - self.clock(), 0.0))) is not None:
            if not line and found:
                return found
            if line:
                found.append(line)
            if len(found) > LONGEST:
                raise SensorError(f"{LONGEST} lines without an empty one: this is no such sensor")
        return None

    def silence(self, quiet: float, at_most: float) -> bool:
        """Read and drop what comes until nothing comes for a while; False where it goes on."""
        self.kept, begun = b"", self.clock()
        last = begun
        while self.clock() - last < quiet:
            if self._read():
                last = self.clock()
            if self.clock() - begun > at_most:
                return False
        return True

    def _read(self) -> bytes:
        """What waits, or the next byte within the port's own timeout."""
        try:
            return self.port.read(max(getattr(self.port, "in_waiting", 1), 1))
        except OSError as error:  # serial.SerialException is one
            raise _gone(error) from error


def _gone(error: OSError) -> SensorError:
    return SensorError(f"the sensor is gone ({error}): plug it in again and open it once more")
