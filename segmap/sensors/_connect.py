"""From a port to a sensor that is idle, in SCIP 2.0; and back."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from ._lines import PULLED_OUT_ERRORS, Lines
from ._protocol import Refused, Reply, SensorError, SensorGone, Silent, parse_reply, refusal

#: A scan in flight at 19 200 bit/s takes 1.1 s before the answer comes, seconds.
IN_FLIGHT_S = 1.5
#: So often a command is sent before its answer is given up.
TRIES = 3
#: The status of a scan, which comes for MD where the stream runs already.
SCAN_STATUS = "99"


def connect(lines: Lines) -> None:
    """Find the sensor; it ends idle, in SCIP 2.0, with its laser off."""
    for _ in range(1 + TRIES):
        answer = status(lines, b"QT")
        if answer == b"00P":
            if lines.silence(lines.quiet / 4):
                return
        elif answer == b"0Ee":  # it is in time mode
            lines.write(b"TM2\n")
            lines.silence(lines.quiet / 2)
        elif status(lines, b"SCIP2.0") is not None:  # SCIP 1.1 answers QT by E, or with silence
            lines.silence(lines.quiet / 4)
    raise SensorError(
        f"nothing answers as a URG does at {lines.port.baudrate} bit/s: switch the sensor off "
        "and on, wait a few seconds and try again; is it the right port or address? On RS-232 "
        "hand in the port at the sensor's rate: serial.Serial(device, 19200, timeout=0.02); "
        "one that speaks SCIP 1.1 alone needs firmware 3 or later"
    )


def status(lines: Lines, command: bytes) -> bytes | None:
    """The line after a command's echo, whatever else the sensor says before; None without one."""
    lines.write(command + b"\n")
    for line in lines.until(lines.clock() + IN_FLIGHT_S, lines.quiet):
        if line == command:
            return lines.line(lines.quiet)
    return None


def ask(lines: Lines, command: str, check: Callable[[Reply], object] = lambda reply: None) -> Reply:
    """The reply to a command, which is sent again where its reply is damaged or fails a check.

    Refused for a status that is no success; another SensorError where no whole reply comes.
    """
    fault = SensorError("")
    for _ in range(TRIES):
        try:
            lines.write(command.encode("ascii") + b"\n")
            answer, _ = lines.reply(command.encode("ascii"), lines.timeout)
            if answer is None:
                words = f"no answer to {command} within {lines.timeout:.2g} s"
                raise Silent(f"{words}: is the sensor busy?")
            reply = parse_reply(answer)
            if reply.status not in ("00", SCAN_STATUS):
                raise Refused(refusal(command, reply.status))
            check(reply)
            return reply
        except (SensorGone, Refused):
            raise
        except SensorError as error:
            fault = error
            lines.silence(lines.quiet / 4)
    raise fault


def switch_off(lines: Lines) -> None:
    """End a stream and switch the laser off."""
    any(status(lines, b"QT") == b"00P" for _ in range(TRIES))


def laser_off(lines: Lines) -> None:
    """Switch the laser off and free the port; whatever happens, the port is closed."""
    try:
        with contextlib.suppress(SensorError):
            switch_off(lines)
    finally:
        with contextlib.suppress(*PULLED_OUT_ERRORS):
            lines.port.close()
