"""The driver and the emulated sensor in one thread: connecting, asking, ranges and times."""

import contextlib
import itertools

import numpy as np
import pytest
from emulated import Wired, connected, turn_of

from segmap.sensors import SensorError, UrgSensor, ports
from segmap.sensors.emulator import Room
from segmap.simulation import rectangular_room


@contextlib.contextmanager
def sensor_of(world=None, **state):
    with connected(Wired(**({} if world is None else {"world": world}), **state)) as sensor:
        yield sensor


def first(sensor, count, **settings):
    with contextlib.closing(sensor.scans(**settings)) as scans:
        return list(itertools.islice(scans, count))


# ---------------------------------------------------------------------------- connect
@pytest.mark.parametrize(
    "state",
    [
        {},
        {"protocol": "1.1"},
        {"streaming": True},
        {"timing": True},
        {"streaming": True, "timing": True},
        {"usb": False, "protocol": "1.1"},
        {"usb": False, "streaming": True},
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
    with pytest.raises(SensorError, match="firmware 3 or later"):
        connected(Wired(protocol="1.1 only"))


def test_geometry_comes_from_the_sensor(monkeypatch):
    """Catches numbers of an URG-04LX in the driver."""
    told = Wired().unit.model.limits
    monkeypatch.setitem(told, "AMIN", "100")
    monkeypatch.setitem(told, "AFRT", "400")
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
        wide = stack.enter_context(contextlib.closing(sensor.scans()))
        part = stack.enter_context(contextlib.closing(sensor.scans(first=384, last=400)))
        for _ in range(3):
            assert [len(next(wide)), len(next(part)), len(sensor.scan())] == [682, 17, 682]
        assert sensor.dropped == 0
        before = [next(part) for _ in range(3)]
        sensor.scan()
        assert len(before) == 3 and next(part).time > before[-1].time + 0.2
        assert sensor.unsent == 0, "no stream was running meanwhile"


def test_skip_cluster_part_and_short():
    with sensor_of() as sensor:
        assert set(np.diff([turn_of(scan) for scan in first(sensor, 10)])) == {1}
        assert (sensor.delivered, sensor.dropped) == (10, 0)
        assert set(np.diff([turn_of(scan) for scan in first(sensor, 3, skip=2)])) == {3}
        part = sensor.scan(first=384, last=400)
        assert (len(part), part.angles[0]) == (17, 0.0)
        turn_of(part, first=384)
        (wide,) = first(sensor, 1, cluster=3)
        assert (len(wide), len(wide.angles)) == (228, 228)
        (short,) = first(sensor, 1, short=True)
        assert short.max_range == 4.095
        turn_of(short)


@pytest.mark.parametrize(
    ("model", "size", "place"),
    [("URG-04LX", (4, 3), (1.0, 1.0)), ("UST-10LX", (20, 12), (8.0, 5.0))],
)
def test_a_room_is_seen_as_it_is(model, size, place):
    """Catches beams that turn the wrong way, or steps that lie elsewhere."""
    told = Wired(model=model).unit.model.sensor
    sensor = told.ideal()
    world = Room(rectangular_room(*size), [(*place, 0.0)], sensor, model=model)
    with sensor_of(world, model=model) as sensor:
        points = sensor.scan().points() + place
    (x, y), (width, depth) = points.T, size
    assert len(x) == told.beams
    off = np.min([abs(x), abs(x - width), abs(y), abs(y - depth)], 0)
    assert off.max() < 0.001
    assert points[0, 1] < place[1] < points[-1, 1]


def test_times_are_the_sensors_own():
    """Catches times of arrival: the reader sleeps, the turns stay even; the clock wraps."""
    port = Wired()
    with connected(port) as sensor, contextlib.closing(sensor.scans()) as stream:
        scans = []
        for scan in itertools.islice(stream, 6):
            scans.append(scan)
            port.now += 0.06 * (len(scans) % 2)
        gaps = np.diff([scan.time for scan in scans]) / np.diff([turn_of(scan) for scan in scans])
        assert gaps == pytest.approx([0.1] * 5, abs=0.03)
        assert abs(scans[-1].time - port.now) < 1.0
        port.unit.wrap_clock()
        next(stream)
        gaps = np.diff([scan.time for scan in itertools.islice(stream, 4)])
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
    for ask in (sensor.scan, sensor.state, lambda: next(stream)):
        with pytest.raises(SensorError, match="closed: make a new"):
            ask()


def test_nothing_that_wedges_the_unit():
    """Catches ME, HD and their like, and commands that no manual of the URG-04LX names."""
    port = Wired(protocol="1.1")
    with connected(port) as sensor:
        sensor.scan()
        first(sensor, 2)
        first(sensor, 2, short=True)
        sensor.state()
        said = {text[:2] for text in port.unit.received}
        assert said <= {"QT", "SC", "VV", "PP", "II", "BM", "GD", "MD", "MS", "SS", "TM"}


@pytest.mark.parametrize("left", [1 << 24, *range(250, 4250, 500)])
def test_turns_are_counted_over_the_end_of_the_sensors_clock(left):
    """It counts milliseconds to 2 ** 24, four and a half hours, and begins anew.

    Catches turns left out while a loop compiles that nobody counts, and a pace below nought on a
    slow line.
    """
    port = Wired(stamp=(1 << 24) - left)
    with connected(port) as sensor, contextlib.closing(sensor.scans()) as stream:
        before = [turn_of(next(stream)) for _ in range(3)][-1]
        assert sensor.unsent == 0
        port.now += 2.0
        after = [turn_of(next(stream)) for _ in range(4)][-1]
        assert (sensor.unsent, sensor.dropped) == (after - before - 4, 0)
        assert sensor.unsent > 15 and f"{sensor.unsent} not sent" in repr(sensor)
    with connected(Wired(usb=False, stamp=(1 << 24) - left)) as sensor:
        first(sensor, 5)
        assert sensor.unsent == 0, "the line is slow, and nobody late"


@pytest.mark.parametrize("kind", ["MD", "MS"])
def test_a_laser_that_may_be_on_is_switched_off(kind):
    """The sensor begins to stream, and nobody hears that it does.

    Catches a driver that learns of the laser from the answer alone.
    """
    port = Wired()
    with connected(port) as sensor:
        heard, port.spoil = port.spoil, lambda data, at: b""
        with pytest.raises(SensorError, match="no answer to"):
            next(sensor.scans(short=kind == "MS"))
        port.spoil = heard
        assert not port.unit.laser and any(text.startswith(kind) for text in port.unit.received)
        turn_of(sensor.scan())
