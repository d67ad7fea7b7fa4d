"""Commands to a sensor, from finding its bit rate to asking for scans."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from typing import NamedTuple

from numpy.typing import ArrayLike

from ..scans import LaserScan
from ._host import HostClock
from ._port import LOST, Lines, Refused, SensorGone, Silent
from ._protocol import CHARACTERS, ScanRequest, SensorError
from ._replies import Geometry, Reply, explain, laser_scan, parse_reply, parse_scan

#: Bit rates that a URG-04LX may have been left at; the first is the one to talk at.
RATES = (115200, 19200, 57600, 38400, 500000, 250000, 750000)
#: A scan in flight at 19 200 bit/s takes 1.1 s before the answer comes, seconds.
IN_FLIGHT = 1.5
#: After a change of its rate the sensor does not listen for so long, seconds.
DEAF = 0.2
#: So often a command is sent before its answer is given up.
TRIES = 3
#: Statuses that say that it is so already: the laser is on, the stream runs.
ALREADY = {"BM": "02", "MD": "99", "MS": "99"}


def send(lines: Lines, command: str, seconds: float) -> Reply:
    """The reply to a command; a SensorError where none comes in this time, or a damaged one."""
    lines.write(command.encode("ascii") + b"\n")
    found = lines.reply(command.encode("ascii"), seconds).lines
    if found is None:
        raise Silent(f"no answer to {command} within {seconds:.2g} s: is the sensor busy?")
    return parse_reply(found)


def ask(lines: Lines, command: str, check: Callable[[Reply], object] = lambda reply: None) -> Reply:
    """The reply to a command, which is sent again where its reply is damaged or fails a check.

    Raises
    ------
    Refused
        For a status that is no success.
    SensorError
        Where no whole reply comes.
    """
    fault = SensorError("")
    for _ in range(TRIES):
        try:
            reply = send(lines, command, lines.timeout)
            if reply.status not in ("00", ALREADY.get(command[:2], "00")):
                raise Refused(refusal(command, reply.status))
            check(reply)
            return reply
        except (SensorGone, Refused):
            raise
        except SensorError as error:
            fault = error
            lines.silence(lines.quiet / 4)
    raise fault


def refusal(command: str, status: str) -> str:
    """What an error says of a status that is no success."""
    return f"status {status} to {command}: {explain(status)}"


def quit(lines: Lines) -> bytes | None:
    """Send QT, which ends streams and the laser; the line of status, None where none came."""
    return _status(lines, b"QT")


def switch_off(lines: Lines) -> None:
    """End a stream and switch the laser off."""
    any(quit(lines) == b"00P" for _ in range(TRIES))


def leave(lines: Lines) -> None:
    """Switch the laser off and free the port; whatever happens, the port is closed."""
    try:
        with contextlib.suppress(SensorError):
            switch_off(lines)
    finally:
        with contextlib.suppress(*LOST):
            lines.port.close()


def connect(lines: Lines, rates: Sequence[int]) -> int:
    """Find the sensor's bit rate and protocol; it ends idle, in SCIP 2.0, with its laser off.

    Both then talk at the rate that is returned, bits a second: the first one, where the sensor
    has it.

    Raises
    ------
    SensorError
        Where nothing answers, or the firmware knows SCIP 1.1 only.
    """
    rate = _search(lines, rates)
    return rate if rate == rates[0] else _change(lines, rate, rates)


def _search(lines: Lines, rates: Sequence[int]) -> int:
    for rate in rates:
        lines.set_rate(rate)
        if _greet(lines):
            return rate
    raise SensorError(
        f"nothing answers as a URG does at {', '.join(map(str, rates))} bit/s: switch the sensor "
        "off and on, wait a few seconds and try again; is it the right port or address?"
    )


def _greet(lines: Lines) -> bool:
    """Stop whatever the sensor does, and tell whether it then listens in SCIP 2.0."""
    silent = refused = 0
    while silent < 2 and refused < TRIES:
        answer = quit(lines)
        if answer == b"00P":
            return lines.silence(lines.quiet / 4)
        if answer == b"0Ee":
            lines.write(b"TM2\n")
            lines.silence(lines.quiet / 2)
        elif answer in (b"E", b"0"):
            refused += not _switch(lines)
        else:
            silent += 1
            _switch(lines)
        refused += answer is not None
    if refused:
        raise SensorError(
            "the sensor speaks SCIP 1.1, without check sums, and does not switch to 2.0: "
            "it needs firmware 3 or later"
        )
    return False


def _switch(lines: Lines) -> bool:
    """Switch from SCIP 1.1 to 2.0; a sensor that has switched does not know the command."""
    status = _status(lines, b"SCIP2.0")
    if status is not None:
        lines.silence(lines.quiet / 4)
    return status == b"0"


def _status(lines: Lines, command: bytes) -> bytes | None:
    """The line after a command's echo, whatever else the sensor says before."""
    lines.write(command + b"\n")
    for line in lines.until(lines.clock() + IN_FLIGHT, lines.quiet):
        if line == command:
            return lines.line(lines.quiet)
    return None


