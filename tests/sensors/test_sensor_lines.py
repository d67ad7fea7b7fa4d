"""The driver and the emulator over real lines: one contract for a pseudo-terminal and for TCP.

Whatever happens on either line: right ranges, a laser that is off in the end, a port that is free.
"""

import contextlib
import gc
import itertools
import socket

import pytest
from emulated import (
    NetworkEmulator,
    emulator_threads,
    needs_terminals,
    open_files,
    pattern,
    spoiled,
    turn_of,
    wait_for,
)

from segmap.sensors import SensorError, UrgSensor
from segmap.sensors.emulator import Emulator


@pytest.fixture(scope="module", autouse=True)
def frozen():
    """What was there before is not looked through at each test: it takes seconds."""
    gc.collect()
    gc.freeze()
    yield
    gc.unfreeze()


@pytest.fixture(autouse=True)
def nothing_is_left():
    """Catches a port, a connection or a thread that a test leaves behind."""
    gc.collect()  # what an earlier test left
    before = open_files()
    yield
    gc.collect()
    assert emulator_threads() == []
    assert open_files() == before


def of(emulator, **settings):
    return UrgSensor(emulator.port, **({"timeout": 0.3} | settings))


class Linked(Emulator):
    """A terminal that has one name, also when it is plugged in again."""

    def __init__(self, *world, link, **settings):
        self.link = link
        super().__init__(*world, **settings)

    @property
    def port(self):
        return str(self.link)

    def start(self):
        super().start()
        self.link.unlink(missing_ok=True)
        self.link.symlink_to(self._end.name)


class Line:
    """A kind of line: how a sensor is put at it, and what its scans show."""

    def __init__(self, kind, folder):
        self.is_tcp, self.turn, self.folder = kind == "tcp", turn_of, folder

    def emulator(self):
        if self.is_tcp:
            return spoiled(NetworkEmulator(pattern, speed=10.0))
        (link := self.folder / "laser").unlink(missing_ok=True)
        return spoiled(Linked(pattern, link=link, speed=10.0))

    def open(self, name):
        import serial

        url = name.replace("tcp://", "socket://")  # pyserial's
        return serial.serial_for_url(url, timeout=0.02)


@pytest.fixture(params=[pytest.param("terminal", marks=needs_terminals), "tcp"])
def line(request, tmp_path):
    if request.param == "terminal":
        pytest.importorskip("serial", reason="the driver opens ports with pyserial")
    return Line(request.param, tmp_path)


# ------------------------------------------------------------------------------ scans
def test_scans_and_a_stream_that_is_ended(line):
    """Catches two characters a distance, geometry of another model, a lost or doubled byte."""
    with line.emulator() as emulator, of(emulator) as sensor:
        line.turn(sensor.scan())
        with contextlib.closing(sensor.scans()) as scans:
            turns = [line.turn(scan) for scan in itertools.islice(scans, 12)]
        assert len(set(turns)) == 12 and (sensor.delivered, sensor.dropped) == (13, 0)
        assert emulator.unit.received[-1] == "QT" and not emulator.unit.laser
        assert sensor.rate == (100_000_000 if line.is_tcp else 115200)
        if line.is_tcp:  # nothing to agree on
            assert not {text for text in emulator.unit.received if text[:2] == "SS"}


def test_a_port_that_is_handed_in(line):
    """Catches a driver that needs the name of a device, and one that leaves the port open."""
    with line.emulator() as emulator:
        port = line.open(emulator.port)
        with UrgSensor(port, timeout=0.3) as sensor:
            line.turn(sensor.scan())
        with pytest.raises(OSError):
            port.write(b"QT\n")


# ----------------------------------------------------------------------------- opening
def test_one_program_at_a_time(line):
    """Catches two that get each other's answers; the next is served as soon as the first leaves."""
    with line.emulator() as emulator:
        for _ in range(2):
            with of(emulator) as sensor:
                line.turn(sensor.scan())
                with pytest.raises(SensorError, match="another program uses it"):
                    of(emulator)
                line.turn(sensor.scan())


def test_a_port_where_nothing_answers(line, tmp_path):
    with line.emulator() as emulator:
        emulator.inject("silence", seconds=60)
        at = r"at 1\d+ bit/s"
        with pytest.raises(SensorError, match=f"nothing answers as a URG does {at}"):
            of(emulator, timeout=0.1)
    if not line.is_tcp:
        with pytest.raises(SensorError, match=r"cannot open .*it is not there: is the sensor"):
            UrgSensor(str(tmp_path / "ttyACM7"))


def test_a_program_that_crashed_left_it_streaming():
    with NetworkEmulator(pattern, speed=10.0) as emulator:
        host, port = emulator.port.removeprefix("tcp://").split(":")
        with socket.create_connection((host, int(port))) as crashed:
            crashed.sendall(b"MD0044072501000\n")
            assert crashed.recv(10)
        with of(emulator) as sensor:
            assert emulator.unit.stream is None
            turn_of(sensor.scan())


# ---------------------------------------------------------------------------- leaving
def crash(sensor):
    with sensor:
        next(sensor.scans())
        raise ZeroDivisionError


def interrupt(sensor):
    with sensor:
        for _ in sensor.scans():
            raise KeyboardInterrupt


def forget(sensor):
    """Its laser is on, and so it stays while anybody holds the stream."""


def test_the_laser_is_off_and_the_port_free(line):
    with line.emulator() as emulator:
        for leave in (crash, interrupt, forget, UrgSensor.close):
            sensor = of(emulator)
            stream = sensor.scans()
            line.turn(next(stream))
            assert emulator.unit.laser
            with contextlib.suppress(ZeroDivisionError, KeyboardInterrupt):
                leave(sensor)
            del sensor, stream
            wait_for(lambda: not emulator.unit.laser)
            assert emulator.unit.stream is None


# --------------------------------------------------------------------------- unplugged
def test_unplugged_or_silent_is_an_error(line):
    with line.emulator() as emulator:
        with of(emulator) as sensor:
            stream = sensor.scans()
            next(stream)
            emulator.stop()
            with pytest.raises(SensorError, match="plug it in"):
                list(stream)
        emulator.start()
        with of(emulator, timeout=0.1) as sensor:
            emulator.inject("silence", seconds=60)
            with pytest.raises(SensorError, match="no answer to"):
                sensor.scan()
            assert "closed" not in repr(sensor), "it may be asked again"
