"""The driver and the emulated sensor in one thread: connecting, asking, ranges and times."""

import contextlib
import itertools

import numpy as np
import pytest
from emulated import Wired, connected, turn_of
from scip import answer_instead

from segmap.sensors import SensorError, UrgSensor, ports
from segmap.sensors.emulator import Room, _worlds
from segmap.simulation import URG_04LX, rectangular_room


@contextlib.contextmanager
def sensor_of(world=None, **state):
    with connected(Wired(**({} if world is None else {"world": world}), **state)) as sensor:
        yield sensor


def first(sensor, count):
    with contextlib.closing(sensor.scans()) as scans:
        return list(itertools.islice(scans, count))


# ---------------------------------------------------------------------------- connect
@pytest.mark.parametrize(
    "state",
    [
        {},
        {"protocol": "1.1"},
        {"streaming": True},
        {"rate": 19200, "protocol": "1.1"},
        {"rate": 19200, "streaming": True},
    ],
    ids=str,
)
def test_connects_whatever_it_was_left_doing(state):
    """Catches a driver that takes the end of a scan for an answer."""
    port = Wired(**state)
    with connected(port) as sensor:
        assert sensor.rate == port.baudrate
        assert sensor.info["SERI"] == "H0000000"
        assert (sensor.geometry.first, sensor.geometry.last) == (44, 725)
        turn_of(sensor.scan())
    assert not port.open


def test_an_old_firmware_is_refused():
    """Without check sums nobody can promise that no range is wrong."""
    port = Wired(protocol="1.1")
    answer_instead(port.unit, "SCIP2.0", lambda text: b"SCIP2.0\nE\n\n")
    with pytest.raises(SensorError, match="firmware 3 or later"):
        connected(port)


def test_geometry_comes_from_the_sensor(monkeypatch):
    """Catches numbers of an URG-04LX in the driver."""
    monkeypatch.setitem(_worlds.LIMITS, "AMIN", "100")
    monkeypatch.setitem(_worlds.LIMITS, "AFRT", "400")
    with sensor_of() as sensor:
        scan = sensor.scan()
        assert len(scan) == 626
        assert scan.angles[300] == 0.0
        turn_of(scan, first=100)


def test_auto_looks_for_the_vendor(monkeypatch):
    """Catches a modem that is taken for the laser, or one of two lasers taken at random."""
    list_ports = pytest.importorskip("serial.tools.list_ports")
    from serial.tools.list_ports_common import ListPortInfo

    def plugged(*devices):
        found = [ListPortInfo(device) for device, _ in devices]
        for port, (_, vendor) in zip(found, devices, strict=True):
            port.vid = vendor
        monkeypatch.setattr(list_ports, "comports", lambda: found)

    plugged(("/dev/modem", 0x1234), ("/dev/laser", 0x15D1))
    with pytest.raises(SensorError, match="cannot open /dev/laser"):
        UrgSensor("auto")
    assert [port.device for port in ports()] == ["/dev/laser", "/dev/modem"]
    plugged(("/dev/modem", None))
    with pytest.raises(SensorError, match="no Hokuyo"):
        UrgSensor("auto")
    plugged(("/dev/a", 0x15D1), ("/dev/b", 0x15D1))
    with pytest.raises(SensorError, match=r"name one of \['/dev/a', '/dev/b'\]"):
        UrgSensor()


# ----------------------------------------------------------------------------- ranges
def test_two_streams_by_turns():
    """Catches a driver that takes the scans of one stream for those of the other."""
    with sensor_of() as sensor, contextlib.ExitStack() as stack:
        one, other = (stack.enter_context(contextlib.closing(sensor.scans())) for _ in range(2))
        for _ in range(3):
            turns = [turn_of(scan) for scan in (next(one), next(other), sensor.scan())]
            assert turns == sorted({*turns})
        assert (sensor.delivered, sensor.dropped) == (9, 0)
        assert set(np.diff([turn_of(scan) for scan in first(sensor, 10)])) == {1}


def test_a_room_is_seen_as_it_is():
    """Catches beams that turn the wrong way, or steps that lie elsewhere."""
    size, place = (4, 3), (1.0, 1.0)
    world = Room(rectangular_room(*size), [(*place, 0.0)], URG_04LX.ideal())
    with sensor_of(world) as sensor:
        points = sensor.scan().points() + place
    (x, y), (width, depth) = points.T, size
    assert len(x) == URG_04LX.beams
    off = np.min([abs(x), abs(x - width), abs(y), abs(y - depth)], 0)
    assert off.max() < 0.001
    assert points[0, 1] < place[1] < points[-1, 1]


def test_times_are_the_sensors_own():
    """Catches times of arrival: the reader sleeps, the turns stay even; the clock wraps."""
    port = Wired(stamp=(1 << 24) - 1500)
    with connected(port) as sensor, contextlib.closing(sensor.scans()) as stream:
        scans = []
        for scan in itertools.islice(stream, 6):
            scans.append(scan)
            port.now += 0.06 * (len(scans) % 2)
        gaps = np.diff([scan.time for scan in scans]) / np.diff([turn_of(scan) for scan in scans])
        assert gaps == pytest.approx([0.1] * 5, abs=0.03)
        assert abs(scans[-1].time - port.now) < 1.0
        gaps = np.diff([scan.time for scan in itertools.islice(stream, 20)])
        assert 0 < gaps.min() <= gaps.max() < 1.0


# --------------------------------------------------------------------------- leaving
def test_a_closed_sensor_says_so():
    """Catches a closed sensor that is looked for, and a second end that asks it something."""
    port = Wired()
    sensor = connected(port)
    stream = sensor.scans()
    next(stream)
    sensor.close()
    sensor.close()
    sensor.stop()
    assert "closed" in repr(sensor) and not port.open and not port.unit.laser
    for ask in (sensor.scan, lambda: next(stream)):
        with pytest.raises(SensorError, match="closed: make a new"):
            ask()


def test_nothing_that_wedges_the_unit():
    """Catches ME, HD and their like, and commands that no manual of the URG-04LX names."""
    port = Wired(protocol="1.1")
    with connected(port) as sensor:
        sensor.scan()
        first(sensor, 2)
        said = {text[:2] for text in port.unit.received}
        assert said <= {"QT", "SC", "VV", "PP", "MD", "TM"}


def test_a_laser_that_may_be_on_is_switched_off():
    """The sensor begins to stream, and nobody hears that it does.

    Catches a driver that learns of the laser from the answer alone.
    """
    port = Wired()
    with connected(port) as sensor:
        heard, port.spoil = port.spoil, lambda data, at: b""
        with pytest.raises(SensorError, match="no answer to"):
            next(sensor.scans())
        port.spoil = heard
        assert not port.unit.laser and any(text.startswith("MD") for text in port.unit.received)
        turn_of(sensor.scan())
