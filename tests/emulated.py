"""Worlds whose scans betray a single wrong range, and sensors that the laser's tests share."""

import contextlib
import gzip
import itertools
import os
import select
import socket
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from segmap.sensors import SensorError, UrgSensor
from segmap.sensors.emulator import Emulator, Unit

SHARED = Path(__file__).resolve().parents[1].parent / "shared" / "data"
#: Of a URG-04LX: steps a turn, the first and last that are measured, that ahead; reach, seconds.
URG = (1024, 44, 725, 384, 20, 5600, 0.1)

needs_terminals = pytest.mark.skipif(
    not hasattr(os, "openpty") or sys.platform == "win32",
    reason="the emulator needs pseudo-terminals, which Windows has not",
)


def capture(name: str) -> bytes:
    """The bytes of a capture beside the project."""
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"{name} lies beside the project and is absent here; it may not be shipped")
    data = path.read_bytes()
    return gzip.decompress(data) if path.suffix == ".gz" else data


def pattern(turn: int) -> np.ndarray:
    """Millimetres that grow by 31 a step and by 7919 a turn, modulo 3900, from 100 on."""
    return 100 + (7919 * turn + 31 * np.arange(769)) % 3900


def turn_of(scan, first: int = 44, most: int = 3900) -> int:
    """Which turn (modulo `most`) of a pattern a scan shows; fails where one beam is of another."""
    met = np.rint(1000 * scan.ranges).astype(int)
    starts = (met - 100 - 31 * (first + np.arange(len(met)))) % most
    assert (starts == starts[0]).all(), "a range that the sensor never measured"
    return int(starts[0]) * pow(7919, -1, most) % most


#: What a buffer may hold from before: the end of a scan and a piece of an answer.
STALE_BYTES = b"0AI0AI0AJ0AK\n\nMD00440\n00P\n"


class Fault(NamedTuple):
    """A fault that happens after so many more bytes; silence lasts some seconds."""

    kind: str
    after: int
    seconds: float = 0.0


class Wire:
    """Passes bytes on, and spoils them where it was told to; `rng` chooses which bit flips."""

    def __init__(self, clock: Callable[[], float], rng: np.random.Generator) -> None:
        self.clock, self.rng = clock, rng
        self.happened: list[str] = []
        self._planned: list[Fault] = []
        self._lock = threading.Lock()
        self._mute_until = -np.inf
        self._stopped = False

    def plan(self, fault: Fault) -> None:
        """Add a fault to those that will happen."""
        with self._lock:
            self._planned = sorted([*self._planned, fault], key=lambda f: f.after)

    def passed(self, data: bytes) -> bytes:
        """The bytes that arrive of those that are sent; an EOFError where it was pulled out."""
        arrived = b""
        with self._lock:
            while self._planned and self._planned[0].after < len(data):
                fault, *rest = self._planned
                arrived += self._quiet(data[: fault.after])
                data = self._struck(fault, data[fault.after :])
                self._planned = [f._replace(after=max(f.after - fault.after, 0)) for f in rest]
            self._planned = [f._replace(after=f.after - len(data)) for f in self._planned]
            return arrived + self._quiet(data)

    def _struck(self, fault: Fault, data: bytes) -> bytes:
        """The bytes after a fault at the first of them."""
        self.happened.append(fault.kind)
        if fault.kind == "unplug":
            raise EOFError("it was pulled out")
        if fault.kind == "flip":
            return bytes([data[0] ^ 1 << int(self.rng.integers(8))]) + data[1:]
        if fault.kind == "lose":
            return data[1:]
        if fault.kind == "stale":
            return STALE_BYTES + data
        if fault.kind == "silence":
            self._mute_until = self.clock() + fault.seconds
        self._stopped = self._stopped or fault.kind == "stop"
        return data

    def _quiet(self, data: bytes) -> bytes:
        """Nothing while the wire is silent, and nothing of the rest of a reply that stopped."""
        if self.clock() < self._mute_until:
            return b""
        if self._stopped:
            _, end, data = data.partition(b"\n\n")
            self._stopped = not end
        return data


def spoiled(emulator, rng=None):
    """An emulator whose bytes pass a wire, on which faults are planned: `emulator.inject`."""
    wire = Wire(time.monotonic, np.random.default_rng(1) if rng is None else rng)
    transmit = emulator.unit.transmit
    emulator.unit.transmit = lambda: wire.passed(transmit())
    emulator.wire = wire

    def inject(kind, *, after=0, seconds=0.5):
        wire.plan(Fault(kind, after, seconds))

    emulator.inject = inject
    return emulator


