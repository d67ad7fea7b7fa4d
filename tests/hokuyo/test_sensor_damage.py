"""The driver and a sensor in one thread, with a clock that reading moves: damage anywhere."""

import contextlib
import itertools

import numpy as np
import pytest
from emulated import URG, Wired, connected, turn_of
from hypothesis import example, given, settings
from hypothesis import strategies as st

from segmap.hokuyo import SensorError, SensorGone, UrgSensor, _sensor


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
        assert sensor.geometry == URG
        scans = sensor.scans() if streams else iter(sensor.scan, None)
        for scan in itertools.islice(scans, 3):
            turn_of(scan)
            assert scan.angles[384 - 44] == 0.0
        assert sensor.delivered == 3
    assert not port.open
    assert not port.unit.laser


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


@settings(deadline=None, max_examples=150)
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


def test_a_port_that_waits_for_ever_is_refused():
    """Catches a hang: `serial.Serial(device)` has no timeout unless it is given one."""
    port = Wired()
    port.timeout = None
    with pytest.raises(ValueError, match="timeout"):
        connected(port)


def test_waits_get_longer(monkeypatch):
    """Catches a driver that looks for an unplugged sensor as fast as it can, or waits too long."""
    waits, port = [], Wired()

    def sleep(seconds):
        waits.append(seconds)
        assert len(waits) < 50, "it looks for the sensor without end"
        port.now += seconds

    def gone(device, rate):
        raise SensorError(f"cannot open {device}")

    monkeypatch.setattr(_sensor, "open_port", lambda device, rate: port)
    monkeypatch.setattr(_sensor.time, "sleep", sleep)
    with UrgSensor("/dev/laser", reconnect=9.0, clock=lambda: port.now) as sensor:
        monkeypatch.setattr(_sensor, "open_port", gone)
        port.gone = True
        with pytest.raises(SensorGone, match="not back within 9 s: cannot open /dev/laser"):
            sensor.scan()
        assert waits == pytest.approx([0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0, 1.9])
        with pytest.raises(SensorError, match="closed"):
            sensor.scan()
    assert not port.open


def test_a_lost_block_is_noticed():
    """Catches a scan of 32 beams less, each block of which has its sum: their angles are wrong."""

    def spoil(data, begin):
        if b"99b" not in data or port.now < 1:
            return data
        lines = data.split(b"\n")
        return b"\n".join([*lines[:5], *lines[6:]])

    port = Wired(spoil)
    with (
        connected(port) as sensor,
        contextlib.closing(sensor.scans(short=True)) as scans,
        pytest.raises(SensorError, match="650 beams, asked for 682: bytes were lost"),
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
