"""The driver: a URG-04LX that connects, delivers scans, and is always left with its laser off."""

import contextlib
import weakref
from collections.abc import Iterator, Sequence
from types import TracebackType
from typing import Self

from numpy.typing import ArrayLike

from ..scans import LaserScan
from ._clock import Clock, host_time
from ._coding import SensorError
from ._connect import RATES, Refused, ask, refused
from ._line import Port, SensorGone
from ._replies import Geometry, Reply, parse_info, parse_reply
from ._requests import ScanRequest
from ._session import Session
from ._turns import Turns

#: So many damaged or missing scans in a row are an error, not bad luck.
MOST_FAILURES = 5


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
        self._reconnect, self._pose = reconnect, sensor_pose
        self.delivered = self.dropped = self.reconnects = 0
        self.why = ""
        self._finalizer = weakref.finalize(self, self._session.shut)
        self._asked: ScanRequest | None = None
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
        request = self._turns.request("GD", first, last, cluster)
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
        request = self._turns.request("MS" if short else "MD", first, last, cluster, skip)
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
        return "" if self._asked is None else self._turns.slow(self._asked)

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
                    raise Refused(str(refused(request.text, reply.status)))
                return self._measured(reply, request)
            except (SensorGone, Refused):
                raise
            except SensorError as error:
                fault = error
                self._drop(str(error))
                self._session.lines.silence(self._session.quiet / 4)
        raise self._failure(request, str(fault))

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
        raise self._failure(request, why)

    def _begin(self, request: ScanRequest) -> None:
        """Start a stream; what it was doing before is ended first."""
        self.stop()
        self._session.busy = True
        self._session.ask(request.text)
        self._asked = request
        self._turns.begin()

    def _next(self, request: ScanRequest) -> LaserScan | str:
        """The next whole scan of a stream, or why the next is none; that is counted."""
        lines = self._session.lines
        if self._asked is not request:  # something else was asked meanwhile
            self._begin(request)
        try:
            found = lines.reply(request.text.encode("ascii"), self._wait(request))
            if lines.strange:
                self._drop(f"{lines.strange} lines that belong to no scan")
            if found is not None:
                return self._measured(self._streamed(found, request), request)
            why = f"nothing came for {self._wait(request):.2g} s"
        except (SensorGone, Refused):
            raise
        except SensorError as error:
            return self._drop(str(error))
        self._drop(why)
        self._begin(request)
        return why

    def _drop(self, why: str) -> str:
        self.dropped, self.why = self.dropped + 1, why
        return why

    def _streamed(self, lines: Sequence[bytes], request: ScanRequest) -> Reply:
        reply = parse_reply(lines)
        if reply.status.isdigit() and (50 <= int(reply.status) < 98 or int(reply.status) < 20):
            raise Refused(str(refused(request.text, reply.status)))
        if reply.status != "99":
            raise refused(request.text, reply.status)
        return reply

    def _find_again(self, gone: SensorGone) -> None:
        self._session.find_again(gone, self._reconnect)
        self.reconnects += 1
        self._reset()

    def _reset(self) -> None:
        """Forget what was true of the connection before."""
        self._asked = None
        self._turns = Turns(self.geometry, self.rate, self._pose)

    def _wait(self, request: ScanRequest) -> float:
        return self._turns.wait(request) + self._session.patience

    def _measured(self, reply: Reply, request: ScanRequest) -> LaserScan:
        scan = self._turns.scan(reply, request, self._session.clock())
        self.delivered += 1
        return scan

    def _failure(self, request: ScanRequest, why: str) -> SensorError:
        advice = self._turns.advice(request)
        return SensorError(f"no whole scan in {MOST_FAILURES} attempts: {why}{advice}")
