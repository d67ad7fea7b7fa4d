"""The recorder and the emulator as programs: options, processes, signals, what they leave."""

import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest
from emulated import far_pattern, far_turn, needs_terminals, pattern, turn_of, wait_for
from programs import program

from segmap import read
from segmap.sensors.emulator import Emulator

bench = program("segmap.sensors")

FAR = {"tcp": "0", "model": "UST-10LX"}
WORLDS = {"terminal": (pattern, turn_of, {}), "tcp": (far_pattern, far_turn, FAR)}
on_terminal = pytest.param("terminal", marks=needs_terminals)
#: The recorder, with SIGHUP as a terminal hands it on, whatever the runner of the tests ignores.
RECORDER = """
import runpy, signal
signal.signal(signal.SIGHUP, signal.SIG_{})
signal.signal(signal.SIGINT, signal.default_int_handler)
runpy.run_module('segmap.sensors', run_name='__main__', alter_sys=True)
"""


def started(code, *arguments):
    """A process that runs some code of Python."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen([sys.executable, "-c", code, *map(str, arguments)], **pipes)


def recording(emulator, log, hangup="DFL"):
    """The recorder in a process of its own, once some scans are written."""
    if "/" in emulator.port and not emulator.port.startswith("tcp:"):
        pytest.importorskip("serial", reason="the driver opens ports with pyserial")
    code = RECORDER.format(hangup)
    process = started(code, "record", log, "--port", emulator.port)
    wait_for(lambda: written(log) > 30_000)
    return process


def written(log):
    with suppress(FileNotFoundError):  # a part that gets its name just then
        return sum(path.stat().st_size for path in (log, *log.glob("*")) if path.is_file())
    return 0


@pytest.mark.parametrize(
    ("line", "name", "sent"),
    [
        ("tcp", "until.log", "SIGTERM"),
        pytest.param("terminal", "until.log", "SIGINT", marks=needs_terminals),
        pytest.param("terminal", "hung_up.log", "SIGHUP", marks=needs_terminals),
    ],
)
def test_the_recorder_is_stopped(line, name, sent, tmp_path):
    """Catches a laser left on by `kill`, or by a terminal that is closed and says so twice.

    The sensor is silent, so that more signals come while the laser is switched off. Catches a scan
    that is half written or cut at 5.6 m.
    """
    log, (world, turn, settings) = tmp_path / name, WORLDS[line]
    with Emulator(world, speed=10.0, **settings) as emulator, recording(emulator, log) as process:
        emulator.inject("silence", seconds=0.4)
        while process.poll() is None:
            process.send_signal(getattr(signal, sent))
            time.sleep(0.05)
        said, errors = process.communicate(timeout=20)
        assert (process.returncode, errors) == (0, b"")
        assert b" scans, 0 dropped" in said
        wait_for(lambda: not emulator.unit.laser)
    turns = [turn(scan) for scan in read(log)]
    assert len(set(turns)) == len(turns) >= 3


def test_the_command_of_all_records_too(tmp_path):
    """Catches options that are not handed on, and a laser left on by `kill`."""
    log, code = (
        tmp_path / "one.log",
        "import sys; from segmap.__main__ import main; sys.exit(main())",
    )
    with Emulator(far_pattern, speed=10.0, **FAR) as emulator:
        given = ("sensor", "record", log, "--port", emulator.port)
        with started(code, *given, "--count", 3) as process:
            assert process.wait(60) == 0
        assert len(read(log)) == 3
        log.unlink()
        with started(code, *given) as process:
            wait_for(lambda: written(log) > 30_000)
            process.terminate()
            assert process.wait(20) == 0
        wait_for(lambda: not emulator.unit.laser)


@needs_terminals
def test_nohup_outlives_the_terminal(tmp_path):
    """Catches a recorder that stops where somebody took care that it does not."""
    log = tmp_path / "on.log"
    with Emulator(pattern, speed=10.0) as emulator, recording(emulator, log, "IGN") as process:
        process.send_signal(signal.SIGHUP)
        size = written(log)
        wait_for(lambda: written(log) > size + 20_000)
        process.terminate()
        assert process.wait(20) == 0


def test_the_end_of_a_program_without_with():
    """Catches a laser left on by Control-C, or by the end of a script that has no `with`."""
    code = (
        "import signal, sys; from segmap.sensors import UrgSensor\n"
        # a runner in the background hands on that interrupts are ignored
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "sensor = UrgSensor(sys.argv[1]); stream = sensor.scans()\n"
        "while True: next(stream); print('scan', flush=True)"
    )
    with Emulator(pattern, speed=10.0, tcp="0") as emulator:
        with started(code, emulator.port) as process:
            assert process.stdout.readline() == b"scan\n"
            assert emulator.unit.laser
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=20)
        assert b"KeyboardInterrupt" in errors
        wait_for(lambda: not emulator.unit.laser)


@pytest.mark.parametrize("line", [on_terminal, "tcp"])
def test_from_a_shell(line, tmp_path, capsys, monkeypatch):
    """An emulator in a process of its own; `info` and `record`, over TCP without pyserial.

    Catches Ethernet that needs a serial library, and a name that is not told at once.
    """
    log, options = tmp_path / "some.log", ["--model", "UST-10LX", "--tcp", "0"]
    if line == "tcp":
        monkeypatch.setitem(sys.modules, "serial", None)
    else:
        pytest.importorskip("serial", reason="the driver opens ports with pyserial")
        options = ["--speed", "10"]
    code = "import sys; from segmap.sensors.emulator.__main__ import main; sys.exit(main())"
    with started(code, *options) as process:
        port = process.stdout.readline().decode().strip()
        assert port.startswith("tcp://127.0.0.1:") or line != "tcp"
        assert bench(["info", "--port", port]) == 0
        assert bench(["record", str(log), "--count", "2", "--port", port]) == 0
        process.terminate()
        assert process.wait(10) == 0
    said = capsys.readouterr().out
    model, beams = ("UST-10LX", 1081) if line == "tcp" else ("URG-04LX", 682)
    for wanted in (f"MODL  {model}", "SERI  H0000000", f"{beams} beams", "2 scans, 0 dropped"):
        assert wanted in said
    assert len(log.read_text().splitlines()) == 2
    assert bench(["info", "--port", port]) == 1
    # Another test may have been given the terminal meanwhile
    advice = "nothing listens there" if line == "tcp" else f"cannot open {port}"
    assert advice in capsys.readouterr().err
