"""Turns of one connected sensor: what may be asked, how long it takes, what the answer means."""

from collections import deque
from math import ceil
from operator import index
from statistics import median

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..error_codes import as_ranges
from ..scans import LaserScan
from ._clock import HostClock
from ._coding import CLOCK, SensorError
from ._replies import Geometry, Reply, parse_scan
from ._requests import CHARACTERS, ScanRequest

#: Intervals from which the pace of a stream is judged.
PACE = 10
#: Scans so much farther apart than asked are called slow.
SLOW = 1.5


class Turns:
    """From requests to scans, with the sensor's own geometry and clock.

    Parameters
    ----------
    geometry : Geometry
    rate : int, bits a second
    pose : (3,) array, metres and radians
        Of the sensor on the robot.
    """

    def __init__(self, geometry: Geometry, rate: int, pose: ArrayLike) -> None:
        self.geometry, self.rate = geometry, rate
        self.pose: Array = np.array(pose, float)
        self.clock = HostClock((geometry.last + 1) / geometry.steps * geometry.turn)
        self.intervals: deque[float] = deque(maxlen=PACE)
        self.stamp: int | None = None

    def request(
        self, kind: str, first: int | None, last: int | None, cluster: int, skip: int = 0
    ) -> ScanRequest:
        """A request for these steps; None for the outermost that it measures.

        Raises
        ------
        ValueError
            Where the sensor has no such steps, or a number is too large.
        TypeError
            For a number that is not whole.
        """
        g = self.geometry
        begin = g.first if first is None else index(first)
        end = g.last if last is None else index(last)
        if not (0 <= begin <= end <= g.last and cluster >= 1):
            raise ValueError(
                f"steps must lie in order within 0 to {g.last} and cluster be at least 1, "
                f"got {begin} to {end} and {cluster}"
            )
        request = ScanRequest(kind, begin, end, index(cluster), index(skip))
        request.check()
        return request

    def scan(self, reply: Reply, request: ScanRequest, arrived: float) -> LaserScan:
        """The scan that a reply holds.

        Raises
        ------
        SensorError
            Where it is damaged.
        """
        characters = CHARACTERS[request.kind]
        stamp, met = parse_scan(reply.body, characters)
        if len(met) not in (request.beams, request.steps // request.cluster):
            raise SensorError(f"{len(met)} beams, asked for {request.beams}: bytes were lost")
        self._note(stamp)
        ranges, codes = as_ranges(met)
        return LaserScan(
            ranges,
            self.geometry.angles(request.first, len(met), request.cluster),
            time=self.clock.seconds(stamp, arrived),
            max_range=min(self.geometry.most, 64**characters - 1) / 1000.0,
            sensor_pose=self.pose,
            codes=codes,
        )

    def begin(self) -> None:
        """A new stream has a pace of its own."""
        self.intervals.clear()
        self.stamp = None

    def slow(self, request: ScanRequest) -> str:
        """Why scans arrive slower than asked and what to do; empty where they do not."""
        if len(self.intervals) < PACE // 2:
            return ""
        wanted, found = self._period(request), median(self.intervals)
        if found < SLOW * wanted:
            return ""
        return f"scans arrive every {found:.2f} s, asked for every {wanted:.2f} s" + self.advice(
            request
        )

    def wait(self, request: ScanRequest) -> float:
        """Seconds in which an answer must have come: its turn, one more, and its transfer."""
        return self._period(request) + self.geometry.turn + self._transfer(request)

    def advice(self, request: ScanRequest) -> str:
        """What to do about a line that is too slow for a request; empty where it is not."""
        takes = self._transfer(request)
        if takes <= self._period(request):
            return ""
        return (
            f"; at {self.rate} bit/s a scan of {request.beams} beams takes {takes:.2f} s: use "
            f"250000 bit/s or USB, short=True, a cluster, or skip={self._fitting_skip(takes)}"
        )

    def _fitting_skip(self, takes: float) -> int:
        return min(ceil(takes / self.geometry.turn) - 1, 9)

    def _period(self, request: ScanRequest) -> float:
        """Seconds from scan to scan, as asked for."""
        return (request.skip + 1) * self.geometry.turn

    def _transfer(self, request: ScanRequest) -> float:
        return 10 * request.size / self.rate

    def _note(self, stamp: int) -> None:
        if self.stamp is not None:
            self.intervals.append((stamp - self.stamp) % CLOCK / 1000.0)
        self.stamp = stamp
