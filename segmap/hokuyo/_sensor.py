"""The driver: a URG-04LX that connects, delivers scans, and is always left with its laser off."""

import contextlib
import weakref
from collections.abc import Iterator, Sequence
from os import PathLike, fspath
from types import TracebackType
from typing import Self

from numpy.typing import ArrayLike

from ..scans import LaserScan
from ._asking import Asking
from ._clock import Clock, host_time
from ._coding import SensorError
from ._connect import RATES
from ._line import Port, SensorGone
from ._replies import Geometry, parse_info
from ._session import Session


class UrgSensor:
    """A Hokuyo URG-04LX that is connected: use it as a context manager.

    However it ends - `close`, the end of `with`, an exception, an interrupt, or being forgotten -
    the laser is switched off and the port freed. For one thread at a time.

    Parameters
    ----------
    port : str or Path or Port
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
    ValueError
        For no bit rate; for an open port that is to come back after unplugging, or that waits for
        ever.
    TypeError
        For a port that is none.

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
        patience: float = 1.0,
        sensor_pose: ArrayLike = (0.0, 0.0, 0.0),
        clock: Clock = host_time,
    ) -> None:
        if isinstance(port, PathLike):
            port = fspath(port)
        if not len(rates):
            raise ValueError("rates must name at least one bit rate")
        if reconnect > 0 and not isinstance(port, str):
            raise ValueError("reconnect needs the name of a device: an open port cannot come back")
        self._session = Session(port, rates, patience, clock)
        self._reconnect, self.reconnects = reconnect, 0
        self._finalizer = weakref.finalize(self, self._session.shut)
        self._session.open()
        self._asking = Asking(self._session, sensor_pose)

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

    @property
    def delivered(self) -> int:
        """Scans handed over."""
        return self._asking.delivered

    @property
    def dropped(self) -> int:
        """Replies that were damaged or missing."""
        return self._asking.dropped

    @property
    def why(self) -> str:
        """Why the last one was dropped; empty where none was."""
        return self._asking.why

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
        request = self._asking.turns.request("GD", first, last, cluster)
        while True:
            try:
                return self._asking.single(request)
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
        kind = "MS" if short else "MD"
        request = self._asking.turns.request(kind, first, last, cluster, skip)
        try:
            while True:
                try:
                    yield from self._asking.stream(request)
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
        return self._asking.slow

    def stop(self) -> None:
        """End a stream and switch the laser off."""
        self._asking.stop()

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

    def _find_again(self, gone: SensorGone) -> None:
        self._session.find_again(gone, self._reconnect)
        self.reconnects += 1
        self._asking.begin()
