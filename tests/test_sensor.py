"""The driver against the emulator, through a real pseudo-terminal and pyserial."""

import contextlib
import gc
import itertools
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from emulated import (
    capture,
    emulator_threads,
    needs_terminals,
    open_files,
    pattern,
    turn_of,
)

from segmap import read
from segmap.emulator import Emulator, Replay, Room
from segmap.hokuyo import SensorError, SensorGone, UrgSensor, find_port, ports
from segmap.hokuyo.__main__ import main as bench
from segmap.hokuyo._stream import RATES
from segmap.simulation import URG_04LX, rectangular_room

pytest.importorskip("serial", reason="the driver opens ports with pyserial")
pytestmark = needs_terminals

FAST = {"speed": 10.0}


@pytest.fixture(autouse=True)
def nothing_is_left():
    """Catches a port, a pseudo-terminal or a thread that a test leaves behind."""
    before = open_files()
    yield
    gc.collect()
    assert emulator_threads() == []
    assert open_files() == before


def of(emulator, **settings):
    return UrgSensor(emulator.port, **({"timeout": 0.5} | settings))


def first(sensor, count, **settings):
    return list(itertools.islice(sensor.scans(**settings), count))


# ---------------------------------------------------------------------------- connect
@pytest.mark.parametrize(
    "state",
    [
        {},
        {"protocol": "1.1"},
        {"streaming": True},
        {"timing": True},
        {"streaming": True, "timing": True},
        {"rate": 57600, "usb": False},
        {"rate": 250000, "usb": False},
        {"rate": 57600, "usb": False, "protocol": "1.1"},
        {"rate": 115200, "usb": False, "streaming": True},
    ],
    ids=str,
)
def test_connects_whatever_it_was_left_doing(state):
    rates = (115200, 57600, 250000)
    with Emulator(pattern, **FAST, **state) as emulator, of(emulator, rates=rates) as sensor:
        assert sensor.rate == 115200
        assert sensor.info["SERI"] == "H0000000"
        assert (sensor.geometry.first, sensor.geometry.last) == (44, 725)
        turn_of(sensor.scan())


@pytest.mark.parametrize("rate", RATES)
def test_connects_at_any_bit_rate(rate):
    """Catches a rate that is missing, or a driver that stays at the one it found."""
    with Emulator(pattern, rate=rate, usb=False, **FAST) as emulator, of(emulator) as sensor:
        assert sensor.rate == emulator.unit.rate == 115200
        turn_of(sensor.scan())


def test_an_old_firmware_is_refused():
    """Without check sums nobody can promise that no range is wrong."""
    with (
        Emulator(protocol="1.1 only", **FAST) as emulator,
        pytest.raises(SensorError, match="firmware 3 or later"),
    ):
        of(emulator)


def test_geometry_comes_from_the_sensor(monkeypatch):
    """Catches numbers of an URG-04LX in the driver."""
    from segmap.emulator import _unit

    monkeypatch.setitem(_unit.PARAMETERS, "AMIN", "100")
    monkeypatch.setitem(_unit.PARAMETERS, "AFRT", "400")
    with Emulator(pattern, **FAST) as emulator, of(emulator) as sensor:
        scan = sensor.scan()
        assert len(scan) == 626
        assert scan.angles[300] == 0.0
        turn_of(scan, first=100)


def test_a_port_that_is_not_there(tmp_path):
    with pytest.raises(SensorError, match=r"cannot open .*it is not there: is the sensor plugged"):
        UrgSensor(str(tmp_path / "ttyACM7"))


def test_a_port_that_another_program_uses():
    with (
        Emulator(**FAST) as emulator,
        of(emulator),
        pytest.raises(SensorError, match="another program uses it"),
    ):
        of(emulator)


def test_something_else_at_the_port():
    """A port that says nothing: the error comes within seconds, and the port is free."""
    with Emulator(**FAST) as emulator:
        emulator.inject("silence", seconds=60)
        with pytest.raises(SensorError, match="nothing answers as a URG does at 115200 bit/s"):
            of(emulator, rates=(115200,))


def test_auto_looks_for_the_vendor(monkeypatch):
    """Catches a modem that is taken for the laser, or one of two lasers taken at random."""
    from serial.tools import list_ports
    from serial.tools.list_ports_common import ListPortInfo

    def plugged(*devices):
        found = [ListPortInfo(device) for device, _ in devices]
        for port, (_, vendor) in zip(found, devices, strict=True):
            port.vid = vendor
        monkeypatch.setattr(list_ports, "comports", lambda: found)

    plugged(("/dev/modem", 0x1234), ("/dev/laser", 0x15D1))
    assert find_port() == "/dev/laser"
    assert [port.device for port in ports()] == ["/dev/laser", "/dev/modem"]
    plugged(("/dev/modem", None))
    with pytest.raises(SensorError, match="no Hokuyo"):
        UrgSensor("auto")
    plugged(("/dev/a", 0x15D1), ("/dev/b", 0x15D1))
    with pytest.raises(SensorError, match=r"name one of \['/dev/a', '/dev/b'\]"):
        UrgSensor()


