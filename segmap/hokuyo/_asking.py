"""Scans asked of a connected sensor: one, or a stream; what comes damaged is counted."""

from collections.abc import Iterator, Sequence

from numpy.typing import ArrayLike

from ..scans import LaserScan
from ._coding import SensorError
from ._connect import Refused, ask, refused
from ._line import SensorGone
from ._replies import Reply, parse_reply
from ._requests import ScanRequest
from ._session import Session
from ._turns import Turns

#: So many damaged or missing scans in a row are an error, not bad luck.
MOST_FAILURES = 5


class Asking:
    """What is asked of a session, and what came of it.

    Parameters
    ----------
    session : Session
        That is open.
    pose : (3,) array, metres and radians
        Of the sensor on the robot.

    Attributes
    ----------
    delivered, dropped : int
        Scans handed over; replies that were damaged or missing.
    why : str
        Why the last one was dropped.
    turns : Turns
    """

    turns: Turns

    def __init__(self, session: Session, pose: ArrayLike) -> None:
        self.session, self.pose = session, pose
        self.delivered = self.dropped = 0
        self.why = ""
        self.begin()

    def begin(self) -> None:
        """Of a connection that is new nothing is known."""
        self.turns = Turns(self.session.geometry, self.session.rate, self.pose)
        self.streaming: ScanRequest | None = None

    def stop(self) -> None:
        """End a stream and switch the laser off."""
        self.streaming = None
        self.session.quit()

    def single(self, request: ScanRequest) -> LaserScan:
        """The answer to a request for one scan, asked again where it was damaged.

        Raises
        ------
        SensorError
            Where no whole scan comes after some attempts.
        """
        if self.streaming is not None:
            self.stop()
        for _ in range(MOST_FAILURES):
            self._switch_on()
            try:
                return self._measured(self._answer(request), request)
            except (SensorGone, Refused):
                raise
            except SensorError as error:
                self._drop(str(error))
                self.session.lines.silence(self.session.quiet / 4)
        raise self._failure(request)

    def stream(self, request: ScanRequest) -> Iterator[LaserScan]:
        """Scan after scan.

        Raises
        ------
        SensorError
            Where nothing whole has come for some time.
        """
        self._start(request)
        failures = 0
        while failures < MOST_FAILURES:
            scan = self._next(request)
            failures = failures + 1 if scan is None else 0
            if scan is not None:
                yield scan
        raise self._failure(request)

    @property
    def slow(self) -> str:
        """Why scans arrive slower than asked and what to do; empty where they do not."""
        return "" if self.streaming is None else self.turns.slow(self.streaming)

    # ------------------------------------------------------------------------- one
    def _switch_on(self) -> None:
        if not self.session.busy:
            self.session.ask("BM")
            self.session.busy = True

    def _answer(self, request: ScanRequest) -> Reply:
        reply = ask(self.session.lines, request.text, self._wait(request))
        if reply.status == "10":  # it went off by itself, or BM was lost: switch on again
            self.session.busy = False
            raise refused(request.text, reply.status)
        if reply.status != "00":
            raise Refused(str(refused(request.text, reply.status)))
        return reply

    # ----------------------------------------------------------------------- stream
    def _start(self, request: ScanRequest) -> None:
        """Start a stream; what it was doing before is ended first."""
        self.stop()
        self.session.busy = True
        self.session.ask(request.text)
        self.streaming = request
        self.turns.begin()

    def _next(self, request: ScanRequest) -> LaserScan | None:
        """The next whole scan of a stream; None where the next is none, which is counted."""
        if self.streaming is not request:  # something else was asked meanwhile
            self._start(request)
        try:
            found = self._heard(request)
            if found is not None:
                return self._measured(_streamed(found, request), request)
        except (SensorGone, Refused):
            raise
        except SensorError as error:
            self._drop(str(error))
        else:
            self._drop(f"nothing came for {self._wait(request):.2g} s")
            self._start(request)
        return None

    def _heard(self, request: ScanRequest) -> list[bytes] | None:
        """Lines of the next answer; what comes before its echo is counted as one that was lost."""
        lines = self.session.lines
        found = lines.reply(request.text.encode("ascii"), self._wait(request))
        if lines.strange:
            self._drop(f"{lines.strange} lines that belong to no scan")
        return found

    # ------------------------------------------------------------------------- both
    def _wait(self, request: ScanRequest) -> float:
        return self.turns.wait(request) + self.session.patience

    def _measured(self, reply: Reply, request: ScanRequest) -> LaserScan:
        scan = self.turns.scan(reply, request, self.session.clock())
        self.delivered += 1
        return scan

    def _drop(self, why: str) -> None:
        self.dropped, self.why = self.dropped + 1, why

    def _failure(self, request: ScanRequest) -> SensorError:
        advice = self.turns.advice(request)
        return SensorError(f"no whole scan in {MOST_FAILURES} attempts: {self.why}{advice}")


def _streamed(lines: Sequence[bytes], request: ScanRequest) -> Reply:
    """The reply that holds a scan of a stream."""
    reply = parse_reply(lines)
    if reply.status.isdigit() and (50 <= int(reply.status) < 98 or int(reply.status) < 20):
        raise Refused(str(refused(request.text, reply.status)))
    if reply.status != "99":
        raise refused(request.text, reply.status)
    return reply