def _change(lines: Lines, rate: int, rates: Sequence[int]) -> int:
    """Ask for the first rate; where the sensor has not got it, both stay at what they have."""
    try:
        answer = send(lines, f"SS{rates[0]:06}", 2 * lines.quiet)
    except SensorGone:
        raise
    except SensorError:
        return _search(lines, rates)
    if answer.status not in ("00", "03"):
        return rate
    lines.set_rate(rates[0])
    lines.silence(DEAF)
    return rates[0] if _greet(lines) else _search(lines, rates)


# ------------------------------------------------------------------------------ scans
class Taken(NamedTuple):
    """A scan and its stamp, ms, or None where no whole one came; and why answers were dropped."""

    scan: LaserScan | None
    stamp: int = 0
    dropped: tuple[str, ...] = ()


class ScanStream:
    """Asks one connected sensor for scans, and reads its answers.

    Parameters
    ----------
    lines : Lines
        Of the sensor, see `connect`.
    geometry : Geometry
    rate : int, bits a second
    sensor_pose : (3,) array, metres and radians
        Pose of the sensor in the frame of the robot.
    """

    def __init__(self, lines: Lines, geometry: Geometry, rate: int, sensor_pose: ArrayLike) -> None:
        self._lines, self._geometry, self._rate = lines, geometry, rate
        self._sensor_pose = sensor_pose
        self._clock = HostClock((geometry.last + 1) / geometry.steps * geometry.turn)
        self._laser_on = False
        self.running: ScanRequest | None = None

    def take(self, request: ScanRequest) -> Taken:
        """The latest scan, or the next one of a stream, which is started where it does not run.

        Raises
        ------
        SensorError
            Where the sensor is gone, refuses, or cannot be started.
        """
        return self._next(request) if request.streams else self._single(request)

    def light(self) -> None:
        """Switch the laser on; a SensorError where the sensor is not ready."""
        if not self._laser_on:
            ask(self._lines, "BM")
            self._laser_on = True

    def stop(self) -> None:
        """End a stream and switch the laser off, where either is on."""
        self.running = None
        if self._laser_on:
            self._laser_on = False
            switch_off(self._lines)
            self._lines.silence(0.02)

    def _single(self, request: ScanRequest) -> Taken:
        if self.running is not None:
            self.stop()
        self.light()
        try:
            reply = send(self._lines, request.text, self._wait(request))
            self._laser_on = reply.status != "10"  # it went off by itself, or BM was lost
            return self._taken(reply, request)
        except (SensorGone, Refused):
            raise
        except SensorError as error:
            self._laser_on &= not isinstance(error, Silent)  # the next attempt asks whether it is
            self._lines.silence(self._lines.quiet / 4)
            return Taken(None, dropped=(str(error),))

    def _next(self, request: ScanRequest) -> Taken:
        if self.running is not request:  # something else was asked meanwhile
            self._start(request)
        dropped: tuple[str, ...] = ()
        try:
            found, strange = self._lines.reply(request.text.encode("ascii"), self._wait(request))
            dropped = (f"{strange} lines that belong to no scan",) if strange else ()
            if found is not None:
                return self._taken(parse_reply(found), request, dropped)
        except (SensorGone, Refused):
            raise
        except SensorError as error:
            return Taken(None, dropped=(*dropped, str(error)))
        self.running = None  # is started again
        silence = f"nothing came for {self._wait(request):.2g} s"
        return Taken(None, dropped=(*dropped, silence))

    def _start(self, request: ScanRequest) -> None:
        """Start a stream; what the sensor was doing before is ended first."""
        self.stop()
        self._laser_on = True
        ask(self._lines, request.text)
        self.running = request

    def _wait(self, request: ScanRequest) -> float:
        """Seconds in which an answer must come: its turn, one more, its transfer, the timeout."""
        turns = period(request, self._geometry) + self._geometry.turn
        return turns + transfer(request, self._rate) + self._lines.timeout

    def _taken(self, reply: Reply, request: ScanRequest, dropped: tuple[str, ...] = ()) -> Taken:
        """The scan that a reply holds; none in an acknowledgement of the stream that comes late."""
        arrived = self._lines.clock()
        if request.streams and reply.status == "00":
            return Taken(None, dropped=dropped)
        _check_status(reply.status, request)
        met = parse_scan(reply.body, CHARACTERS[request.kind])
        count = len(met.millimetres)
        if count not in (request.beams, request.steps // request.cluster):
            raise SensorError(f"{count} beams, asked for {request.beams}: bytes were lost")
        when = self._clock.seconds(met.clock, arrived)
        scan = laser_scan(met, request, self._geometry, time=when, sensor_pose=self._sensor_pose)
        return Taken(scan, met.clock, dropped)


def period(request: ScanRequest, geometry: Geometry) -> float:
    """Seconds from scan to scan, as asked for."""
    return (request.skip + 1) * geometry.turn


def transfer(request: ScanRequest, rate: int) -> float:
    """Seconds that an answer takes on the line: ten bits a byte."""
    return 10 * request.size / rate


def _check_status(status: str, request: ScanRequest) -> None:
    """Raise for the status of a reply that holds no scan: Refused where it will stay so."""
    if status == ("99" if request.streams else "00"):
        return
    lasting = status != "10"
    if request.streams:
        lasting = status.isdigit() and (int(status) < 20 or 50 <= int(status) < 98)
    raise (Refused if lasting else SensorError)(refusal(request.text, status))
