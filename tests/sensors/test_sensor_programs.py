"""The emulator as a program, and programs that end while they use a sensor."""

import signal
import subprocess
import sys

import pytest
from emulated import needs_terminals, pattern, wait_for
from programs import program

from segmap.sensors import SensorError, UrgSensor
from segmap.sensors.emulator import Emulator

emulate = program("segmap.sensors.emulator")


def started(code, *arguments):
    """A process that runs some code of Python."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen([sys.executable, "-c", code, *map(str, arguments)], **pipes)


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


@pytest.mark.parametrize("line", [pytest.param("terminal", marks=needs_terminals), "tcp"])
def test_from_a_shell(line, monkeypatch):
    """An emulator in a process of its own, over TCP without pyserial.

    Catches Ethernet that needs a serial library, and a name that is not told at once.
    """
    options = ["--model", "UST-10LX", "--tcp", "0"]
    if line == "tcp":
        monkeypatch.setitem(sys.modules, "serial", None)
    else:
        pytest.importorskip("serial", reason="the driver opens ports with pyserial")
        options = ["--speed", "10"]
    code = "import sys; from segmap.sensors.emulator.__main__ import main; sys.exit(main())"
    with started(code, *options) as process:
        port = process.stdout.readline().decode().strip()
        assert port.startswith("tcp://127.0.0.1:") or line != "tcp"
        with UrgSensor(port) as sensor:
            model, beams = ("UST-10LX", 1081) if line == "tcp" else ("URG-04LX", 682)
            assert sensor.info["MODL"].startswith(model) and sensor.info["SERI"] == "H0000000"
            assert len(sensor.scan()) == beams
        process.terminate()
        assert process.wait(10) == 0
    # Another test may have been given the terminal meanwhile
    advice = "nothing listens there" if line == "tcp" else f"cannot open {port}"
    with pytest.raises(SensorError, match=advice):
        UrgSensor(port)


def test_a_wrong_option_is_told_in_a_line(capsys):
    """Catches a traceback in a terminal."""
    assert emulate(["--tcp=x"]) == 1
    said = capsys.readouterr().err
    assert "tcp must be [host:]port" in said and said.count("\n") == 1
