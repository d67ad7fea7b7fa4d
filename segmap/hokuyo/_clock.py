"""The sensor's clock, milliseconds that wrap after 24 bits, as seconds of the host."""

import time
from collections.abc import Callable

from ._coding import CLOCK

#: Seconds after which the sensor's clock starts at 0 again: 4 h 39 min 37 s.
WRAP = CLOCK / 1000.0
#: Quartz clocks part by less than this: seconds a second, chosen ten times what is usual.
DRIFT = 1e-3

_SINCE_1970 = time.time() - time.monotonic()


def host_time() -> float:
    """Seconds since 1970 that only go on, even where somebody sets the host's clock."""
    return _SINCE_1970 + time.monotonic()


class HostClock:
    """When a turn began, by the host's clock.

    The way from the sensor only delays, so of all scans the one that came fastest tells how far
    both clocks are apart; that is forgotten as slowly as clocks drift.

    Parameters
    ----------
    least : float, seconds
        No scan arrives sooner than this after its stamp: the mirror has to get to the last step.

    Examples
    --------
    >>> clock = HostClock()
    >>> [round(clock.seconds(ms, host), 3) for ms, host in ((900, 50.0), (1000, 50.3), (4, 50.2))]
    [50.0, 50.1, 50.2]
    """

    def __init__(self, least: float = 0.0) -> None:
        self.least = least
        self.last: tuple[int, float] | None = None
        self.sensor = self.apart = 0.0

    def seconds(self, stamp: int, arrived: float) -> float:
        """Host time of a sensor's stamp, seconds; stamps come in the order of sending.

        Parameters
        ----------
        stamp : int, milliseconds
        arrived : float, seconds
            When the whole scan was there, by the host.
        """
        if self.last is None:
            self.sensor, self.apart = stamp / 1000.0, arrived - self.least - stamp / 1000.0
        else:
            passed = arrived - self.last[1]
            since = (stamp - self.last[0]) % CLOCK / 1000.0
            self.sensor += since + WRAP * max(round((passed - since) / WRAP), 0)
            drifted = self.apart + DRIFT * max(passed, 0.0)
            self.apart = min(drifted, arrived - self.least - self.sensor)
        self.last = stamp, arrived
        return self.sensor + self.apart


Clock = Callable[[], float]
