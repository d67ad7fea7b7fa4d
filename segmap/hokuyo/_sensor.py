"""The driver: a sensor that connects, delivers scans, and is always left with its laser off."""

from __future__ import annotations

import contextlib
import time
import weakref
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from math import ceil
from os import PathLike
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..scans import LaserScan
from ._host import host_time
from ._port import Lines, Port, SensorGone, Silent, checked_port, find_port, open_port
from ._protocol import CLOCK, ScanRequest, SensorError
from ._replies import parse_geometry, parse_info, parse_limits
from ._stream import RATES, ScanStream, ask, connect, leave, period, transfer
from ._tcp import TcpPort

#: So many damaged or missing scans in a row are an error, not bad luck.
MOST_FAILURES = 5
#: Waits between attempts to find an unplugged sensor again double from the first to the last, s.
BACK_OFF = (0.1, 2.0)
#: Scans from which the pace of a stream is judged, and how much slower than asked is slow.
PACE, SLOW = 11, 1.5


class UrgSensor:
    """A Hokuyo of SCIP 2 that is connected: use it as a context manager, in one thread at a time.

    However it ends - `close`, the end of `with`, an exception, an interrupt, or being forgotten -
    the laser is switched off and the port freed.

    Parameters
    ----------
    port : str or Path or Port
        A device; "auto" for the one Hokuyo on USB; `tcp://host` or `tcp://host:port` of one on
        Ethernet, port 10940 where none is named; or an open port.
    rates : sequence of int, bits a second
        To look for the sensor at; it is then switched to the first. USB takes any, Ethernet none.
    reconnect : float, seconds
        How long to look for a sensor that was unplugged while it was in use, or fell silent; 0
        raises at once.
    timeout : float, seconds
        To wait for an answer beyond the time that measuring and sending it take.
    sensor_pose : (3,) array, metres and radians
        Pose of the sensor in the frame of the robot, passed on to the scans.
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
    delivered, dropped, unsent, reconnects : int
        Scans handed over; replies that were damaged or missing; turns of a stream that the sensor
        left out, since the scan before was not fetched in time; times that it came back.
    why : str
        Why the last one was dropped.

    Raises
    ------
    SensorError
        Where it cannot be reached, with what to do.
    ValueError
        For no bit rate; for what is no port, no address, or an open port that waits for ever or
        is to come back.

    Examples
    --------
    >>> with UrgSensor("auto") as sensor:  # doctest: +SKIP
    ...     for scan in sensor.scans():
    ...         print(scan)
    """

    def __init__(
        self,
        port: str | PathLike[str] | Port = "auto",
        *,
        rates: Sequence[int] = RATES,
        reconnect: float = 0.0,
        timeout: float = 1.0,
        sensor_pose: ArrayLike = (0.0, 0.0, 0.0),
        clock: Callable[[], float] = host_time,
    ) -> None:
        self._port = checked_port(port)
        self._rates = tuple(arrays.indices(rates, "rates").reshape(-1).tolist())
        if not self._rates or min(self._rates) < 1:
            raise ValueError("rates must name at least one bit rate, and none below 1")
        arrays.number(reconnect, "reconnect", least=0, most=np.inf, unit="seconds")
        if reconnect > 0 and not isinstance(self._port, str):
            raise ValueError("reconnect needs the name of a device: an open port cannot come back")
        self._reconnect = reconnect
        self._timeout = arrays.number(timeout, "timeout", above=0, unit="seconds")
        self._sensor_pose = arrays.pose(sensor_pose, "sensor_pose")
        self._clock = arrays.function(clock, "clock", "without arguments, of seconds")
        self.delivered = self.dropped = self.unsent = self.reconnects = 0
        self.why = ""
        self._asked: ScanRequest | None = None
        self._stamps: deque[int] = deque(maxlen=PACE)
        self._open()

    def scan(
        self, *, first: int | None = None, last: int | None = None, cluster: int = 1
    ) -> LaserScan:
        """The latest turn; the laser is switched on for it and stays on.

        The arguments are those of `scans`.

        Raises
        ------
        SensorError
            Where no whole scan comes after some attempts.
        """
        return self._whole(self.geometry.request("GD", first, last, cluster))

    def scans(
        self,
        *,
        first: int | None = None,
        last: int | None = None,
        cluster: int = 1,
        skip: int = 0,
        short: bool = False,
    ) -> Iterator[LaserScan]:
        """Turn after turn, until the loop is left.

        Damaged scans are left out and counted in `dropped`. Scans that are not fetched wait in
        the port's small buffer; where that is full, the sensor waits, and the turns
        that it leaves out meanwhile are counted in `unsent`.

        Parameters
        ----------
        first, last : int or None
            Steps; None for all that the sensor measures.
        cluster : int
            Only the nearest of so many neighbours is reported.
        skip : int
            Turns left out after each.
        short : bool
            Two characters a distance: a third less to send, and nothing beyond 4.095 m.

        Raises
        ------
        SensorError
            Where the sensor is gone or faulty, or nothing whole has come for some time.
        """
        kind = "MS" if arrays.switch(short, "short") else "MD"
        request = self.geometry.request(kind, first, last, cluster, skip)
        self._asked, self._stamps = request, deque(maxlen=PACE)
        try:
            while True:
                yield self._whole(request)
        finally:
            with contextlib.suppress(SensorError):
                self.stop()

    def state(self) -> dict[str, str]:
        """What the sensor says of its condition: LASR, SCSP, MESM, SBPS, TIME, STAT."""
        self._check_open()
        self._stream.stop()
        return parse_info(ask(self._lines, "II").body)

    @property
    def slow(self) -> str:
        """Why the last stream arrived slower than asked and what to do; empty where it did not."""
        if self._asked is None or len(self._stamps) <= PACE // 2:
            return ""
        wanted = period(self._asked, self.geometry)
        found = float(np.median(np.diff(self._stamps) % CLOCK)) / 1000.0
        if found < SLOW * wanted:
            return ""
        text = f"scans arrive every {found:.2f} s, asked for every {wanted:.2f} s"
        return text + self._advice(self._asked)

    def stop(self) -> None:
        """End a stream and switch the laser off."""
        if self._leave.alive:
            self._stream.stop()

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
        counts = f"{self.delivered} scans, {self.dropped} dropped"
        counts += f", {self.unsent} not sent" if self.unsent else ""
        return f"UrgSensor({model}, {open_}, {counts})"

    # ------------------------------------------------------------------------ scans
    def _whole(self, request: ScanRequest) -> LaserScan:
        """The next whole scan; damaged ones are counted, and a lost sensor is looked for."""
        failures = found = 0
        while max(failures, found) < MOST_FAILURES:
            self._check_open()
            if self._stream.running is not request:
                self._stamps.clear()
            try:
                scan, stamp, dropped = self._stream.take(request)
            except (SensorGone, Silent) as gone:
                self._find_again(gone)
                failures, found, self.why = 0, found + 1, str(gone)
                continue
            self.dropped += len(dropped)
            self.why = dropped[-1] if dropped else self.why
            if scan is not None:
                self.delivered += 1
                if request is self._asked:
                    self._follow(stamp, whole=not failures and not dropped)
                return scan
            failures += 1
        text = f"no whole scan in {MOST_FAILURES} attempts: {self.why}"
        raise SensorError(text + self._advice(request))

    def _follow(self, stamp: int, *, whole: bool) -> None:
        """Keep the stamp of a scan of a stream; count the turns since the last that were not sent.

        The pace is the quickest so far, between what was asked for and what the line carries: a
        slow line leaves out turns without anyone's fault.
        """
        self._stamps.append(stamp)
        half = CLOCK // 2  # a clock that steps back is none that went almost once around
        passed = ((np.diff(self._stamps) + half) % CLOCK - half) / 1000.0
        if whole and self._asked and len(passed):
            wanted = period(self._asked, self.geometry)
            slowest = max(wanted, transfer(self._asked, self.rate))
            pace = max(wanted, passed[:-1].min(initial=slowest))
            self.unsent += max(round(passed[-1] / pace) - 1, 0)

    def _advice(self, request: ScanRequest) -> str:
        """What to do about a line that is too slow for a request; empty where it is not."""
        takes = transfer(request, self.rate)
        if takes <= period(request, self.geometry):
            return ""
        skip = min(ceil(takes / self.geometry.turn) - 1, 9)
        return (
            f"; at {self.rate} bit/s a scan of {request.beams} beams takes {takes:.2f} s: use "
            f"250000 bit/s or USB, short=True, a cluster, or skip={skip}"
        )

    def _open(self) -> None:
        """Open the port and ask the sensor who it is; a failure leaves the port free."""
        port = self._port
        if isinstance(port, str):
            port = open_port(find_port() if port == "auto" else port, self._rates[0])
        lines = Lines(port, self._clock, self._timeout)
        self._leave = weakref.finalize(self, leave, lines)
        try:
            rates = (port.baudrate,) if isinstance(port, TcpPort) else self._rates
            self.rate = connect(lines, rates)
            limits = parse_limits(ask(lines, "PP", check=parse_limits))
            self.info = parse_info(ask(lines, "VV").body) | limits
            self.geometry = parse_geometry(limits)
        except BaseException:
            self._leave()
            raise
        self._lines = lines
        self._stream = ScanStream(lines, self.geometry, self.rate, self._sensor_pose)

    def _check_open(self) -> None:
        if not self._leave.alive:
            raise SensorError("the sensor is closed: make a new UrgSensor")

    def _find_again(self, gone: SensorError) -> None:
        """Look for a lost sensor, at longer and longer intervals; SensorGone without one."""
        if isinstance(gone, Silent) and not self._reconnect:
            raise gone
        self._leave()
        until, wait = self._clock() + self._reconnect, BACK_OFF[0]
        while (left := until - self._clock()) > 0:
            time.sleep(min(wait, left))
            wait = min(2 * wait, BACK_OFF[1])
            try:
                self._open()
                self._stream.light()  # one that was switched on is not ready at once
            except SensorError as error:
                self._leave()
                gone = SensorGone(f"not back within {self._reconnect:g} s: {error}")
            else:
                self.reconnects += 1
                return
        raise gone
