"""SCIP 1.1 and 2.0 as bytes: numbers as characters, check sums, requests, replies.

Pure functions, for the driver and for the emulator.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays

#: Characters lie from "0" on, six bits each.
ZERO = 0x30
#: A clock of four characters wraps after so many milliseconds: 4 h 39 min 37 s.
CLOCK_WRAP_MS = 1 << 24
#: Data characters in a block.
BLOCK_CHARACTERS = 64
#: Characters of a distance that is asked for.
CHARACTERS = 3
#: What a status means and what to do; for scans and for the commands that start them.
STATUS = {
    "0A": "the sensor could not build a reply: ask again",
    "0B": "the same command was sent twice, or the sensor's buffer is full",
    "0E": "the sensor does not know the command, or is in time mode",
    "0I": "the sensor waits for new firmware: restart it",
    "0M": "the sensor is not ready: it takes some seconds after it was switched on",
    "04": "the last step is beyond what the sensor has",
    "05": "the last step lies before the first",
    "01": "the laser does not work, or a number was malformed",
}
_FAULTY = "the sensor reports a hardware fault: switch it off and on, then have it checked"
_SCAN = re.compile("MD([0-9]{4})([0-9]{4})010([0-9]{2})")
_STATUS = re.compile("[0-9A-Z]{2}")


class SensorError(RuntimeError):
    """A laser that is lost, is busy or breaks its protocol; the text says what to do about it."""


class SensorGone(SensorError):
    """The port vanished: the sensor was unplugged, or its power failed."""


class Refused(SensorError):
    """A status that stays the same when the command is sent again."""


class Silent(SensorError):
    """The sensor says nothing at all: its power or its cable may be gone where no port tells so."""


def encode(values: ArrayLike, characters: int) -> bytes:
    """Whole numbers as characters, the same count for each, most significant first.

    Of numbers from 0 to `64 ** characters - 1`: 2 or 3 characters for distances in millimetres, 4
    for the clock.

    Examples
    --------
    >>> encode(1234, 2), encode([5432], 3), encode(16_000_000, 4)
    (b'CB', b'1Dh', b'm2@0')
    """
    characters = arrays.whole(characters, "characters", most=8)
    numbers = arrays.indices(values, "values").reshape(-1)
    if ((numbers < 0) | (numbers >= 64**characters)).any():
        raise ValueError(f"values must fit into {characters} characters, 0 to {64**characters - 1}")
    shifts = 6 * np.arange(characters - 1, -1, -1)
    return ((numbers[:, None] >> shifts & 63) + ZERO).astype(np.uint8).tobytes()


def decode(text: bytes, characters: int) -> NDArray[np.int64]:
    """The numbers that `encode` wrote, `(n,)`.

    Raises
    ------
    SensorError
        For a length that is no multiple of `characters`, or a character outside "0" to "o".

    Examples
    --------
    >>> decode(b"CB1D", 2)
    array([1234,   84])
    """
    characters = arrays.whole(characters, "characters", most=8)
    if len(arrays.instance(text, "text", bytes)) % characters:
        raise SensorError(f"{len(text)} characters do not divide into numbers of {characters}")
    digits = np.frombuffer(text, np.uint8).astype(np.int64) - ZERO
    if ((digits < 0) | (digits > 63)).any():
        raise SensorError(f"characters outside '0' to 'o' in {text[:20]!r}")
    weights = 64 ** np.arange(characters - 1, -1, -1)
    return np.asarray(digits.reshape(-1, characters) @ weights)


def checksum(text: bytes) -> bytes:
    """The character that closes a line of SCIP 2.0.

    Examples
    --------
    >>> checksum(b"00"), checksum(b"URG")
    (b'P', b'^')
    """
    return bytes([(sum(arrays.instance(text, "text", bytes)) & 63) + ZERO])


def strip_sum(line: bytes) -> bytes:
    """A line without its last character, which must be its check sum."""
    if len(line) < 2 or checksum(line[:-1]) != line[-1:]:
        raise SensorError(f"the check sum of the line {line[:40]!r} is wrong: bytes were lost")
    return line[:-1]


# --------------------------------------------------------------------------- requests
class ScanRequest(NamedTuple):
    """A request for a stream of scans, one a turn: MD, which switches the laser on itself."""

    first: int
    last: int
    #: Scans of the stream; 0 goes on until QT.
    scans: int = 0

    @property
    def text(self) -> str:
        """The text that is sent, without its end of line: each step by itself, no turn left out.

        Examples
        --------
        >>> ScanRequest(44, 725, 3).text
        'MD0044072501003'
        """
        return f"MD{self.first:04}{self.last:04}010{self.scans:02}"

    @property
    def steps(self) -> int:
        """Steps from the first to the last."""
        return self.last - self.first + 1

    @property
    def size(self) -> int:
        """Bytes of the answer, echo and ends of lines included."""
        data = self.steps * CHARACTERS
        return len(self.text) + 1 + 4 + 6 + data + 2 * -(-data // BLOCK_CHARACTERS) + 1


def parse_request(text: str) -> ScanRequest:
    """Read the text of a request for scans.

    Examples
    --------
    >>> parse_request("MD0044072501000").last
    725
    """
    match = _SCAN.fullmatch(text)
    if match is None:
        raise SensorError(f"{text[:20]!r} is no request for scans, as MD0044072501000 is")
    return ScanRequest(*map(int, match.groups()))


# ---------------------------------------------------------------------------- replies
class Reply(NamedTuple):
    """A reply: the echoed command, its status, and the lines after it."""

    echo: str
    status: str
    body: tuple[bytes, ...]


class Measurement(NamedTuple):
    """One turn as the sensor sends it: clock in ms, distances in mm or error codes, `(n,)`."""

    clock: int
    millimetres: NDArray[np.int64]


def encode_reply(echo: str, status: str, body: Iterable[bytes] = (), *, old: bool = False) -> bytes:
    r"""A whole reply, its empty line included; that of SCIP 1.1 has no check sums.

    Examples
    --------
    >>> encode_reply("QT", "00"), encode_reply("L1", "0", old=True)
    (b'QT\n00P\n\n', b'L1\n0\n\n')
    """
    code = status.encode("ascii")
    return b"\n".join([echo.encode(), code if old else code + checksum(code), *body, b"", b""])


def parse_reply(lines: Sequence[bytes]) -> Reply:
    """A reply of SCIP 2.0, from its echo to the line before the empty one.

    Examples
    --------
    >>> parse_reply([b"QT", b"00P"])
    Reply(echo='QT', status='00', body=())
    """
    if len(lines) < 2:
        raise SensorError(f"a reply of {len(lines)} lines: expected an echo and a status")
    status = strip_sum(lines[1]).decode("ascii", "replace")
    if not _STATUS.fullmatch(status):
        raise SensorError(f"{lines[1][:20]!r} is no status: expected two characters and a sum")
    return Reply(lines[0].decode("ascii", "replace"), status, tuple(lines[2:]))


def refusal(command: str, status: str) -> str:
    """What an error says of a status that is no success."""
    faulty = status.isdigit() and 50 <= int(status) < 98
    meant = STATUS.get(status, _FAULTY if faulty else "the sensor refused")
    return f"status {status} to {command}: {meant}"


def encode_info(info: dict[str, str]) -> list[bytes]:
    """Lines of information with their sums, which leave the semicolon out.

    Examples
    --------
    >>> encode_info({"DMIN": "20"})
    [b'DMIN:20;4']
    """
    lines = [f"{key}:{text}".encode("ascii") for key, text in info.items()]
    return [line + b";" + checksum(line) for line in lines]


def parse_info(body: Sequence[bytes], *, strict: bool = False) -> dict[str, str]:
    """Lines `KEY:text;sum` of VV, PP and II, by key.

    Strict refuses wrong sums and lines without a key, which some firmware sends with VV.

    Examples
    --------
    >>> parse_info([b"DMIN:20;4", b"SERI:H0706400;F"])
    {'DMIN': '20', 'SERI': 'H0706400'}
    """
    info = {}
    for line in body:
        text, end, total = line.rpartition(b";")
        key, colon, value = text.partition(b":") if end else line.partition(b":")
        # No sum sees the upper two bits of a byte; in a capital they make what no text has.
        is_text = text.isascii() and text.decode("ascii").isprintable()
        if strict and not (end and colon and total == checksum(text) and is_text):
            raise SensorError(
                f"{line[:40]!r} is no line of information with its sum, KEY:text;sum: ask again"
            )
        if colon:
            info[key.decode("ascii", "replace")] = value.decode("ascii", "replace")
    return info


def encode_scan(clock: int, millimetres: ArrayLike, characters: int) -> list[bytes]:
    """Lines of a scan after its status: the clock, which wraps, then blocks, each with its sum.

    Two characters cut distances at 4095 mm.

    Examples
    --------
    >>> encode_scan(6968830, [392, 381], 3)
    [b'JUGnD', b'06805m`']
    """
    data = encode(np.minimum(millimetres, 64**characters - 1), characters)
    lines = [encode(clock % CLOCK_WRAP_MS, 4), *blocks(data)]
    return [line + checksum(line) for line in lines]


def blocks(data: bytes) -> list[bytes]:
    """Data characters cut into blocks."""
    return [data[i : i + BLOCK_CHARACTERS] for i in range(0, len(data), BLOCK_CHARACTERS)]


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
    characters = arrays.whole(characters, "characters", most=8)
    lines = list(body) if arrays.is_iterable(body) else []
    if not arrays.is_iterable(body) or not all(isinstance(line, bytes) for line in lines):
        raise ValueError("body must be lines of bytes, one after the other")
    if not lines:
        raise SensorError("a scan without a time stamp")
    clock = decode(strip_sum(lines[0]), 4)
    if len(clock) != 1:
        raise SensorError(f"{lines[0][:20]!r} is no time stamp: expected four characters and a sum")
    data = [strip_sum(line) for line in lines[1:]]
    if (
        any(len(block) != BLOCK_CHARACTERS for block in data[:-1])
        or len(b"".join(data[-1:])) > BLOCK_CHARACTERS
    ):
        raise SensorError(
            f"a block without its {BLOCK_CHARACTERS} characters: the end of a line was lost"
        )
    return Measurement(int(clock[0]), decode(b"".join(data), characters))
