"""The driver, the recorder and the emulator as programs meet them: a device, signals, processes."""

import contextlib
import gc
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from emulated import emulator_threads, needs_terminals, open_files, pattern, turn_of, wait_for

from segmap import read
from segmap.hokuyo import SensorError, SensorGone, UrgSensor
from segmap.hokuyo.__main__ import main as bench
from segmap.hokuyo.emulator import Emulator

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


@pytest.mark.parametrize("rate", [57600, 250000])
def test_connects_at_the_rate_that_the_terminal_tells(rate):
    state = {"rate": rate, "usb": False}
    rates = (115200, 57600, 250000)
    with Emulator(pattern, **FAST, **state) as emulator, of(emulator, rates=rates) as sensor:
        assert sensor.rate == emulator.unit.rate == 115200
        turn_of(sensor.scan())


def test_ports_that_cannot_be_opened(tmp_path):
    with pytest.raises(SensorError, match=r"cannot open .*it is not there: is the sensor plugged"):
        UrgSensor(str(tmp_path / "ttyACM7"))
    with Emulator(**FAST) as emulator:
        with of(emulator), pytest.raises(SensorError, match="another program uses it"):
            of(emulator)
        emulator.inject("silence", seconds=60)
        with pytest.raises(SensorError, match="nothing answers as a URG does at 115200 bit/s"):
            of(emulator, rates=(115200,), timeout=0.2)


def test_a_port_that_is_handed_in():
    """Catches a driver that needs the name of a device, and one that leaves the port open."""
    import serial

    with Emulator(pattern, **FAST) as emulator:
        port = serial.Serial(emulator.port, timeout=0.02)
        with UrgSensor(port, timeout=0.5) as sensor:
            turn_of(sensor.scan())
        assert not port.is_open
        with UrgSensor(Path(emulator.port), timeout=0.5, reconnect=1.0) as sensor:
            turn_of(sensor.scan())


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


@pytest.mark.parametrize("leave", [crash, interrupt, forget, forget_the_stream, UrgSensor.close])
def test_the_laser_is_off_and_the_port_free(leave):
    with Emulator(pattern, **FAST) as emulator:
        sensor = of(emulator)
        sensor.scan()
        assert emulator.unit.laser
        with contextlib.suppress(ZeroDivisionError, KeyboardInterrupt):
            leave(sensor)
        del sensor
        wait_for(lambda: not emulator.unit.laser)
        assert emulator.unit.stream is None
        with of(emulator) as again:
            turn_of(again.scan())


def test_an_interrupt_from_the_terminal():
    """Catches a laser left on by Control-C, in a process of its own."""
    code = (
        "import signal, sys; from segmap.hokuyo import UrgSensor\n"
        # a runner in the background hands on that interrupts are ignored
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "for scan in UrgSensor(sys.argv[1]).scans(): print('scan', flush=True)"
    )
    command = [sys.executable, "-c", code]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with Emulator(pattern, **FAST) as emulator:
        with subprocess.Popen([*command, emulator.port], **pipes) as process:
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
    link = {"link": tmp_path / "laser"}
    with Emulator(pattern, **link, **FAST) as emulator, of(emulator, reconnect=20.0) as sensor:
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
    link = {"link": tmp_path / "laser"}
    with Emulator(pattern, **link, **FAST) as emulator, of(emulator, reconnect=0.5) as sensor:
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
    wait_for(lambda: log.exists() and log.stat().st_size > 20_000)
    return process


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_the_recorder_is_stopped(name, tmp_path):
    """Catches a laser left on by `kill`, or by a terminal that is closed and says so twice.

    The sensor is silent, so that more signals come while the laser is switched off.
    """
    log = tmp_path / "until.log"
    with Emulator(pattern, **FAST) as emulator, recording(emulator, log) as process:
        emulator.inject("silence", seconds=0.5)
        while process.poll() is None:
            process.send_signal(getattr(signal, name))
            time.sleep(0.05)
        said, errors = process.communicate(timeout=20)
        assert process.returncode == 0
        assert b" scans, 0 dropped" in said
        assert errors == b""
        wait_for(lambda: not emulator.unit.laser)
    assert len(read(log)) >= 3


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_folder_recording_that_is_stopped_leaves_whole_scans_only(name, tmp_path):
    """Catches a file that is half written, or left under another name."""
    folder = tmp_path / "folder"
    command = [sys.executable, "-c", RECORDER.format("DFL"), "record", str(folder), "--port"]
    with Emulator(pattern, **FAST) as emulator:
        with subprocess.Popen([*command, emulator.port], stdout=subprocess.PIPE) as process:
            wait_for(lambda: (folder / "scan000005.txt").exists())
            process.send_signal(getattr(signal, name))
            assert process.wait(20) == 0
        wait_for(lambda: not emulator.unit.laser)
    names = sorted(path.name for path in folder.iterdir())
    assert names == [f"scan{k + 1:06}.txt" for k in range(len(names))]
    assert len(read(folder)) == len(names)


def test_nohup_outlives_the_terminal(tmp_path):
    """Catches a recorder that stops where somebody took care that it does not."""
    log = tmp_path / "on.log"
    with Emulator(pattern, **FAST) as emulator, recording(emulator, log, "IGN") as process:
        process.send_signal(signal.SIGHUP)
        size = log.stat().st_size
        wait_for(lambda: log.stat().st_size > size + 20_000)
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
    command = [sys.executable, "-m", "segmap.hokuyo.emulator", "--speed", "10", "--link", str(link)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert Path(os.fsdecode(process.stdout.readline().strip())) == link
        with UrgSensor(str(link)) as sensor:
            assert len(sensor.scan()) == 682
        process.send_signal(signal.SIGTERM)
        assert process.wait(10) == 0
    assert not link.is_symlink()