# ----------------------------------------------------------------------------- ranges
def test_a_stream_is_turn_after_turn():
    with Emulator(pattern, **FAST) as emulator, of(emulator) as sensor:
        turns = [turn_of(scan) for scan in first(sensor, 10)]
        assert (np.diff(turns) > 0).all()
        assert sensor.delivered == 10
        assert sensor.dropped == 0


def test_skip_cluster_part_and_short():
    with Emulator(pattern, **FAST) as emulator, of(emulator) as sensor:
        turns = [turn_of(scan) for scan in first(sensor, 3, skip=2)]
        assert (np.diff(turns) >= 3).all()
        part = sensor.scan(first=384, last=400)
        assert (len(part), part.angles[0]) == (17, 0.0)
        turn_of(part, first=384)
        (wide,) = first(sensor, 1, cluster=3)
        assert (len(wide), len(wide.angles)) == (228, 228)
        (short,) = first(sensor, 1, short=True)
        assert short.max_range == 4.095
        turn_of(short)


@pytest.mark.parametrize("wrong", [{"first": 700, "last": 44}, {"last": 9999}, {"cluster": 0}])
def test_steps_that_it_has_not(wrong):
    with Emulator(**FAST) as emulator, of(emulator) as sensor:
        with pytest.raises(ValueError, match="steps must lie in order"):
            sensor.scan(**wrong)
        with pytest.raises(ValueError, match=r"skip must be .* at most 9"):
            next(sensor.scans(skip=10))


@pytest.mark.parametrize("wrong", [{"first": 100.0}, {"cluster": 2.5}, {"last": "725"}])
def test_steps_are_whole_numbers(wrong):
    """Catches a request that the sensor refuses, with a reason about its laser."""
    with (
        Emulator(**FAST) as emulator,
        of(emulator) as sensor,
        pytest.raises(TypeError, match="interpreted as an integer"),
    ):
        sensor.scan(**wrong)


def test_a_room_is_seen_as_it_is():
    """Catches beams that turn the wrong way, or start at another step."""
    room = Room(rectangular_room(4, 3), [(1.0, 1.0, 0.0)], URG_04LX.ideal())
    with Emulator(room, **FAST) as emulator, of(emulator, sensor_pose=(0, 0, 0)) as sensor:
        points = sensor.scan().points() + (1.0, 1.0)
    off = np.min(
        [abs(points[:, 0]), abs(points[:, 0] - 4), abs(points[:, 1]), abs(points[:, 1] - 3)], 0
    )
    assert off.max() < 0.001
    assert points[0, 1] < 0.001 < points[-1, 1]


def test_replay_gives_the_capture_again():
    data = capture("urg04lx-from-sensor.scip.gz")
    replay = Replay(data)
    assert len(replay.turns) == 121
    with Emulator(replay, **FAST) as emulator, of(emulator) as sensor:
        scan = sensor.scan(first=46, last=722)
    met = np.where(scan.codes > 0, scan.codes, np.rint(1000 * np.nan_to_num(scan.ranges, posinf=0)))
    assert any((met == turn[46:723]).all() for turn in replay.turns)


def test_times_are_the_sensors_own():
    """Catches times of arrival: the reader sleeps, the sensor's turns stay even."""
    with Emulator(pattern) as emulator, of(emulator) as sensor:
        scans = []
        for scan in itertools.islice(sensor.scans(), 6):
            scans.append(scan)
            time.sleep(0.03 * (len(scans) % 2))
        gaps = np.diff([scan.time for scan in scans]) / np.diff([turn_of(scan) for scan in scans])
        assert gaps == pytest.approx([0.1] * 5, abs=0.03)
        assert abs(scans[-1].time - time.time()) < 2.0


def test_the_clock_of_the_sensor_wraps():
    with Emulator(pattern) as emulator, of(emulator) as sensor:
        stream = sensor.scans()
        times = [next(stream).time]
        emulator.inject("wrap")
        times += [scan.time for scan in itertools.islice(stream, 4)]
        stream.close()
        assert 0 < min(np.diff(times[1:])) <= max(np.diff(times[1:])) < 1.0


