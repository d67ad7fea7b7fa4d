"""Every fault, twenty times at random moments: a right scan, a counted drop, or a SensorError."""

import contextlib
import gc
import itertools
import os
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from emulated import emulator_threads, needs_terminals, open_files, pattern, turn_of

from segmap.emulator import Emulator
from segmap.hokuyo import Geometry, SensorError, UrgSensor

pytest.importorskip("serial", reason="the driver opens ports with pyserial")
pytestmark = needs_terminals

RUNS, SCANS = 20, 6
#: No run takes longer, seconds, on a machine that does other things too.
BOUND = 20.0
WIRE = ("flip", "lose", "stale", "stop", "silence", "unplug")
URG = Geometry(1024, 44, 725, 384, 20, 5600, 0.1)
#: Bytes that the sensor sends before a scan comes, and with the scans.
OPENING, WHOLE = 300, 300 + SCANS * 2138


class Outcome(NamedTuple):
    scans: int
    dropped: int
    error: str
    seconds: float
    happened: bool


def run(open_with, fault, seed) -> Outcome:
    """Ask for some scans from a sensor that goes wrong somewhere on the way; check each beam."""
    rng = np.random.default_rng(seed)
    begun, scans, dropped, error, kind = time.monotonic(), 0, 0, "", fault.partition(" ")[0]
    with Emulator(pattern, speed=10, rng=rng, **open_with) as emulator:
        plan(emulator, fault, rng)
        try:
            with UrgSensor(emulator.port, rates=(115200, 19200), timeout=0.4) as sensor:
                assert sensor.geometry == URG
                stream = sensor.scans() if seed % 2 else iter(sensor.scan, None)
                for scan in itertools.islice(stream, SCANS):
                    turn_of(scan)
                    assert scan.angles[384 - 44] == 0.0
                    scans += 1
                    if kind in ("status", "wrap") and scans == 1 + seed % 4:
                        emulator.inject(kind)
                if seed % 2:
                    stream.close()
                dropped = sensor.dropped
        except SensorError as wrong:
            error = str(wrong)
        happened = kind not in WIRE or kind in emulator.wire.happened
    return Outcome(scans, dropped, error, time.monotonic() - begun, happened)


def plan(emulator, fault, rng):
    kind, _, when = fault.partition(" ")
    if kind in WIRE:
        after = int(rng.integers(0, OPENING if when == "at open" else WHOLE))
        emulator.inject(kind, after=after, seconds=float(rng.uniform(0.05, 1.0)))


FAULTS = {
    "flip": {},
    "lose": {},
    "stale": {},
    "stop": {},
    "silence": {},
    "unplug": {},
    "status": {},
    "wrap": {},
    "streaming at open": {"streaming": True},
    "time mode at open": {"timing": True},
    "wrong rate": {"usb": False, "rate": 19200},
    "flip at open": {},
    "lose at open": {},
    "stop at open": {},
    "flip while streaming": {"streaming": True},
    "lose in SCIP 1.1": {"protocol": "1.1"},
}
#: After these the sensor is never what it was.
FINAL = ("unplug", "status")


@pytest.mark.parametrize("fault", FAULTS)
def test_faults(fault, record_property):
    """Catches a wrong range, a hang, a port or a thread that stays, and an error without advice."""
    before = open_files()
    with ThreadPoolExecutor(5) as pool:
        found = list(pool.map(lambda seed: run(FAULTS[fault], fault, seed), range(RUNS)))
    gc.collect()
    assert emulator_threads() == []
    assert open_files() == before
    assert max(one.seconds for one in found) < BOUND
    assert sum(one.happened for one in found) >= RUNS * 3 // 4
    errors = [one.error for one in found if one.error]
    assert all(one.scans == SCANS or one.error for one in found)
    assert all(": " in error and len(error) > 30 for error in errors)
    record_property("outcome", summary(found))
    if os.environ.get("SEGMAP_TABLE"):
        with Path(os.environ["SEGMAP_TABLE"]).open("a") as file:
            print(f"{fault:<20} {summary(found)}", file=file)
    if fault in FINAL:
        assert len(errors) >= RUNS // 2
    else:
        assert len(errors) <= RUNS // 4, errors


def summary(found) -> str:
    struck = sum(one.happened for one in found)
    whole = sum(one.scans == SCANS and not one.dropped for one in found)
    drops = sum(one.scans == SCANS and one.dropped > 0 for one in found)
    failed = sum(bool(one.error) for one in found)
    return (
        f"{struck} struck: {whole} right, {drops} with {sum(one.dropped for one in found)} drops, "
        f"{failed} errors, at most {max(one.seconds for one in found):.1f} s"
    )


@pytest.mark.parametrize("kind", ["flip", "lose", "stop"])
def test_a_spoiled_scan_is_counted(kind):
    """In the middle of a scan, so that it must be missed: one drop, and the next is right."""
    with (
        Emulator(pattern, speed=10) as emulator,
        UrgSensor(emulator.port, rates=(115200,), timeout=0.5) as sensor,
    ):
        stream = sensor.scans()
        turn_of(next(stream))
        emulator.inject(kind, after=3000)
        for _ in range(5):
            turn_of(next(stream))
        stream.close()
        assert emulator.wire.happened == [kind]
        assert sensor.dropped in (1, 2)


def test_a_hardware_fault_says_what_to_do():
    with (
        Emulator(pattern, speed=10) as emulator,
        UrgSensor(emulator.port, timeout=0.5) as sensor,
    ):
        emulator.inject("status")
        assert sensor.state()["STAT"] == "Motor does not turn."
        for ask in (sensor.scan, lambda: next(sensor.scans())):
            with pytest.raises(SensorError, match=r"status 50 .*switch it off and on"):
                ask()
        assert sensor.dropped == 0, "a fault of the hardware is told at once, not tried again"
        emulator.mend()
        turn_of(sensor.scan())


def test_a_sensor_that_falls_silent():
    """Catches a driver that waits for ever."""
    with (
        Emulator(pattern, speed=10) as emulator,
        UrgSensor(emulator.port, rates=(115200,), timeout=0.2) as sensor,
    ):
        stream = sensor.scans()
        next(stream)
        emulator.inject("silence", seconds=1000)
        begun = time.monotonic()
        with pytest.raises(SensorError, match="no answer to"):
            for _ in stream:
                pass
        assert time.monotonic() - begun < 10
        assert sensor.dropped == 1
        assert "nothing came" in sensor.why


def test_a_stream_that_runs_already():
    """Catches an acknowledgement that got lost, and a scan in its place that is called a fault."""
    with (
        Emulator(pattern, speed=10) as emulator,
        UrgSensor(emulator.port, rates=(115200,), timeout=0.5) as sensor,
    ):
        emulator.inject("lose", after=len("MD0044072501000\n0"))
        stream = sensor.scans()
        for _ in range(3):
            turn_of(next(stream))
        stream.close()
        assert emulator.wire.happened == ["lose"]


@pytest.mark.parametrize(
    "seconds", [float(os.environ.get("SEGMAP_SOAK", "30" if os.environ.get("CI") else "3"))]
)
def test_soak(seconds):
    """Real time: ten scans a second, nothing dropped, nothing that grows."""
    with Emulator(pattern) as emulator, UrgSensor(emulator.port) as sensor:
        begun, turns = time.monotonic(), []
        with contextlib.closing(sensor.scans()) as stream:
            for scan in stream:
                turns.append(turn_of(scan))
                if time.monotonic() - begun > seconds:
                    break
        assert sensor.dropped == 0
        assert (np.diff(turns) > 0).all()
        assert len(turns) > 5 * seconds
