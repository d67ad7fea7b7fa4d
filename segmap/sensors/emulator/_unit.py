"""A sensor without its wire: what it answers to which bytes, and when (SCIP, 3 to 5)."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from ... import arrays
from ...arrays import Count, Positive, at_least, at_most, checked
from .._protocol import (
    CHARACTERS,
    ScanRequest,
    SensorError,
    encode_info,
    encode_reply,
    encode_scan,
    parse_request,
)
from ._worlds import LIMITS, STEPS, TURN_S, VERSION

#: From the number of a turn to the millimetres of all its steps.
World = Callable[[int], NDArray[np.int64]]
#: What it speaks after power-up, and how much faster its seconds go by.
PowerUp = Literal["2.0", "1.1"]
Speed = Annotated[Positive, at_least(1e-3), at_most(1e3)]
Milliseconds = Annotated[Count, at_least(0)]


class Unit:
    """The sensor: bytes in, bytes out, a clock.

    Parameters
    ----------
    world
        As of `Emulator`.
    protocol : "2.0" or "1.1"
        What it speaks after power-up.
    rate : int, bits a second, or None
        Of an RS-232 line, which slows it down; None for USB or Ethernet.
    speed : float
        Its seconds go by so much faster.
    clock : callable
        Seconds.
    stamp : int, milliseconds
        Its own clock at power-up; it wraps at 2 ** 24.
    """

    @checked
    def __init__(
        self,
        world: World,
        *,
        protocol: PowerUp = "2.0",
        rate: Count | None = None,
        speed: Speed = 1.0,
        clock: Callable[[], float] = time.monotonic,
        stamp: Milliseconds = 0,
    ) -> None:
        self.world = arrays.function(world, "world", "from a turn to its millimetres")
        arrays.call_given(
            inspect.signature(world).bind, "world", 0
        )  # a call would draw from its noise
        self.speed, self.rate, self.stamp = speed, rate, stamp
        self.laser = self.old = protocol == "1.1"
        self.trouble = False
        self._clock = arrays.function(clock, "clock", "without arguments, of seconds")
        self._begun = arrays.number(arrays.call_given(clock, "clock"), "clock()", unit="seconds")
        self.stream: ScanRequest | None = None
        self.received: list[str] = []
        self._next_turn, self._line = 0, b""
        self._out, self._sent_at = b"", 0.0

    def now(self) -> float:
        """Its seconds since power-up."""
        return (self._clock() - self._begun) * self.speed

    def turn(self) -> int:
        """Number of the turn that was finished last; -1 before the first."""
        return int(self.now() / TURN_S) - 1

    def receive(self, data: bytes) -> None:
        """Take bytes of the host, and act on each whole line."""
        *lines, self._line = (self._line + data).replace(b"\r", b"\n").split(b"\n")
        for line in lines:
            if text := line.decode("ascii", "replace"):
                self.received.append(text)
                self._out += self._answer(text)

    def transmit(self) -> bytes:
        """What it has to send by now, no more than its bit rate lets through."""
        now = self.now()
        if self.stream and not self._out and self.turn() >= self._next_turn:
            self._out += self._scan(self.stream)
        allowed = len(self._out)
        if self.rate is not None:
            allowed = int((now - self._sent_at) * self.rate / 10)
        data, self._out = self._out[:allowed], self._out[allowed:]
        if data or not self._out:
            self._sent_at = now
        return data

    def _answer(self, text: str) -> bytes:
        if self.old:  # of SCIP 1.1 all that matters is that it can switch
            self.laser = self.old = text != "SCIP2.0"
            return encode_reply(text, "E" if self.old else "0", old=True)
        act: Callable[[str], bytes] | None = getattr(self, f"_do_{text[:2].lower()}", None)
        if act is None:
            return encode_reply(text, "0E")
        return act(text)

    def _do_vv(self, text: str) -> bytes:
        return encode_reply(text, "00", encode_info(VERSION))

    def _do_pp(self, text: str) -> bytes:
        return encode_reply(text, "00", encode_info(LIMITS))

    def _do_qt(self, text: str) -> bytes:
        self.laser, self.stream = False, None
        return encode_reply(text, "00")

    def _do_md(self, text: str) -> bytes:
        request, status = _scan_request(text)
        if request is not None:
            self.stream, self.laser, self._next_turn = request, True, self.turn() + 2
        return encode_reply(text, status or "00")

    def _scan(self, request: ScanRequest) -> bytes:
        """The reply with the turn that was finished last; status 50 where it is in `trouble`."""
        turn, remaining = self.turn(), request._replace(scans=max(request.scans - 1, 0))
        self._next_turn = turn + 1
        self.stream = remaining if request.scans != 1 and not self.trouble else None
        self.laser = self.stream is not None
        if self.trouble:
            return encode_reply(remaining.text, "50")
        steps = arrays.row(self.world(turn), "world", STEPS).astype(np.int64)
        stamp = self.stamp + round(1000 * TURN_S * turn)
        body = encode_scan(stamp, steps[request.first : request.last + 1], CHARACTERS)
        return encode_reply(remaining.text, "99", body)


def _scan_request(text: str) -> tuple[ScanRequest | None, str]:
    """The request, or the status that refuses it."""
    try:
        request = parse_request(text)
    except SensorError:
        return None, "0C" if len(text) < 12 else "01"
    if request.last >= STEPS:
        return None, "04"
    if request.last < request.first:
        return None, "05"
    return request, ""
