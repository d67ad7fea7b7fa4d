"""A sensor without its wire: what it answers to which bytes, and when (SCIP, 3 to 5)."""

from __future__ import annotations

import inspect
import time
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from ... import arrays
from ...arrays import Count, Positive, at_least, at_most, checked
from ...scans.error_codes import LOWEST
from .._protocol import (
    CHARACTERS,
    ScanRequest,
    SensorError,
    encode_info,
    encode_reply,
    encode_scan,
    parse_request,
)
from ._worlds import MODELS, ModelName

#: From the number of a turn to the millimetres of all its steps.
World = Callable[[int], NDArray[np.int64]]
#: Beyond every distance, millimetres.
FARTHEST_MM = 1 << 20
#: What it speaks after power-up, and how much faster its seconds go by.
PowerUp = Literal["2.0", "1.1", "1.1 only"]
Speed = Annotated[Positive, at_least(1e-3), at_most(1e3)]
Milliseconds = Annotated[Count, at_least(0)]


class Unit:
    """The sensor: bytes in, bytes out, a clock.

    Parameters
    ----------
    world, model
        As of `Emulator`.
    protocol : "2.0", "1.1" or "1.1 only"
        What it speaks after power-up; the last has firmware that cannot switch.
    rate : int, bits a second
        Of an RS-232 line, which slows it down.
    usb : bool
        Whether there is no such line.
    speed : float
        Its seconds go by so much faster.
    clock : callable
        Seconds.
    stamp : int, milliseconds
        Its own clock at power-up; it wraps at 2 ** 24.
    streaming, timing : bool
        Left streaming, or in time mode, by a host that crashed.
    """

    @checked
    def __init__(
        self,
        world: World,
        *,
        model: ModelName = "URG-04LX",
        protocol: PowerUp = "2.0",
        rate: Count = 19200,
        usb: bool = True,
        speed: Speed = 1.0,
        clock: Callable[[], float] = time.monotonic,
        stamp: Milliseconds = 0,
        streaming: bool = False,
        timing: bool = False,
    ) -> None:
        self.model = MODELS[model]
        if model != "URG-04LX":
            arrays.one_of(protocol, "protocol", ("2.0",))
        self.world = arrays.function(world, "world", "from a turn to its millimetres")
        arrays.call_given(
            inspect.signature(world).bind, "world", 0
        )  # a call would draw from its noise
        self.speed, self.usb, self.timing = speed, usb, timing
        self.stamp, self.rate = stamp, rate
        self.old, self._switches = protocol != "2.0", protocol == "1.1"
        self.laser, self.trouble = self.old, ""
        self._clock = arrays.function(clock, "clock", "without arguments, of seconds")
        self._begun = arrays.number(arrays.call_given(clock, "clock"), "clock()", unit="seconds")
        self.stream: ScanRequest | None = None
        self.received: list[str] = []
        self._next_turn, self._line = 0, b""
        self._late: deque[tuple[float, Callable[[], bytes]]] = deque()
        self._out, self._sent_at = b"", 0.0
        if streaming:  # left so by a host that crashed
            self.stream = ScanRequest("MD", self.model.first, self.model.last)
            self.laser = True

    def now(self) -> float:
        """Its seconds since power-up."""
        return (self._clock() - self._begun) * self.speed

    def turn(self) -> int:
        """Number of the turn that was finished last; -1 before the first."""
        return int(self.now() / self.model.turn) - 1

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
        while self._late and self._late[0][0] <= now:
            self._out += self._late.popleft()[1]()
        if self.stream and not self._out and self.turn() >= self._next_turn:
            self._out += self._stream_scan(self.stream)
        allowed = len(self._out) if self.usb else int((now - self._sent_at) * self.rate / 10)
        data, self._out = self._out[:allowed], self._out[allowed:]
        if data or not self._out:
            self._sent_at = now
        return data

    def fail(self, trouble: str) -> None:
        """Let the hardware fail: each scan is answered with status 50; no trouble mends it."""
        self.trouble = trouble

    def wrap_clock(self) -> None:
        """Let its own clock pass the end of its 24 bits within the next turns."""
        self.stamp = (1 << 24) - 50 - round(1000 * self.model.turn * (self.turn() + 2))

    def _answer(self, text: str) -> bytes:
        if self.old:
            return self._answer_old(text)
        act: Callable[[str], bytes] | None = getattr(self, f"_do_{text[:2].lower()}", None)
        if act is None or (self.timing and text[:2] != "TM"):
            return encode_reply(text, "0E")
        return act(text)

    def _answer_old(self, text: str) -> bytes:
        """The reply of SCIP 1.1, without check sums: all that matters is that it can switch."""
        if text != "SCIP2.0" or not self._switches:
            return encode_reply(text, "E", old=True)
        self.old = self.laser = False
        return encode_reply(text, "0", old=True)

    def _do_vv(self, text: str) -> bytes:
        return encode_reply(text, "00", encode_info(self.model.version))

    def _do_pp(self, text: str) -> bytes:
        return encode_reply(text, "00", encode_info(self.model.limits))

    def _do_ii(self, text: str) -> bytes:
        info = {
            "MODL": self.model.limits["MODL"],
            "LASR": "ON" if self.laser else "OFF",
            "SCSP": f"Initial({self.model.limits['SCAN']}[rpm])<-Default setting by user",
            "MESM": "MONITORING" if self.stream else "CLASSIC" if self.laser else "IDLE",
            "SBPS": self.model.line or f"{self.rate}[bps]<-Default setting by user",
            "TIME": f"{self._stamp(max(self.turn(), 0)):06X}",
            "STAT": self.trouble or "Sensor works well.",
        }
        return encode_reply(text, "00", encode_info(info))

    def _do_bm(self, text: str) -> bytes:
        status = "02" if self.laser else "00"
        self.laser = True
        return encode_reply(text, status)

    def _do_qt(self, text: str) -> bytes:
        self.laser, self.stream = False, None
        self._late.clear()
        return encode_reply(text, "00")

    def _do_tm(self, text: str) -> bytes:
        """Leave the time mode, in which a host may have left it; it is not entered here."""
        status = "01" if text != "TM2" else "00" if self.timing else "03"
        self.timing &= status != "00"
        return encode_reply(text, status)

    def _do_gd(self, text: str) -> bytes:
        """Commands are served about once a turn: the answer waits for the end of this one."""
        request, status = _scan_request(text, self.model.steps)
        if request is None or not self.laser:
            return encode_reply(text, status or "10")
        when = (self.turn() + 2) * self.model.turn
        self._late.append((when, partial(self._scan, request, "00")))
        return b""

    _do_gs = _do_gd

    def _do_md(self, text: str) -> bytes:
        request, status = _scan_request(text, self.model.steps)
        if request is not None:
            self.stream, self.laser, self._next_turn = request, True, self.turn() + 2
        return encode_reply(text, status or "00")

    _do_ms = _do_md

    def _stream_scan(self, request: ScanRequest) -> bytes:
        self._next_turn = self.turn() + 1 + request.skip
        remaining = request._replace(scans=max(request.scans - 1, 0))
        self.stream = remaining if request.scans != 1 and not self.trouble else None
        self.laser = self.stream is not None
        return self._scan(remaining, "99")

    def _scan(self, request: ScanRequest, status: str) -> bytes:
        """The reply with the turn that was finished last; status 50 of a sensor in trouble."""
        if self.trouble:
            return encode_reply(request.text, "50")
        turn = self.turn()
        met = cluster_coded(self._ranges(turn)[request.first : request.last + 1], request.cluster)
        body = encode_scan(self._stamp(turn), met, CHARACTERS[request.kind])
        return encode_reply(request.text, status, body)

    def _ranges(self, turn: int) -> NDArray[np.int64]:
        """Millimetres of all steps in a turn."""
        return arrays.row(self.world(turn), "world", self.model.steps).astype(np.int64)

    def _stamp(self, turn: int) -> int:
        return (self.stamp + round(1000 * self.model.turn * turn)) % (1 << 24)


def cluster_coded(millimetres: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """The smallest distance of each group; an error only where all are errors.

    Examples
    --------
    >>> cluster_coded(np.array([300, 200, 7, 500, 7]), 2)
    array([200, 500,   7])
    """
    filled = np.append(millimetres, np.repeat(millimetres[-1:], -len(millimetres) % max(size, 1)))
    groups = filled.reshape(-1, max(size, 1))
    nearest = np.where(groups >= LOWEST, groups, FARTHEST_MM).min(axis=1)
    return np.where(nearest < FARTHEST_MM, nearest, groups[:, 0])


def _scan_request(text: str, steps: int) -> tuple[ScanRequest | None, str]:
    """The request, or the status that refuses it."""
    try:
        request = parse_request(text)
    except SensorError:
        return None, "0C" if len(text) < 12 else "01"
    if request.last >= steps:
        return None, "04"
    if request.last < request.first:
        return None, "05"
    return request, ""
