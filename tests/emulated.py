"""Worlds whose scans betray a single wrong range, and sensors that the laser's tests share."""

import gzip
import itertools
import os
import sys
import threading
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from segmap.sensors import SensorError, UrgSensor
from segmap.sensors.emulator import Unit
from segmap.sensors.emulator._device import Fault, Unplugged, Wire

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


def far_pattern(turn: int) -> np.ndarray:
    """The same for a UST-10LX, to 29.9 m."""
    return 100 + (7919 * turn + 31 * np.arange(1081)) % 29800


def turn_of(scan, first: int = 44, most: int = 3900) -> int:
    """Which turn (modulo `most`) of a pattern a scan shows; fails where one beam is of another."""
    met = np.rint(1000 * scan.ranges).astype(int)
    starts = (met - 100 - 31 * (first + np.arange(len(met)))) % most
    assert (starts == starts[0]).all(), "a range that the sensor never measured"
    return int(starts[0]) * pow(7919, -1, most) % most


def far_turn(scan) -> int:
    assert len(scan) == 1081 and scan.max_range == 30.0
    return turn_of(scan, 0, 29800)


class Wired:
    """A port with a sensor in the same thread; reading moves the clock of both.

    What the sensor sends passes the wire, where faults are planned, then `spoil(bytes, position)`.
    """

    def __init__(self, spoil=lambda data, at: data, *, world=pattern, unit=Unit, seed=1, **state):
        self.now, self.kept, self.sent, self.spoil = 0.0, b"", 0, spoil
        self.wire = Wire(lambda: self.now, np.random.default_rng(seed))
        self.unit = unit(world, clock=lambda: self.now, **state)
        self.baudrate = 115200 if getattr(self.unit, "usb", True) else self.unit.rate
        self.open, self.gone = True, False

    @property
    def in_waiting(self):
        self._check()
        try:
            data = self.wire.passed(self.unit.transmit())
        except Unplugged:
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
    **{fault: {} for fault in (*WIRE, "status", "wrap")},
    "streaming at open": {"streaming": True},
    "time mode at open": {"timing": True},
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
                    unit.fail("Motor does not turn.")
                if kind == "wrap" and scans == 1 + seed % 4:
                    unit.wrap_clock()
            if seed % 2:
                stream.close()
            dropped = sensor.dropped
    except SensorError as wrong:
        error = str(wrong)
        assert ": " in error and len(error) > 30, "an error without advice"
    assert scans == SCANS or error
    return Outcome(scans, dropped, error, kind not in WIRE or kind in wire.happened)
