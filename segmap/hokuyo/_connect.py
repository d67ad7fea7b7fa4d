"""Getting a sensor to listen in SCIP 2.0, whatever it was left doing (SCIP, section 7)."""

from collections.abc import Sequence

from ._coding import SensorError
from ._line import Lines, SensorGone
from ._replies import Reply, explain, parse_reply

#: Bit rates that a URG-04LX may have been left at; the first is the one to talk at.
RATES = (115200, 19200, 57600, 38400, 500000, 250000, 750000)
#: A scan in flight at 19 200 bit/s takes 1.1 s; then comes the answer, seconds.
IN_FLIGHT = 1.5
#: After a change of its rate the sensor is deaf for so long, seconds.
DEAF = 0.2
TRIES = 3


class Refused(SensorError):
    """A status that asking again does not mend."""


def connect(lines: Lines, rates: Sequence[int], quiet: float) -> int:
    """Find the sensor's bit rate and protocol; it ends idle, in SCIP 2.0, with its laser off.

    Parameters
    ----------
    lines : Lines
    rates : sequence of int, bits a second
        To try; the first is the one to talk at.
    quiet : float, seconds
        To wait for an answer.

    Returns
    -------
    int
        The rate at which both talk now.

    Raises
    ------
    SensorError
        Where nothing answers, or the firmware knows SCIP 1.1 only.
    """
    rate = _search(lines, rates, quiet)
    return rate if rate == rates[0] else _change(lines, rate, rates, quiet)


def _search(lines: Lines, rates: Sequence[int], quiet: float) -> int:
    for rate in rates:
        lines.set_rate(rate)
        if greet(lines, quiet):
            return rate
    raise SensorError(
        f"nothing answers as a URG does at {', '.join(map(str, rates))} bit/s: switch the sensor "
        "off and on, wait a few seconds and try again; is it the right port?"
    )


def greet(lines: Lines, quiet: float) -> bool:
    """Stop whatever the sensor does; whether it then listens in SCIP 2.0.

    Raises
    ------
    SensorError
        Where its firmware knows SCIP 1.1 only.
    """
    silent = refused = 0
    while silent < 2 and refused < TRIES:
        answer = quit(lines, quiet)
        if answer == b"00P":
            return lines.silence(quiet / 4)
        if answer == b"0Ee":
            lines.write(b"TM2\n")
            lines.silence(quiet / 2)
        elif answer in (b"E", b"0"):
            refused += not _switch(lines, quiet)
        else:
            silent += 1
            _switch(lines, quiet)
        refused += answer is not None
    if refused:
        raise SensorError(
            "the sensor speaks SCIP 1.1, without check sums, and does not switch to 2.0: "
            "it needs firmware 3 or later"
        )
    return False


def quit(lines: Lines, quiet: float) -> bytes | None:
    """Send QT, which ends streams and the laser; the line of status, None where none came."""
    lines.write(b"QT\n")
    for line in lines.until(lines.clock() + IN_FLIGHT, quiet):
        if line == b"QT":
            return lines.line(quiet)
    return None


def _switch(lines: Lines, quiet: float) -> bool:
    """From SCIP 1.1 to 2.0; one that has switched already does not know the command."""
    lines.write(b"SCIP2.0\n")
    for line in lines.until(lines.clock() + IN_FLIGHT, quiet):
        if line == b"SCIP2.0":
            status = lines.line(quiet)
            lines.silence(quiet / 4)
            return status == b"0"
    return False


def _change(lines: Lines, rate: int, rates: Sequence[int], quiet: float) -> int:
    """Ask for the first rate; where the sensor has not got it, both stay at what they have."""
    try:
        answer = ask(lines, f"SS{rates[0]:06}", 2 * quiet)
    except SensorGone:
        raise
    except SensorError:
        return _search(lines, rates, quiet)
    if answer.status not in ("00", "03"):
        return rate
    lines.set_rate(rates[0])
    lines.silence(DEAF)
    return rates[0] if greet(lines, quiet) else _search(lines, rates, quiet)


def ask(lines: Lines, command: str, seconds: float) -> Reply:
    """Send a command and wait for its reply.

    Raises
    ------
    SensorError
        Where none comes, or a damaged one.
    """
    lines.write(command.encode("ascii") + b"\n")
    found = lines.reply(command.encode("ascii"), seconds)
    if found is None:
        raise SensorError(f"no answer to {command} within {seconds:.2g} s: is the sensor busy?")
    return parse_reply(found)


def refused(command: str, status: str) -> SensorError:
    """The error for a status that is no success."""
    return SensorError(f"status {status} to {command}: {explain(status)}")
