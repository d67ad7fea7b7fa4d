"""The host's side: its clock beside the sensor's, and the newest scan for a slow reader."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable, Iterator, Sized
from typing import Self

from .. import arrays
from ..scans import LaserScan
from ._protocol import CLOCK_WRAP_MS

#: Seconds after which the sensor's clock starts at 0 again: 4 h 39 min 37 s.
CLOCK_WRAP_S = CLOCK_WRAP_MS / 1000.0
#: Two quartz clocks drift apart by less than this, seconds a second: ten times what is usual.
DRIFT_S_PER_S = 1e-3
#: The waiting reader looks so often whether it has been closed, seconds.
LOOK_S = 0.05

_SINCE_1970 = time.time() - time.monotonic()


def host_time() -> float:
    """Seconds since 1970 that only go on, even where somebody sets the host's clock."""
    return _SINCE_1970 + time.monotonic()


class HostClock:
    """Turns the sensor's stamps, milliseconds that wrap after 24 bits, into the host's seconds.

    The line from the sensor only delays, so the scan that came fastest tells how far both clocks
    are apart. That knowledge fades as slowly as the clocks drift.

    No scan arrives sooner than `least` seconds after its stamp: the mirror has to get to the last
    step.

    Examples
    --------
    >>> clock = HostClock()
    >>> [round(clock.seconds(ms, host), 3) for ms, host in ((900, 50.0), (1000, 50.3), (4, 50.2))]
    [50.0, 50.1, 50.2]
    """

    def __init__(self, least: float = 0.0) -> None:
        self.least = least
        self._last: tuple[int, float] | None = None
        self._sensor = self._apart = 0.0

    def seconds(self, stamp: int, arrived: float) -> float:
        """Host time of a sensor's stamp, ms; stamps come in the order of sending.

        The whole scan was there when it `arrived`, by the host.
        """
        if self._last is None:
            self._sensor, self._apart = stamp / 1000.0, arrived - self.least - stamp / 1000.0
        else:
            passed = arrived - self._last[1]
            since = (stamp - self._last[0]) % CLOCK_WRAP_MS / 1000.0
            self._sensor += since + CLOCK_WRAP_S * max(round((passed - since) / CLOCK_WRAP_S), 0)
            drifted = self._apart + DRIFT_S_PER_S * max(passed, 0.0)
            self._apart = min(drifted, arrived - self.least - self._sensor)
        self._last = stamp, arrived
        return self._sensor + self._apart


def one_by_one(value: Iterable[LaserScan], name: str) -> Iterator[LaserScan]:
    """What gives scans, ready to give them."""
    several = arrays.is_iterable(value)
    listed = value if several and isinstance(value, Sized) else ()
    if not (several and all(isinstance(scan, LaserScan) for scan in listed)):
        raise ValueError(f"{name} must give LaserScans one by one, got {arrays.brief(value)}")
    return iter(value)


class Newest:
    """Hands a slow reader the newest scan; older ones that it did not take are left out.

    A thread of its own reads, until the end of `with`; nothing else may use the sensor meanwhile.
    Errors of the scans come where they are read; `skipped` counts those that were never handed
    over.

    Examples
    --------
    >>> with Newest([LaserScan([1.0], [0.0], time=t) for t in range(9)]) as newest:
    ...     [scan.time for scan in newest][-1]
    8.0
    """

    def __init__(self, scans: Iterable[LaserScan]) -> None:
        self.skipped = 0
        self._scans = one_by_one(scans, "scans")
        self._news = threading.Condition()
        self._scan: LaserScan | None = None
        self._ended = self._closing = False
        self._fault: Exception | None = None
        self._thread = threading.Thread(target=self._read, name="newest scan", daemon=True)

    def __iter__(self) -> Iterator[LaserScan]:
        while True:
            with self._news:
                while self._scan is None and not self._ended:
                    self._news.wait(LOOK_S)
                scan, self._scan = self._scan, None
            if scan is None:
                break
            yield scan
        if self._fault is not None:
            raise self._fault

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End the thread, and with it the stream."""
        self._closing = True
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join()

    def _read(self) -> None:
        try:
            for scan in self._scans:
                with self._news:
                    self.skipped += self._scan is not None
                    self._scan = scan
                    self._news.notify()
                if self._closing:
                    break
        except Exception as fault:
            self._fault = fault
        finally:
            close = getattr(self._scans, "close", None)
            if close is not None:
                close()
            with self._news:
                self._ended = True
                self._news.notify()
