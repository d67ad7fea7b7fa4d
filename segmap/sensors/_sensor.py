"""The driver: a sensor that connects, delivers scans, and is always left with its laser off."""

from __future__ import annotations

import contextlib
import weakref
from collections.abc import Callable, Generator
from os import PathLike
from typing import Self

from .. import arrays
from ..arrays import Seconds, checked
from ..scans import LaserScan
from ._connect import SCAN_STATUS, ask, connect, laser_off, switch_off
from ._geometry import check_limits, laser_scan, parse_geometry
from ._host import HostClock, host_time
from ._lines import Lines, Port
from ._port import checked_port, find_port, open_port
from ._protocol import (
    CHARACTERS,
    Refused,
    Reply,
    ScanRequest,
    SensorError,
    SensorGone,
    Silent,
    parse_info,
    parse_reply,
    parse_scan,
    refusal,
)

#: Bits a second at which a device is opened; USB takes any.
RATE = 115_200
#: Damaged or missing scans in a row that are an error, not bad luck.
MOST_FAILURES = 5


class UrgSensor:
    """A Hokuyo of SCIP 2 that is connected: use it as a context manager, in one thread at a time.

    However it ends - `close`, the end of `with`, an exception, an interrupt, or being forgotten -
    the laser is switched off and the port freed.

    Parameters
    ----------
    port : str or Path or Port
        A device; "auto" for the one Hokuyo on USB; `tcp://host` or `tcp://host:port` of one on
        Ethernet, port 10940 where none is named; or an open port that does not wait for ever.
    timeout : float
        To wait for an answer beyond the time that measuring and sending it take.
    clock : callable
        Seconds of the host, which only go on; the scans' times are on it.

    Attributes
    ----------
    info : dict
        What the sensor says of itself: VEND, PROD, FIRM, PROT, SERI, MODL, ...
    geometry : Geometry
        Its steps and limits, by its own word.
    rate : int, bits a second
        At which both talk.
    delivered, dropped : int
        Scans handed over; replies that were damaged or missing.
    why : str
        Why the last one was dropped.

    Raises
    ------
    SensorError
        Where it cannot be reached, with what to do.

    Examples
    --------
    >>> with UrgSensor("auto") as sensor:  # doctest: +SKIP
    ...     for scan in sensor.scans():
    ...         print(scan)
    """

    @checked
    def __init__(
        self,
        port: str | PathLike[str] | Port = "auto",
        *,
        timeout: Seconds = 1.0,
        clock: Callable[[], float] = host_time,
    ) -> None:
        port, self._timeout = checked_port(port), timeout
        self._clock = arrays.function(clock, "clock", "without arguments, of seconds")
        arrays.number(arrays.call_given(clock, "clock"), "clock()", unit="seconds")
        self.delivered = self.dropped = 0
        self.why = ""
        self._running: ScanRequest | None = None  # the stream that may come
        self._open(port)

    def scan(self) -> LaserScan:
        """One turn; the laser is on for it alone."""
        with contextlib.closing(self._turns(1)) as turns:
            return next(turns)

    def scans(self) -> Generator[LaserScan, None, None]:
        """Turn after turn, until the loop is left.

        Damaged scans are left out and counted in `dropped`. Scans that are not fetched wait in
        the port's small buffer; where that is full, the sensor waits, and leaves turns out.

        Raises
        ------
        SensorError
            Where the sensor is gone or faulty, or nothing whole has come for some time.
        """
        return self._turns(0)

    def stop(self) -> None:
        """End a stream and switch the laser off."""
        was_running, self._running = self._running, None
        if was_running and self._leave.alive:
            switch_off(self._lines)
            self._lines.silence(0.02)

    def close(self) -> None:
        """Switch the laser off and free the port; nothing happens the second time."""
        self._leave()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        model = self.info.get("MODL", "unknown").partition("(")[0]
        open_ = f"{self.rate} bit/s" if self._leave.alive else "closed"
        return f"UrgSensor({model}, {open_}, {self.delivered} scans, {self.dropped} dropped)"

    # ------------------------------------------------------------------------ scans
    def _turns(self, count: int) -> Generator[LaserScan, None, None]:
        """So many turns, 0 without end; then the laser is switched off."""
        request = ScanRequest(self.geometry.first, self.geometry.last, count)
        try:
            while True:
                yield self._next_scan(request)
        finally:
            with contextlib.suppress(SensorError):
                self.stop()

    def _next_scan(self, request: ScanRequest) -> LaserScan:
        """The next whole scan; damaged ones are counted, and asked for anew."""
        for _ in range(MOST_FAILURES):
            if not self._leave.alive:
                raise SensorError("the sensor is closed: make a new UrgSensor")
            if request.scans or self._running is not request:  # another was asked meanwhile
                self.stop()
                self._running = request
                ask(self._lines, request.text)
            scan = self._answer(request._replace(scans=0))  # it answers with how many are left
            if scan is not None:
                self.delivered += 1
                return scan
        raise SensorError(f"no whole scan in {MOST_FAILURES} attempts: {self.why}")

    def _answer(self, request: ScanRequest) -> LaserScan | None:
        """A scan, or None for what is dropped, which is counted with its reason.

        It must come within its turn, one more, its transfer of ten bits a byte, and the timeout.
        """
        lines = self._lines
        seconds = 2 * self.geometry.turn + 10 * request.size / self.rate + self._timeout
        try:
            answer, strange = lines.reply(request.text.encode("ascii"), seconds)
            arrived = lines.clock()
            if strange:
                self._drop(f"{strange} lines that belong to no scan")
            if answer is None:
                raise Silent(f"nothing came for {seconds:.2g} s")
            reply = parse_reply(answer)
            if reply.status == "00":  # the stream was acknowledged again, and late
                return None
            return self._scan(reply, request, arrived)
        except (SensorGone, Refused):
            raise
        except SensorError as error:
            self._drop(str(error))
            if isinstance(error, Silent):  # the next attempt starts again
                self.stop()
            return None

    def _scan(self, reply: Reply, request: ScanRequest, arrived: float) -> LaserScan:
        """The scan that a reply holds; Refused for a status that will stay so."""
        status = reply.status
        if status != SCAN_STATUS:
            lasting = status.isdigit() and (int(status) < 20 or 50 <= int(status) < 98)
            raise (Refused if lasting else SensorError)(refusal(request.text, status))
        met = parse_scan(reply.body, CHARACTERS)
        count = len(met.millimetres)
        if count != request.steps:
            raise SensorError(f"{count} beams, asked for {request.steps}: bytes were lost")
        return laser_scan(met, self.geometry, time=self._sensor_clock.seconds(met.clock, arrived))

    def _drop(self, why: str) -> None:
        self.dropped, self.why = self.dropped + 1, why

    # ------------------------------------------------------------------------------ open
    def _open(self, port: str | Port) -> None:
        """Open the port and ask the sensor who it is; a failure leaves the port free."""
        if isinstance(port, str):
            port = open_port(find_port() if port == "auto" else port, RATE)
        lines, self.rate = Lines(port, self._clock, self._timeout), port.baudrate
        self._leave = weakref.finalize(self, laser_off, lines)
        try:
            connect(lines)
            limits = parse_info(ask(lines, "PP", check=check_limits).body)
            self.info = parse_info(ask(lines, "VV").body) | limits
            self.geometry = parse_geometry(limits)
        except BaseException:
            self._leave()
            raise
        self._lines = lines
        # No scan arrives sooner after its stamp than the mirror gets to the last step.
        mirror = (self.geometry.last + 1) / self.geometry.steps * self.geometry.turn
        self._sensor_clock = HostClock(mirror)
