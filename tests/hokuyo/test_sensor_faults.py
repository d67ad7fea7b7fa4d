"""Every fault, at random moments: a right scan, a counted drop, or a SensorError with advice.

Twenty times each in one thread, by a clock that reading moves; a few times each through a real
pseudo-terminal, pyserial and threads, where a hang, a file or a thread could stay behind.
"""

import contextlib
import gc
import os
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest
from conftest import slow
from emulated import (
    BOUND,
    FAULTS,
    FINAL,
    Wired,
    connected,
    emulator_threads,
    needs_terminals,
    open_files,
    pattern,
    run,
    turn_of,
)

from segmap.hokuyo import SensorError, UrgSensor
from segmap.hokuyo.emulator import Emulator
from segmap.hokuyo.emulator._device import Fault

RUNS = 20
#: Runs through a terminal, all at the same time.
REAL_RUNS = 4


@pytest.mark.parametrize("fault", FAULTS)
def test_faults(fault):
    """Catches a wrong range, a loop without end, a laser left on, and an error without advice."""
    found = []
    for seed in range(RUNS):
        port = Wired(seed=seed, **FAULTS[fault])
        sensor_at = partial(connected, port, rates=(115200, 19200))
        found.append(run(sensor_at, port.unit, port.wire, fault, seed))
        assert not port.open
        assert port.gone or port.unit.trouble or not port.unit.laser
    errors = [one.error for one in found if one.error]
    assert sum(one.happened for one in found) >= RUNS * 3 // 4
    if fault in FINAL:
        assert len(errors) >= RUNS // 2
    else:
        assert len(errors) <= RUNS // 4, errors
    if fault in ("flip", "lose", "stop"):  # nearly all strike a scan, which must be missed
        assert sum(one.dropped in (1, 2) for one in found) >= RUNS * 3 // 4


def through_a_terminal(fault, seed) -> float:
    """Seconds that a run takes."""
    begun, rng = time.monotonic(), np.random.default_rng(seed)
    with Emulator(pattern, speed=10, rng=rng, **FAULTS[fault]) as emulator:
        sensor_at = partial(UrgSensor, emulator.port, rates=(115200, 19200), timeout=0.4)
        run(sensor_at, emulator.unit, emulator.wire, fault, seed)
    return time.monotonic() - begun


@needs_terminals
@pytest.mark.parametrize("fault", [f if k % 3 == 0 else slow(f) for k, f in enumerate(FAULTS)])
def test_faults_through_a_terminal(fault):
    """Catches a wrong range, a hang, and a port or a thread that stays."""
    pytest.importorskip("serial", reason="the driver opens ports with pyserial")
    before = open_files()
    with ThreadPoolExecutor(REAL_RUNS) as pool:
        seconds = list(pool.map(lambda seed: through_a_terminal(fault, seed), range(REAL_RUNS)))
    gc.collect()
    assert emulator_threads() == []
    assert open_files() == before
    assert max(seconds) < BOUND


def test_a_hardware_fault_says_what_to_do():
    port = Wired()
    with connected(port) as sensor:
        port.unit.fail("Motor does not turn.")
        assert sensor.state()["STAT"] == "Motor does not turn."
        for ask in (sensor.scan, lambda: next(sensor.scans())):
            with pytest.raises(SensorError, match=r"status 50 .*switch it off and on"):
                ask()
        assert sensor.dropped == 0, "a fault of the hardware is told at once, not tried again"
        port.unit.fail("")
        turn_of(sensor.scan())


def test_a_sensor_that_falls_silent():
    """Catches a driver that waits for ever."""
    port = Wired()
    with connected(port) as sensor:
        stream = sensor.scans()
        next(stream)
        port.wire.plan(Fault("silence", 0, 1000.0))
        begun = port.now
        with pytest.raises(SensorError, match="no answer to"):
            next(stream)
        assert port.now - begun < 10
        assert sensor.dropped == 1
        assert "nothing came" in sensor.why


@pytest.mark.parametrize("late", [False, True])
def test_a_stream_that_runs_already(late):
    """The acknowledgement of a stream gets lost, so that a scan comes in its place.

    Catches that scan called a fault, and a second acknowledgement called one that comes late.
    """
    port = Wired()
    with connected(port) as sensor, contextlib.closing(sensor.scans()) as stream:
        port.wire.plan(Fault("lose", len("MD0044072501000\n0")))
        turn_of(next(stream))
        if late:
            port.kept += b"MD0044072501000\n00P\n\n"
        for _ in range(3):
            turn_of(next(stream))
        assert port.wire.happened == ["lose"]
        assert sensor.dropped == 0


@needs_terminals
@pytest.mark.parametrize(
    "seconds", [float(os.environ.get("SEGMAP_SOAK", "30" if os.environ.get("CI") else "3"))]
)
def test_soak(seconds):
    """Real time: ten scans a second, nothing dropped, nothing that grows."""
    pytest.importorskip("serial", reason="the driver opens ports with pyserial")
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