class Listener:
    """A TCP port, used as a Terminal is, for one client at a time: others are turned away.

    What the sensor says while nobody is there is lost.
    """

    def __init__(self) -> None:
        self._port = 0  # a free one
        self._server: socket.socket | None = None
        self._client: socket.socket | None = None

    @property
    def name(self) -> str:
        return f"tcp://127.0.0.1:{self._port}"

    def open(self) -> None:
        self._server = socket.create_server(("127.0.0.1", self._port))
        self._server.setblocking(False)
        self._port = self._server.getsockname()[1]  # the same one when it is plugged in again

    def close(self) -> None:
        """Cut it; a second call does nothing."""
        self._drop()
        if self._server is not None:
            self._server.close()
            self._server = None

    def wait(self, seconds: float, *, writing: bool) -> None:
        ends = [end for end in (self._server, self._client) if end is not None]
        select.select(ends, ends[1:] if writing else [], [], seconds)

    def read(self) -> bytes:
        heard = b""
        if self._client is not None:
            try:
                heard = self._client.recv(4096)
                is_gone = not heard
            except BlockingIOError:
                is_gone = False
            except OSError:
                is_gone = True
            if is_gone:
                self._drop()
        if not heard:  # the last word of one who leaves is heard before the next one comes
            self._accept()
        return heard

    def write(self, data: bytes) -> int:
        if self._client is None:
            return len(data)
        try:
            return self._client.send(data) if data else 0
        except BlockingIOError:
            return 0
        except OSError:
            self._drop()
            return len(data)

    def _accept(self) -> None:
        if self._server is None:
            return
        with contextlib.suppress(OSError):  # none is there, or left again
            client, _ = self._server.accept()
            if self._client is not None:
                client.close()
                return
            client.setblocking(False)
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._client = client

    def _drop(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            client.close()


class NetworkEmulator(Emulator):
    """A sensor on TCP, at a port of this machine."""

    line = Listener


class Wired:
    """A port with a sensor in the same thread; reading moves the clock of both.

    What the sensor sends passes the wire, where faults are planned, then `spoil(bytes, position)`.
    """

    def __init__(self, spoil=lambda data, at: data, *, world=pattern, unit=Unit, seed=1, **state):
        self.now, self.kept, self.sent, self.spoil = 0.0, b"", 0, spoil
        self.wire = Wire(lambda: self.now, np.random.default_rng(seed))
        is_streaming = state.pop("streaming", False)
        self.unit = unit(world, clock=lambda: self.now, **state)
        if is_streaming:  # left so by a host that crashed
            self.unit.receive(b"MD0044072501000\n")
        self.baudrate = getattr(self.unit, "rate", None) or 115200
        self.open, self.gone = True, False

    @property
    def in_waiting(self):
        self._check()
        try:
            data = self.wire.passed(self.unit.transmit())
        except EOFError:
            self.gone = True
            self._check()
        self.kept += self.spoil(data, self.sent)
        self.sent += len(data)
        return len(self.kept)

    def read(self, size=1, /):
        self.now += 0.01
        assert self.now < 60, "the driver reads without end"
        data, self.kept = self.kept[:size], self.kept[size:]
        return data

    def write(self, data, /):
        self._check()
        self.unit.receive(data)
        return len(data)

    def close(self):
        self.open = False

    def plan(self, kind, at, seconds=0.0):
        """A fault of the wire, so many bytes from now."""
        self.wire.plan(Fault(kind, at, seconds))

    def _check(self):
        if self.gone:
            raise OSError("device reports readiness to read but returned no data")


def connected(port, **settings):
    """The driver at a `Wired` port, by the port's clock."""
    settings = {"timeout": 0.5, "clock": lambda: port.now} | settings
    return UrgSensor(port, **settings)


def wait_for(true, seconds=20.0):
    until = time.monotonic() + seconds
    while not true() and time.monotonic() < until:
        time.sleep(0.005)
    assert true()


def open_files() -> int:
    """Files that this process holds open; 0 where the system does not tell."""
    folder = Path("/proc/self/fd")
    return len(list(folder.iterdir())) if folder.exists() else 0


def emulator_threads() -> list[str]:
    return [t.name for t in threading.enumerate() if t.name == "URG emulator"]


# ----------------------------------------------------------------------------- faults
#: Scans that a run asks for.
SCANS = 6
WIRE = ("flip", "lose", "stale", "stop", "silence", "unplug")
#: Bytes that the sensor sends before a scan comes, and with the scans.
OPENING, WHOLE = 300, 300 + SCANS * 2138
FAULTS = {
    **{fault: {} for fault in (*WIRE, "status")},
    "wrap": {"stamp": (1 << 24) - 800},
    "streaming at open": {"streaming": True},
    "flip at open": {},
    "lose at open": {},
    "stop at open": {},
    "flip while streaming": {"streaming": True},
    "lose in SCIP 1.1": {"protocol": "1.1"},
}


class Outcome(NamedTuple):
    scans: int
    dropped: int
    error: str
    happened: bool


def run(sensor_at, unit, wire, fault, seed) -> Outcome:
    """Ask for some scans from a sensor that goes wrong somewhere on the way; check each beam."""
    rng, kind = np.random.default_rng(seed), fault.partition(" ")[0]
    if kind in WIRE:
        most = OPENING if fault.endswith("at open") else WHOLE
        wire.plan(Fault(kind, int(rng.integers(0, most)), float(rng.uniform(0.05, 1.0))))
    scans, dropped, error = 0, 0, ""
    try:
        with sensor_at() as sensor:
            assert sensor.geometry[:7] == URG
            stream = sensor.scans() if seed % 2 else iter(sensor.scan, None)
            for scan in itertools.islice(stream, SCANS):
                turn_of(scan)
                assert scan.angles[384 - 44] == 0.0
                scans += 1
                if kind == "status" and scans == 1 + seed % 4:
                    unit.trouble = True
            if seed % 2:
                stream.close()
            dropped = sensor.dropped
    except SensorError as wrong:
        error = str(wrong)
        assert ": " in error and len(error) > 30, "an error without advice"
    assert scans == SCANS or error
    return Outcome(scans, dropped, error, kind not in WIRE or kind in wire.happened)
