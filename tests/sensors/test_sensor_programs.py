"""Programs that end while they use a sensor."""

import signal
import subprocess
import sys

from emulated import NetworkEmulator, pattern, wait_for


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
    with NetworkEmulator(pattern, speed=10.0) as emulator:
        with started(code, emulator.port) as process:
            assert process.stdout.readline() == b"scan\n"
            assert emulator.unit.laser
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=20)
        assert b"KeyboardInterrupt" in errors
        wait_for(lambda: not emulator.unit.laser)
