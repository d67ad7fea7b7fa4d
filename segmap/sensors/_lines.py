"""Lines from a port within bounded time and of bounded length."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Protocol

from ._protocol import SensorError, SensorGone

try:
    from termios import error as TerminalError
except ImportError:  # Windows
    TerminalError = OSError  # type: ignore[misc, assignment]

#: What ports raise when they are pulled out; serial.SerialException is an OSError.
PULLED_OUT_ERRORS = (OSError, TerminalError)
#: No line of the protocol is longer, block or information, in bytes.
LONGEST_ANSWER_BYTES = 512
#: No reply has more lines: 2161 steps of three characters are 102 blocks.
MOST_LINES = 128
#: A sensor that has talked for so long without an answer is not going to give one, seconds.
ENDLESS_S = 3.0


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


class Lines:
    """Lines of a port, read with deadlines by a clock of seconds that only go on.

    An answer is waited for `timeout` seconds; after a silence of three tenths of it, no more is
    expected.
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
        except PULLED_OUT_ERRORS as error:
            raise _gone_error(error) from error

    def line(self, seconds: float) -> bytes | None:
        """The next line without its end, None where none comes in this time.

        A SensorError where a line has no end.
        """
        until = self.clock() + seconds
        while b"\n" not in self.kept:
            if len(self.kept) > LONGEST_ANSWER_BYTES:
                self.kept = b""
                raise SensorError(
                    f"{LONGEST_ANSWER_BYTES} bytes without an end of line: is the bit rate right?"
                )
            self.kept += self._read()
            if b"\n" not in self.kept and self.clock() >= until:
                return None
        line, _, self.kept = self.kept.partition(b"\n")
        return line.removesuffix(b"\r")

    def reply(self, echo: bytes, seconds: float) -> tuple[list[bytes] | None, int]:
        """A reply from its echo to before its empty line; None where none begins in this time.

        Lines before the echo are dropped and counted: they belong to something else. A SensorError
        where the reply does not end, or is cut short.
        """
        until, strange = self.clock() + seconds, 0
        for heard in self.until(until, seconds):
            if heard != echo:
                strange += 1
                continue
            reply = [heard]
            while line := self.line(max(until - self.clock(), 0.05)):
                reply.append(line)
                if len(reply) > MOST_LINES:
                    raise SensorError(f"a reply of more than {MOST_LINES} lines: its end was lost")
            if line is None:
                command = echo[:20].decode("ascii", "replace")
                raise SensorError(f"the reply to {command} stopped before its end")
            return reply, strange
        return None, strange

    def until(self, deadline: float, quiet: float) -> Iterator[bytes]:
        """Lines until this time, or until nothing more comes for so long, seconds.

        What has come in time counts, though a busy host looks at it late.
        """
        late = 0
        while late < MOST_LINES:
            remaining = max(deadline - self.clock(), 0.0)
            late += remaining == 0.0
            try:
                line = self.line(min(quiet, remaining))
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
            if self.clock() - begun > ENDLESS_S:
                return False
        return True

    def _read(self) -> bytes:
        """The bytes that wait, or the next one that comes within the port's own timeout."""
        try:
            return self.port.read(min(max(self.port.in_waiting, 1), 1 << 16))
        except PULLED_OUT_ERRORS as error:
            raise _gone_error(error) from error


def _gone_error(error: BaseException) -> SensorGone:
    return SensorGone(f"the sensor is gone ({error}): plug it in and open it again")
