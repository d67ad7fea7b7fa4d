"""An emulated LD19 or RPLidar A1: the makers' bytes of scans, while they are measured."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Literal

import numpy as np

from ... import arrays
from ...arrays import Array, checked
from ...scans import LaserScan
from .._host import one_by_one
from ._device import PluggedIn
from ._unit import Speed

#: Measurements of a packet of an LD19, its bytes 0 and 1, and the polynomial of its check.
PACKET_BEAMS, PACKET_HEAD, CRC_POLYNOMIAL = 12, b"\x54\x2c", 0x4D
#: The clock of an LD19 begins anew after so many milliseconds.
CLOCK_MS = 30_000
#: What an RPLidar answers to a request, the second byte: the kind of a scan, its health, its name.
ANSWERS = {
    0x20: bytes.fromhex("a55a0500004081"),
    0x50: bytes.fromhex("a55a1400000004") + bytes([0x18, 1, 1, 7, *range(16)]),
    0x52: bytes.fromhex("a55a0300000006") + bytes(3),
}
#: Of what nobody reads so long, its seconds, the older is lost.
MOST_UNREAD_S = 1.0
#: Quality and intensity of a beam that met something.
GOOD_QUALITY, GOOD_INTENSITY = 15, 200
SpinningName = Literal["LD19", "RPLIDAR-A1"]


class SpinningUnit:
    """Bytes in, bytes out, a clock: what a laser of a model sends of scans that it measures.

    Parameters
    ----------
    scans : iterable of LaserScan
        One a turn, in the order of their times; after the last they begin again.
    model, speed, clock
        As of `SpinningEmulator`.
    """

    def __init__(
        self,
        scans: Iterable[LaserScan],
        model: SpinningName = "LD19",
        *,
        speed: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        measured = tuple(one_by_one(scans, "scans"))
        if not measured:
            raise ValueError("scans must hold at least one turn, got none")
        self._beams, self._period = _beams(measured)
        self._model, self._speed, self._clock = model, speed, clock
        self._begun, self._sent, self._out, self._heard = clock(), 0, b"", b""
        self.running = model == "LD19"  # the other waits for its order

    def receive(self, data: bytes) -> None:
        """Take bytes of the host, and act on each request."""
        if self._model == "LD19":
            return
        *_, last = (*self._heard.split(b"\xa5"), b"")
        for request in (last + data).split(b"\xa5")[1:] if data else ():
            if request[:1] in (b"\x25", b"\x40"):
                self.running = False
            elif request and request[0] in ANSWERS:
                self._out += ANSWERS[request[0]]
                self.running |= request[0] == 0x20
        self._heard = data[-1:]

    def transmit(self) -> bytes:
        """What it has to send by now."""
        turns, since = divmod((self._clock() - self._begun) * self._speed, self._period)
        n = len(self._beams)
        measured = int(turns) * n + int(np.searchsorted(self._beams[:, 0], since))
        step = PACKET_BEAMS if self._model == "LD19" else 1
        late = measured - self._sent - int(MOST_UNREAD_S * n / self._period)
        self._sent += max(late, 0) // step * step
        encode = packet if self._model == "LD19" else node
        while self._sent + step <= measured:
            some = np.arange(self._sent, self._sent + step)
            if self.running:
                self._out += encode(self._beams[some % n], self._period * (some[0] // n))
            self._sent += step
        data, self._out = self._out, b""
        return data


def _beams(scans: tuple[LaserScan, ...]) -> tuple[Array, float]:
    """Seconds, degrees clockwise, millimetres, 1 where a turn begins, `(n, 4)`; seconds in all."""
    turn = float(np.median(np.diff([scan.time for scan in scans]))) if len(scans) > 1 else 0.1
    rows = []
    for k, scan in enumerate(scans):
        clockwise = -np.degrees(scan.angles) % 360
        delays = turn * clockwise / 360 if scan.delays is None else scan.delays
        order = np.argsort(delays, kind="stable")
        met = np.where(scan.valid, np.rint(1000 * scan.ranges), 0.0)
        first = np.zeros(len(scan))
        first[order[:1]] = 1
        rows.append(np.column_stack([k * turn + delays, clockwise, met, first])[order])
    return np.concatenate(rows), turn * len(scans)


def packet(beams: Array, since: float) -> bytes:
    """The 47 bytes of an LD19 for 12 beams `(12, 4)`; their times count from `since`, seconds.

    Examples
    --------
    >>> angles, millimetres = 324.27 + 0.9482 * np.arange(12), np.full((12, 2), 224)
    >>> packet(np.column_stack([np.zeros(12), angles, millimetres]), 6.714)[:9].hex(" ")
    '54 2c 68 10 ab 7e e0 00 c8'
    """
    first, last = (np.rint(100 * beams[[0, -1], 1]) % 36_000).astype(int).tolist()
    spent = max(beams[-1, 0] - beams[0, 0], 1e-6)
    speed = (
        min((last - first) % 36_000 / 100 / spent, 0xFFFF) if beams[-1, 0] > beams[0, 0] else 4200
    )
    words = [int(speed), first]
    body = PACKET_HEAD + np.array(words, "<u2").tobytes()
    for millimetres in beams[:, 2].astype(int).tolist():
        body += millimetres.to_bytes(2, "little") + bytes([GOOD_INTENSITY * (millimetres > 0)])
    stamp = int(1000 * (since + beams[0, 0])) % CLOCK_MS
    body += np.array([last, stamp], "<u2").tobytes()
    return body + bytes([crc(body)])


def crc(data: bytes) -> int:
    """The check of an LD19: eight bits, polynomial 4D, from 0, not mirrored.

    Examples
    --------
    >>> crc(bytes.fromhex("542c6808ab7ee000e4dc00e2d900e5d500e3d300e4d000e9cd00e4ca00e2c700e9"
    ...                   "c500e5c200e5c000e5be823a1a"))
    80
    """
    check = 0
    for byte in data:
        check ^= byte
        for _ in range(8):
            check = (check << 1 ^ CRC_POLYNOMIAL if check & 0x80 else check << 1) & 0xFF
    return check


def node(beams: Array, since: float) -> bytes:
    """The 5 bytes of an RPLidar for one beam `(1, 4)`; they hold no time.

    Examples
    --------
    >>> node(np.array([[0.0, 0.0, 2000.25, 1.0]]), 0.0).hex(" ")
    '3d 01 00 41 1f'
    """
    _, degrees, millimetres, first = beams[0]
    quality = GOOD_QUALITY * (millimetres > 0)
    angle, distance = round(64 * degrees) % (64 * 360) << 1 | 1, round(4 * millimetres)
    start = 1 if first else 2
    return bytes([quality << 2 | start]) + np.array([angle, distance], "<u2").tobytes()


class SpinningEmulator(PluggedIn):
    """A low-cost laser without hardware: `port` is the pseudo-terminal to open.

    Parameters
    ----------
    scans : iterable of LaserScan
        What it measures, one a turn, as `simulation.simulate(..., moving=True)` gives them.
    model : "LD19" or "RPLIDAR-A1"
    speed : float
        Its seconds go by so much faster.

    Examples
    --------
    >>> from segmap.sensors import SpinningLaser
    >>> scan = LaserScan(np.full(450, 2.0), np.radians(0.8 * np.arange(450) - 180))
    >>> with SpinningEmulator([scan]) as emulator, SpinningLaser("LD19", emulator.port) as laser:
    ...     next(laser.scans())  # doctest: +ELLIPSIS
    LaserScan(450 beams, 450 valid, t=... s)
    """

    @checked
    def __init__(
        self,
        scans: Iterable[LaserScan],
        *,
        model: SpinningName = "LD19",
        speed: Speed = 1.0,
    ) -> None:
        arrays.one_of(model, "model", ("LD19", "RPLIDAR-A1"))
        super().__init__(SpinningUnit(scans, model, speed=speed))