def test_slow_lines_are_explained():
    """At 19200 bit/s a scan takes 1.1 s: the text names the rate and the skip that fits."""
    with (
        Emulator(pattern, usb=False, **FAST) as emulator,
        of(emulator, rates=(19200,)) as sensor,
    ):
        stream = sensor.scans()
        assert sensor.slow == ""
        for _ in range(8):
            turn_of(next(stream))
        assert (
            "asked for every 0.10 s; at 19200 bit/s a scan of 682 beams takes 1.11" in sensor.slow
        )
        assert "250000 bit/s" in sensor.slow
        stream.close()
        first(sensor, 8, cluster=50)
        assert sensor.slow == ""


# --------------------------------------------------------------------------- leaving
def crash(sensor):
    with sensor:
        next(sensor.scans())
        raise ZeroDivisionError


def interrupt(sensor):
    with sensor:
        for _ in sensor.scans():
            raise KeyboardInterrupt


def forget(sensor):
    """Its laser is on after one scan, and there is no stream whose end would switch it off."""


def forget_the_stream(sensor):
    next(sensor.scans())


LEAVING = [crash, interrupt, forget, forget_the_stream, UrgSensor.close]


@pytest.mark.parametrize("leave", LEAVING)
def test_the_laser_is_off_and_the_port_free(leave):
    with Emulator(pattern, **FAST) as emulator:
        sensor = of(emulator)
        sensor.scan()
        assert emulator.unit.laser
        with contextlib.suppress(ZeroDivisionError, KeyboardInterrupt):
            leave(sensor)
        del sensor
        gc.collect()
        wait_for(lambda: not emulator.unit.laser)
        assert emulator.unit.stream is None
        with of(emulator) as again:
            turn_of(again.scan())


def wait_for(true, seconds=3.0):
    until = time.monotonic() + seconds
    while not true() and time.monotonic() < until:
        time.sleep(0.005)
    assert true()


def test_an_interrupt_from_the_terminal():
    """Catches a laser left on by Control-C, in a process of its own."""
    code = (
        "import signal, sys; from segmap.hokuyo import UrgSensor\n"
        # a runner in the background hands on that interrupts are ignored
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "for scan in UrgSensor(sys.argv[1]).scans(): print('scan', flush=True)"
    )
    with Emulator(pattern, **FAST) as emulator:
        with subprocess.Popen(
            [sys.executable, "-c", code, emulator.port],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        ) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == b"scan\n"
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=20)
        assert b"KeyboardInterrupt" in errors
        wait_for(lambda: not emulator.unit.laser)


def test_the_end_of_the_program():
    """Catches a script without `with` that leaves the laser on."""
    code = "import sys; from segmap.hokuyo import UrgSensor; s = UrgSensor(sys.argv[1]); s.scan()"
    with Emulator(pattern, **FAST) as emulator:
        subprocess.run([sys.executable, "-c", code, emulator.port], check=True, timeout=60)
        assert "BM" in emulator.unit.received
        wait_for(lambda: not emulator.unit.laser)


def test_a_closed_sensor_says_so():
    with Emulator(**FAST) as emulator:
        sensor = of(emulator)
        sensor.close()
        sensor.close()
        assert "closed" in repr(sensor)
        with pytest.raises(SensorError, match="closed: make a new"):
            sensor.scan()


def test_nothing_that_wedges_the_unit():
    """Catches ME, HD and their like, and commands that no manual of the URG-04LX names."""
    with Emulator(pattern, protocol="1.1", **FAST) as emulator, of(emulator) as sensor:
        sensor.scan()
        first(sensor, 2)
        first(sensor, 2, short=True)
        sensor.state()
        said = {text[:2] for text in emulator.unit.received}
        assert said <= {"QT", "SC", "VV", "PP", "II", "BM", "GD", "MD", "MS", "SS", "TM"}
        assert not emulator.unit.dead


def test_a_port_that_is_handed_in():
    """Catches a driver that needs the name of a device."""
    import serial

    with Emulator(pattern, **FAST) as emulator:
        port = serial.Serial(emulator.port, timeout=0.02)
        with UrgSensor(port, timeout=0.5) as sensor:
            turn_of(sensor.scan())
        assert not port.is_open
        with pytest.raises(ValueError, match="reconnect needs the name"):
            UrgSensor(port, reconnect=1.0)


def test_what_a_port_may_be():
    """A path as `pathlib` makes it is a device; what is no port is told so."""
    with Emulator(pattern, **FAST) as emulator:
        with UrgSensor(Path(emulator.port), timeout=0.5, reconnect=1.0) as sensor:
            turn_of(sensor.scan())
        with pytest.raises(ValueError, match="at least one bit rate"):
            of(emulator, rates=())
    with pytest.raises(TypeError, match="port must be a device, 'auto' or an open serial port"):
        UrgSensor(5)


