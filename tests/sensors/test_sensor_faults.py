"""The driver and a sensor in one thread, by a clock that reading moves: damage and faults.

A right scan, a counted drop, or a SensorError with advice; nothing else.
"""

import contextlib
import itertools
from functools import partial

import numpy as np
import pytest
from emulated import FAULTS, URG, Wired, connected, run, turn_of
from hypothesis import example, given, settings
from hypothesis import strategies as st

from segmap.sensors import SensorError

#: Runs with a fault; after some of them the sensor is never what it was.
RUNS, FINAL = 20, ("unplug", "status")


def struck(at, kind, what):
    """Damage to the bytes at one position: flipped, lost, doubled, or others put in."""

    def spoil(data, begin):
        k = at - begin
        if not 0 <= k < len(data):
            return data
        changed = {
            "flip": bytes([data[k] ^ 1 << what[0] % 8]) + data[k + 1 :],
            "lose": data[k + len(what) :],
            "double": data[k : k + len(what)] + data[k:],
            "insert": what + data[k:],
        }
        return data[:k] + changed[kind]

    return spoil


damage = st.builds(
    struck,
    st.one_of(st.integers(0, 400), st.integers(0, 9000)),
    st.sampled_from(["flip", "lose", "double", "insert"]),
    st.binary(min_size=1, max_size=3),
)


@settings(deadline=None, max_examples=150)
@given(damage, st.sampled_from([{}, {"protocol": "1.1"}]), st.booleans())
def test_one_damage_anywhere(spoil, state, streams):
    """Catches a wrong range, direction or geometry, a laser left on, an end that never comes."""
    port = Wired(spoil, **state)
    with contextlib.suppress(SensorError), connected(port) as sensor:
        assert sensor.geometry[:7] == URG
        scans = sensor.scans() if streams else iter(sensor.scan, None)
        for scan in itertools.islice(scans, 3):
            turn_of(scan)
            assert scan.angles[384 - 44] == 0.0
        assert sensor.delivered == 3
    assert not port.open
    assert not port.unit.laser


def test_a_single_scan_that_is_damaged_is_asked_for_anew_at_once():
    """Catches a driver that waits for a scan that nobody has asked for."""
    port = Wired()
    with connected(port) as sensor:
        port.spoil = struck(port.sent + 500, "flip", b"\1")
        turn_of(sensor.scan())
        assert (sensor.delivered, sensor.dropped) == (1, 1)


pieces = st.sampled_from(
    [b"QT\n00P\n\n", b"QT\n0Ee\n\n", b"QT\nE\n\n", b"PP\n00P\nARES:1024;\\\n\n", b"\n", b"0"]
)


class Babbling(Wired):
    """Something else at the port: it says what it likes, whatever it is told."""

    def __init__(self, words, endless):
        super().__init__()
        self.words, self.endless = itertools.cycle(words) if endless else iter(words), endless

    @property
    def in_waiting(self):
        self.kept += next(self.words, b"")
        return len(self.kept)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.one_of(st.binary(max_size=300), pieces), min_size=1, max_size=40), st.booleans())
@example([b"x"], True)
@example([b"QT\n00P\n\n"], True)
@example([b"QT\n0Ee\n\n"], True)
@example([b"QT\nE\n\n", b"SCIP2.0\n0\n\n"], True)
def test_something_else_at_the_port(words, endless):
    """Nothing but a SensorError, within bounded time, and the port is free again.

    Catches bytes that trickle on for ever and keep the driver from looking at the clock.
    """
    port = Babbling(words, endless)
    with pytest.raises(SensorError, match=r".{20}"):
        connected(port)
    assert not port.open


def test_a_lost_block_is_noticed():
    """Catches a scan of 32 beams less, each block of which has its sum: their angles are wrong."""

    def spoil(data, begin):
        if b"99b" not in data or port.now < 1:
            return data
        lines = data.split(b"\n")
        return b"\n".join([*lines[:5], *lines[8:]])

    port = Wired(spoil)
    with (
        connected(port) as sensor,
        contextlib.closing(sensor.scans()) as scans,
        pytest.raises(SensorError, match="618 beams, asked for 682: bytes were lost"),
    ):
        for scan in scans:
            assert len(scan) == 682


class EveryThird:
    """Puts something else into each third scan of a stream."""

    def __init__(self, old, new):
        self.old, self.new, self.scans = old, new, 0

    def __call__(self, data, begin):
        self.scans += b"99b" in data
        strikes = b"99b" in data and self.scans % 3 == 0
        return data.replace(self.old, self.new, 1) if strikes else data


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [(b"0", b"1", "36 lines that belong to no scan"), (b"99b", b"98a", "status 98")],
    ids=["a digit", "work resumed"],
)
def test_what_is_dropped_is_counted_with_its_reason(old, new, why):
    """As many drops as damaged scans, none of them handed over, none of the others lost."""
    with connected(Wired(EveryThird(old, new))) as sensor:
        turns = [turn_of(scan) for scan in itertools.islice(sensor.scans(), 8)]
        assert (sensor.delivered, sensor.dropped) == (8, 3)
        assert np.diff(turns).max() == 2
        assert why in sensor.why


# ----------------------------------------------------------------------------- faults
@pytest.mark.parametrize("fault", FAULTS)
def test_faults(fault):
    """Catches a wrong range, a loop without end, a laser left on, and an error without advice."""
    found = []
    for seed in range(RUNS):
        port = Wired(seed=seed, **FAULTS[fault])
        sensor_at = partial(connected, port)
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


def test_a_hardware_fault_says_what_to_do():
    port = Wired()
    with connected(port) as sensor:
        port.unit.trouble = True
        for ask in (sensor.scan, lambda: next(sensor.scans())):
            with pytest.raises(SensorError, match=r"status 50 .*switch it off and on"):
                ask()
        assert sensor.dropped == 0, "a fault of the hardware is told at once, not tried again"
        port.unit.trouble = False
        turn_of(sensor.scan())


@pytest.mark.parametrize("late", [False, True])
def test_a_stream_that_runs_already(late):
    """The acknowledgement of a stream gets lost, so that a scan comes in its place.

    Catches that scan called a fault, and a second acknowledgement called one that comes late.
    """
    port = Wired()
    with connected(port) as sensor, contextlib.closing(sensor.scans()) as stream:
        port.plan("lose", len("MD0044072501000\n0"))
        turn_of(next(stream))
        if late:
            port.kept += b"MD0044072501000\n00P\n\n"
        for _ in range(3):
            turn_of(next(stream))
        assert port.wire.happened == ["lose"]
        assert sensor.dropped == 0
