"""The newest scan only: for a reader that may be slower than the sensor."""

import threading
from collections.abc import Iterable, Iterator
from types import TracebackType
from typing import Self

from ..scans import LaserScan

#: The waiting reader looks so often whether it has been closed, seconds.
LOOK = 0.05


class Newest:
    """Scans as they come, of which a slow reader gets the newest; older ones are left out.

    A thread of its own reads; nothing else may use the sensor meanwhile. It ends at the end of
    `with`.

    Parameters
    ----------
    scans : iterable of LaserScan
        `sensor.scans()`.

    Attributes
    ----------
    skipped : int
        Scans that came and were never handed over.

    Raises
    ------
    SensorError
        As the scans do, where they are read.

    Examples
    --------
    >>> with Newest([LaserScan([1.0], [0.0], time=t) for t in range(9)]) as newest:
    ...     [scan.time for scan in newest][-1]
    8.0
    """

    def __init__(self, scans: Iterable[LaserScan]) -> None:
        self.skipped = 0
        self._scans = iter(scans)
        self._news = threading.Condition()
        self._scan: LaserScan | None = None
        self._ended = self._closing = False
        self._fault: Exception | None = None
        self._thread = threading.Thread(target=self._read, name="newest scan", daemon=True)

    def __iter__(self) -> Iterator[LaserScan]:
        while True:
            with self._news:
                while self._scan is None and not self._ended:
                    self._news.wait(LOOK)
                scan, self._scan = self._scan, None
            if scan is None:
                break
            yield scan
        if self._fault is not None:
            raise self._fault

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
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