# --------------------------------------------------------------------------- unplugged
def test_unplugged_is_an_error_unless_asked():
    with Emulator(pattern, **FAST) as emulator, of(emulator) as sensor:
        stream = sensor.scans()
        next(stream)
        emulator.unplug()
        with pytest.raises(SensorGone, match="plug it in"):
            for _ in stream:
                pass


def test_comes_back_when_asked(tmp_path):
    link = tmp_path / "laser"
    with (
        Emulator(pattern, link=link, **FAST) as emulator,
        of(emulator, reconnect=10.0) as sensor,
    ):
        stream = sensor.scans()
        turn_of(next(stream))
        emulator.replug()
        for _ in range(3):
            turn_of(next(stream))
        assert sensor.reconnects == 1
        emulator.replug()
        turn_of(sensor.scan())
        assert sensor.reconnects == 2
        stream.close()


def test_does_not_wait_for_ever(tmp_path):
    with (
        Emulator(pattern, link=tmp_path / "laser", **FAST) as emulator,
        of(emulator, reconnect=0.5) as sensor,
    ):
        emulator.unplug()
        begun = time.monotonic()
        with pytest.raises(SensorGone, match=r"not back within 0.5 s: cannot open"):
            sensor.scan()
        assert time.monotonic() - begun < 3.0


# ------------------------------------------------------------------------ from a shell
def test_the_bench(tmp_path, capsys):
    log = tmp_path / "bench.log"
    with Emulator(pattern, **FAST) as emulator:
        assert bench(["info", "--port", emulator.port]) == 0
        assert bench(["record", str(log), "--port", emulator.port, "--count", "3"]) == 0
    said = capsys.readouterr().out
    assert "SERI  H0000000" in said
    assert "3 scans, 0 dropped" in said
    assert len(log.read_text().splitlines()) == 3
    assert bench(["info", "--port", str(tmp_path / "none")]) == 1
    assert "is the sensor plugged in" in capsys.readouterr().err


#: The recorder, with SIGHUP as a terminal hands it on, whatever the runner of the tests ignores.
HANGUP = "import runpy, signal; signal.signal(signal.SIGHUP, signal.SIG_{}); "
RECORDER = HANGUP + "runpy.run_module('segmap.hokuyo', run_name='__main__', alter_sys=True)"


def recording(emulator, log, hangup="DFL"):
    """The recorder in a process of its own, once some scans are written."""
    command = [sys.executable, "-c", RECORDER.format(hangup), "record", str(log)]
    command += ["--port", emulator.port]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    wait_for(lambda: log.exists() and log.stat().st_size > 20_000, 20)
    return process


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_the_recorder_is_stopped(name, tmp_path):
    """Catches a laser left on by `kill`, or by a terminal that is closed: it says so twice."""
    log = tmp_path / "until.log"
    with Emulator(pattern, **FAST) as emulator, recording(emulator, log) as process:
        process.send_signal(getattr(signal, name))
        process.send_signal(getattr(signal, name))
        said, errors = process.communicate(timeout=20)
        assert process.returncode == 0
        assert b" scans, 0 dropped" in said
        assert errors == b""
        wait_for(lambda: not emulator.unit.laser)
    assert len(read(log)) >= 3


def test_nohup_outlives_the_terminal(tmp_path):
    """Catches a recorder that stops where somebody took care that it does not."""
    log = tmp_path / "on.log"
    with Emulator(pattern, **FAST) as emulator, recording(emulator, log, "IGN") as process:
        process.send_signal(signal.SIGHUP)
        size = log.stat().st_size
        wait_for(lambda: log.stat().st_size > size + 20_000, 20)
        process.terminate()
        assert process.wait(20) == 0


@pytest.mark.parametrize("command", ["", "list", "info", "record"])
def test_help(command, capsys):
    with pytest.raises(SystemExit) as end:
        bench([*command.split(), "--help"])
    assert end.value.code == 0
    assert "usage: python -m segmap.hokuyo" in capsys.readouterr().out


def test_the_emulator_from_a_terminal(tmp_path):
    """Prints its device, serves it, and ends when asked to, without a link left over."""
    link = tmp_path / "laser"
    command = [sys.executable, "-m", "segmap.emulator", "--speed", "10", "--link", str(link)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert Path(os.fsdecode(process.stdout.readline().strip())) == link
        with UrgSensor(str(link)) as sensor:
            assert len(sensor.scan()) == 682
        process.send_signal(signal.SIGTERM)
        assert process.wait(10) == 0
    assert not link.is_symlink()
