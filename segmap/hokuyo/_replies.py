"""What the sensor answers, line by line, and the scan that it means: pure functions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array
from ..scans import LaserScan
from ..scans.error_codes import as_far_ranges, as_ranges
from ._protocol import (
    BLOCK,
    CHARACTERS,
    ScanRequest,
    SensorError,
    ascii_bytes,
    byte_lines,
    checksum,
    decode,
    is_text,
    unchecked,
)

#: What a status means and what to do; for scans and for the commands that start them.
STATUS = {
    "0A": "the sensor could not build a reply: ask again",
    "0B": "the same command was sent twice, or the sensor's buffer is full",
    "0E": "the sensor does not know the command, or is in time mode",
    "0I": "the sensor waits for new firmware: restart it",
    "0M": "the sensor is not ready: it takes some seconds after it was switched on",
    "04": "the last step is beyond what the sensor has",
    "05": "the last step lies before the first",
    "10": "the laser is off: send BM first",
    "01": "the laser does not work, or a number was malformed",
}

#: No number of a sensor's geometry is larger: steps, millimetres, turns a minute.
LARGEST = 1 << 20

_STATUS = re.compile("[0-9A-Z]{2}")
_URG = re.compile("U[RBH]G")  # table 3 of SCIP 2.0 has their error codes


class Reply(NamedTuple):
    """A reply: the echoed command, its status, and the lines after it."""

    echo: str
    status: str
    body: tuple[bytes, ...]


class Measurement(NamedTuple):
    """One turn as the sensor sends it: clock in ms, distances in mm or error codes, `(n,)`."""

    clock: int
    millimetres: NDArray[np.int64]


class Geometry(NamedTuple):
    """What the sensor says of itself: steps of a turn, and the limits of what it measures.

    Attributes
    ----------
    steps : int
        Steps in a whole turn.
    first, last, front : int
        Steps that it measures, and the one straight ahead.
    least, most : int
        Distances that it measures, millimetres.
    turn : float, seconds
    is_far : bool
        Whether its error codes are those of the UTM-30LX and its successors, not the URG-04LX's.
    """

    steps: int
    first: int
    last: int
    front: int
    least: int
    most: int
    turn: float
    is_far: bool = False

    def ranges(self, millimetres: ArrayLike) -> tuple[Array, NDArray[np.int64]]:
        """Ranges in metres of what it sends, and the codes of those that are none, `(n,)`."""
        met = arrays.indices(millimetres, "millimetres")
        far = {"least": self.least, "most": self.most}
        return as_far_ranges(met, **far) if self.is_far else as_ranges(met)

    def angles(self, first: int, count: int, cluster: int = 1) -> Array:
        """Directions of beams, `(count,)`, radians, counter-clockwise, 0 ahead.

        A cluster reports the nearest of its steps; it counts as the one in its middle.
        """
        arrays.whole(first, "first", least=0)
        arrays.whole(count, "count", least=0, most=LARGEST)
        arrays.whole(cluster, "cluster")
        step = first + np.arange(count) * cluster + (cluster - 1) / 2
        return np.asarray((step - self.front) * 2 * np.pi / self.steps)

    def request(
        self,
        kind: str,
        first: int | None = None,
        last: int | None = None,
        cluster: int = 1,
        skip: int = 0,
    ) -> ScanRequest:
        """A request for these steps; None for the outermost that the sensor measures.

        Raises
        ------
        ValueError
            Where the sensor has no such steps, or a number is too large or not whole.
        """
        begin = self.first if first is None else arrays.whole(first, "first", least=0)
        end = self.last if last is None else arrays.whole(last, "last", least=0)
        if not begin <= end <= self.last:
            raise ValueError(
                f"first and last must lie in order within 0 to {self.last}, got {begin} to {end}"
            )
        size, left_out = arrays.whole(cluster, "cluster"), arrays.whole(skip, "skip", least=0)
        request = ScanRequest(kind, begin, end, size, left_out)
        request.check()
        return request


def parse_reply(lines: Sequence[bytes]) -> Reply:
    """A reply of SCIP 2.0, from its echo to the line before the empty one.

    Raises
    ------
    SensorError
        Where the status is missing or its check sum is wrong.

    Examples
    --------
    >>> parse_reply([b"BM", b"02R"])
    Reply(echo='BM', status='02', body=())
    """
    if len(byte_lines(lines, "lines")) < 2:
        raise SensorError(f"a reply of {len(lines)} lines: expected an echo and a status")
    status = _text(unchecked(lines[1]))
    if not _STATUS.fullmatch(status):
        raise SensorError(f"{lines[1][:20]!r} is no status: expected two characters and a sum")
    return Reply(_text(lines[0]), status, tuple(lines[2:]))


def parse_info(body: Sequence[bytes], *, strict: bool = False) -> dict[str, str]:
    """Lines `KEY:text;sum` of VV, PP and II, by key.

    Parameters
    ----------
    body : sequence of bytes
    strict : bool
        False passes over wrong sums and lines without a key: some firmware sends both with VV.

    Raises
    ------
    SensorError
        Where it is strict and a line is no whole one.

    Examples
    --------
    >>> parse_info([b"DMIN:20;4", b"SERI:H0706400;F"])
    {'DMIN': '20', 'SERI': 'H0706400'}
    """
    arrays.switch(strict, "strict")
    found = {}
    for line in byte_lines(body):
        text, end, total = line.rpartition(b";")
        key, colon, value = text.partition(b":") if end else line.partition(b":")
        if strict and not (end and colon and total == checksum(text) and is_text(text)):
            raise SensorError(
                f"{line[:40]!r} is no line of information with its sum, KEY:text;sum: ask again"
            )
        if colon:
            found[_text(key)] = _text(value)
    return found


def info_line(key: str, text: str) -> bytes:
    """A line of information with its sum, which leaves the semicolon out.

    Examples
    --------
    >>> info_line("DMIN", "20")
    b'DMIN:20;4'
    """
    line = ascii_bytes(key, "key") + b":" + ascii_bytes(text, "text")
    return line + b";" + checksum(line)


def parse_geometry(info: dict[str, str]) -> Geometry:
    """The geometry in the answer to PP.

    Raises
    ------
    SensorError
        Where a key is missing or no number, or the limits make no sense.
    """
    arrays.instance(info, "info", dict)
    names = ("ARES", "AMIN", "AMAX", "AFRT", "DMIN", "DMAX", "SCAN")
    try:
        numbers = [int(info[name]) for name in names]
    except (KeyError, TypeError, ValueError) as error:
        raise SensorError(f"PP told no geometry, {error} is wrong in {info}") from None
    steps, first, last, front, least, most, rpm = numbers
    is_arc = 0 <= first <= last < steps <= LARGEST and 0 <= front < steps
    if not (is_arc and 0 <= least < most <= LARGEST and 0 < rpm <= LARGEST):
        raise SensorError(f"PP told a geometry that cannot be: {info}")
    is_far = "MODL" in info and not _URG.search(info["MODL"])
    return Geometry(steps, first, last, front, least, most, 60.0 / rpm, is_far)


def parse_scan(body: Sequence[bytes], characters: int) -> Measurement:
    """Clock and distances of GD, GS, MD or MS: blocks are checked, joined, then decoded.

    Raises
    ------
    SensorError
        Where a sum is wrong, a block is not whole, or characters are missing.

    Examples
    --------
    >>> parse_scan([b"JUGnD", b"06805m" + checksum(b"06805m")], 3)
    Measurement(clock=6968830, millimetres=array([392, 381]))
    """
    arrays.whole(characters, "characters", most=8)
    if not byte_lines(body):
        raise SensorError("a scan without a time stamp")
    clock = decode(unchecked(body[0]), 4)
    if len(clock) != 1:
        raise SensorError(f"{body[0][:20]!r} is no time stamp: expected four characters and a sum")
    blocks = [unchecked(line) for line in body[1:]]
    if any(len(block) != BLOCK for block in blocks[:-1]) or len(b"".join(blocks[-1:])) > BLOCK:
        raise SensorError(f"a block without its {BLOCK} characters: the end of a line was lost")
    return Measurement(int(clock[0]), decode(b"".join(blocks), characters))


def laser_scan(
    met: Measurement,
    request: ScanRequest,
    geometry: Geometry,
    *,
    time: float,
    sensor_pose: ArrayLike = (0.0, 0.0, 0.0),
) -> LaserScan:
    """The scan that a measurement means.

    Parameters
    ----------
    met : Measurement
    request : ScanRequest
        That it answers.
    geometry : Geometry
    time : float, seconds
    sensor_pose : (3,) array, metres and radians
        Pose of the sensor in the frame of the robot.

    Examples
    --------
    >>> urg, one = Geometry(1024, 44, 725, 384, 20, 5600, 0.1), ScanRequest("GD", 384, 384)
    >>> laser_scan(Measurement(0, np.array([1500])), one, urg, time=0.0).points()
    array([[1.5, 0. ]])
    """
    arrays.instance(met, "met", Measurement)
    arrays.instance(request, "request", ScanRequest).check()
    arrays.instance(geometry, "geometry", Geometry)
    ranges, codes = geometry.ranges(met.millimetres)
    most = min(geometry.most, 64 ** CHARACTERS[request.kind] - 1)
    angles = geometry.angles(request.first, len(ranges), request.cluster)
    return LaserScan(ranges, angles, time, None, most / 1000.0, sensor_pose, codes)


def explain(status: str) -> str:
    """What a status means, in words."""
    if arrays.instance(status, "status", str) in STATUS:
        return STATUS[status]
    if status.isdigit() and 50 <= int(status) < 98:
        return "the sensor reports a hardware fault: switch it off and on, then have it checked"
    return "the sensor refused"


def _text(line: bytes) -> str:
    return line.decode("ascii", "replace")


def parse_limits(reply: Reply) -> dict[str, str]:
    """The answer to PP, checked: one wrong bit in it would turn every scan."""
    limits = parse_info(reply.body, strict=True)
    parse_geometry(limits)
    return limits
