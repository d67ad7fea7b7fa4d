"""The driver: a URG-04LX that connects, delivers scans, and is always left with its laser off."""

import contextlib
import weakref
from collections import deque
from collections.abc import Iterator, Sequence
from math import ceil
from statistics import median
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from ..scans import LaserScan
from ._clock import Clock, HostClock, host_time
from ._coding import CLOCK, SensorError
from ._connect import RATES, ask, refused
from ._line import Port, SensorGone
from ._replies import Geometry, Reply, as_ranges, parse_info, parse_reply, parse_scan
from ._requests import CHARACTERS, ScanRequest
from ._session import Session

#: So many damaged or missing scans in a row are an error, not bad luck.
MOST_FAILURES = 5
#: Intervals from which the pace of a stream is judged.
PACE = 10


class UrgSensor:
    """A Hokuyo URG-04LX that is connected: use it as a context manager.

    However it ends - `close`, the end of `with`, an exception, an interrupt, or being forgotten -
    the laser is switched off and the port freed. For one thread at a time.

    Parameters
    ----------
    port : str or Port
        A device, "auto" for the one Hokuyo on USB, or an open port.
    rates : sequence of int, bits a second
        To look for the sensor at; it is then switched to the first. USB takes any.
    reconnect : float, seconds
        How long to look for a sensor that was unplugged while it was in use; 0 raises at once.
    patience : float, seconds
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
    delivered, dropped, reconnects : int
        Scans handed over; replies that were damaged or missing; times that it came back.

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

    def __init__(
        self,
        port: str | Port = "auto",
        *,
        rates: Sequence[int] = RATES,
        reconnect: float = 0.0,
        patience: float = 1.0,
        sensor_pose: ArrayLike = (0.0, 0.0, 0.0),
        clock: Clock = host_time,
    ) -> None:
        if reconnect > 0 and not isinstance(port, str):
            raise ValueError("reconnect needs the name of a device: an open port cannot come back")
        self._session = Session(port, rates, patience, clock)
        self._reconnect, self._pose = reconnect, np.array(sensor_pose, float)
        self.delivered = self.dropped = self.reconnects = 0
        self._finalizer = weakref.finalize(self, self._session.shut)
        self._asked: ScanRequest | None = None
        self._stamp: int | None = None
        self._session.open()
        self._reset()

    @property
    def info(self) -> dict[str, str]:
        """What the sensor says of itself."""
        return self._session.info

    @property
    def geometry(self) -> Geometry:
        """Steps of a turn and limits, by the sensor's own word."""
        return self._session.geometry

    @property
    def rate(self) -> int:
        """Bits a second that both talk at."""
        return self._session.rate

    def scan(
        self, *, first: int | None = None, last: int | None = None, cluster: int = 1
    ) -> LaserScan:
        """The latest turn; the laser is switched on for it and stays on.

        Parameters
        ----------
        first, last : int or None
            Steps; None for all that the sensor measures.
        cluster : int
            Only the nearest of so many neighbours is reported.

        Raises
        ------
        SensorError
            Where no whole scan comes after some attempts.
        """
        request = self._request("GD", first, last, cluster, 0)
        while True:
            try:
                if self._asked is not None:
                    self.stop()
                return self._single(request)
            except SensorGone as gone:
                self._find_again(gone)

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

        Damaged scans are left out and counted in `dropped`. Scans that are not fetched wait in the
        port's small buffer; then the sensor waits.

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
        request = self._request("MS" if short else "MD", first, last, cluster, skip)
        try:
            while True:
                try:
                    yield from self._stream(request)
                except SensorGone as gone:
                    self._find_again(gone)
        finally:
            with contextlib.suppress(SensorError):
                self.stop()

    def state(self) -> dict[str, str]:
        """What the sensor says of its condition: LASR, SCSP, MESM, SBPS, TIME, STAT."""
        self.stop()
        return parse_info(self._session.ask("II").body)

    @property
    def slow(self) -> str:
        """Why scans arrive slower than asked and what to do; empty where they do not."""
        request = self._asked
        if request is None or len(self._intervals) < PACE // 2:
            return ""
        wanted, found = self._period(request), median(self._intervals)
        if found < 1.5 * wanted:
            return ""
        return f"scans arrive every {found:.2f} s, asked for every {wanted:.2f} s{self._advice()}"

    def stop(self) -> None:
        """End a stream and switch the laser off."""
        self._asked = None
        self._session.quit()

    def close(self) -> None:
        """Switch the laser off and free the port; nothing happens the second time."""
        self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        model = self.info.get("MODL", "unknown").partition("(")[0]
        open_ = "closed" if self._session.opened is None else f"{self.rate} bit/s"
        counts = f"{self.delivered} scans, {self.dropped} dropped"
        return f"UrgSensor({model}, {open_}, {counts})"

    # --------------------------------------------------------------------- asking
    def _single(self, request: ScanRequest) -> LaserScan:
        fault = SensorError("")
        for _ in range(MOST_FAILURES):
            if not self._session.busy:
                self._session.ask("BM")
                self._session.busy = True
            try:
                reply = ask(self._session.lines, request.text, self._wait(request))
                if reply.status == "10":
                    self._session.busy = False
                    continue
                if reply.status != "00":
                    raise _Refused(str(refused(request.text, reply.status)))
                return self._measured(reply, request)
            except (SensorGone, _Refused):
                raise
            except SensorError as error:
                fault = error
                self.dropped += 1
                self._session.lines.silence(self._session.quiet / 4)
        raise SensorError(f"no whole scan in {MOST_FAILURES} attempts: {fault}{self._advice()}")

    def _stream(self, request: ScanRequest) -> Iterator[LaserScan]:
        self._begin(request)
        failures, why = 0, ""
        while failures < MOST_FAILURES:
            found = self._next(request)
            if isinstance(found, LaserScan):
                failures = 0
                yield found
            else:
                failures, why = failures + 1, found
        raise SensorError(f"no whole scan in {MOST_FAILURES} attempts: {why}{self._advice()}")

    def _begin(self, request: ScanRequest) -> None:
        """Start a stream; what it was doing before is ended first."""
        self.stop()
        self._session.busy = True
        self._session.ask(request.text)
        self._asked = request
        self._intervals.clear()
        self._stamp = None

    def _next(self, request: ScanRequest) -> LaserScan | str:
        """The next whole scan of a stream, or why the next is none; that is counted."""
        lines = self._session.lines
        if self._asked is not request:  # something else was asked meanwhile
            self._begin(request)
        try:
            found = lines.reply(request.text.encode("ascii"), self._wait(request))
            self.dropped += lines.strange > 0
            if found is not None:
                return self._measured(self._streamed(found, request), request)
            why = f"nothing came for {self._wait(request):.2g} s"
        except (SensorGone, _Refused):
            raise
        except SensorError as error:
            self.dropped += 1
            return str(error)
        self.dropped += 1
        self._begin(request)
        return why

    def _streamed(self, lines: Sequence[bytes], request: ScanRequest) -> Reply:
        reply = parse_reply(lines)
        if reply.status.isdigit() and (50 <= int(reply.status) < 98 or int(reply.status) < 20):
            raise _Refused(str(refused(request.text, reply.status)))
        if reply.status != "99":
            raise refused(request.text, reply.status)
        return reply

    def _find_again(self, gone: SensorGone) -> None:
        self._session.find_again(gone, self._reconnect)
        self.reconnects += 1
        self._reset()

    def _reset(self) -> None:
        """Forget what was true of the connection before."""
        g = self.geometry
        self._times = HostClock((g.last + 1) / g.steps * g.turn)
        self._asked = self._stamp = None
        self._intervals: deque[float] = deque(maxlen=PACE)

    # ------------------------------------------------------------------- measuring
    def _request(
        self, kind: str, first: int | None, last: int | None, cluster: int, skip: int
    ) -> ScanRequest:
        g = self.geometry
        begin = g.first if first is None else first
        end = g.last if last is None else last
        if not (0 <= begin <= end <= g.last and cluster >= 1):
            raise ValueError(
                f"steps must lie in order within 0 to {g.last} and cluster be at least 1, "
                f"got {begin} to {end} and {cluster}"
            )
        request = ScanRequest(kind, begin, end, cluster, skip)
        request.check()
        return request

    def _measured(self, reply: Reply, request: ScanRequest) -> LaserScan:
        """The scan that a reply holds.

        Raises
        ------
        SensorError
            Where it is damaged.
        """
        arrived, characters = self._session.clock(), CHARACTERS[request.kind]
        measurement = parse_scan(reply.body, characters)
        count = len(measurement.millimetres)
        whole = (request.last - request.first + 1) // request.cluster
        if count not in (request.beams, whole):
            raise SensorError(f"{count} beams, asked for {request.beams}: bytes were lost")
        self._note(measurement.clock)
        self.delivered += 1
        ranges, codes = as_ranges(measurement.millimetres)
        return LaserScan(
            ranges,
            self.geometry.angles(request.first, count, request.cluster),
            time=self._times.seconds(measurement.clock, arrived),
            max_range=min(self.geometry.most, 64**characters - 1) / 1000.0,
            sensor_pose=self._pose,
            codes=codes,
        )

    def _note(self, stamp: int) -> None:
        if self._stamp is not None:
            self._intervals.append((stamp - self._stamp) % CLOCK / 1000.0)
        self._stamp = stamp

    def _period(self, request: ScanRequest) -> float:
        """Seconds from scan to scan, as asked for."""
        return (request.skip + 1) * self.geometry.turn

    def _wait(self, request: ScanRequest) -> float:
        """Seconds in which an answer must have come: two turns, its transfer, patience."""
        return (
            self._period(request)
            + self.geometry.turn
            + self._transfer(request)
            + self._session.patience
        )

    def _transfer(self, request: ScanRequest) -> float:
        return 10 * request.size / self.rate

    def _advice(self) -> str:
        """What to do about a line that is too slow; empty where it is not."""
        if self._asked is None or self._transfer(self._asked) <= self._period(self._asked):
            return ""
        takes, turn = self._transfer(self._asked), self.geometry.turn
        return (
            f"; at {self.rate} bit/s a scan of {self._asked.beams} beams takes {takes:.2f} s: use "
            f"250000 bit/s or USB, short=True, a cluster, or skip={min(ceil(takes / turn) - 1, 9)}"
        )


class _Refused(SensorError):
    """A status that asking again does not mend."""
