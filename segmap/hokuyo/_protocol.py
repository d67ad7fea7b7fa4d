"""The bytes on the serial line: numbers as characters, check sums, requests, and whole replies.

Pure functions of SCIP 1.1 and 2.0, for the driver and for the emulator.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays

#: Characters lie from "0" on, six bits each.
ZERO = 0x30
#: A clock of four characters wraps after so many milliseconds: 4 h 39 min 37 s.
CLOCK = 1 << 24
#: Data characters in a block.
BLOCK = 64
#: Characters of a distance, by command.
CHARACTERS = {"GD": 3, "MD": 3, "GS": 2, "MS": 2}

_SCAN = re.compile(r"(?:(G[DS])|(M[DS]))([0-9]{4})([0-9]{4})([0-9]{2})(?(2)([0-9])([0-9]{2}))")


class SensorError(RuntimeError):
    """A laser that is lost, is busy or breaks its protocol; the text says what to do about it."""


def encode(values: ArrayLike, characters: int) -> bytes:
    """Whole numbers as characters, the same count for each, most significant first.

    Parameters
    ----------
    values : (n,) or () int array, 0 to 64 ** characters - 1
    characters : int
        2 or 3 for distances in millimetres, 4 for the clock.

    Returns
    -------
    bytes
        `n * characters` of them.

    Raises
    ------
    ValueError
        For a number that does not fit.

    Examples
    --------
    >>> encode(1234, 2), encode([5432], 3), encode(16_000_000, 4)
    (b'CB', b'1Dh', b'm2@0')
    """
    arrays.whole(characters, "characters", most=8)
    numbers = arrays.indices(values, "values").reshape(-1)
    if ((numbers < 0) | (numbers >= 64**characters)).any():
        raise ValueError(f"values must fit into {characters} characters, 0 to {64**characters - 1}")
    shifts = 6 * np.arange(characters - 1, -1, -1)
    return ((numbers[:, None] >> shifts & 63) + ZERO).astype(np.uint8).tobytes()


def decode(text: bytes, characters: int) -> NDArray[np.int64]:
    """The numbers that `encode` wrote.

    Parameters
    ----------
    text : bytes
    characters : int

    Returns
    -------
    (n,) int array

    Raises
    ------
    SensorError
        For a length that is no multiple of `characters`, or a character outside "0" to "o".

    Examples
    --------
    >>> decode(b"CB1D", 2)
    array([1234,   84])
    """
    arrays.whole(characters, "characters", most=8)
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


def unchecked(line: bytes) -> bytes:
    """A line without its last character, which must be its check sum.

    Raises
    ------
    SensorError

    Examples
    --------
    >>> unchecked(b"00P")
    b'00'
    """
    if len(line) < 2 or checksum(line[:-1]) != line[-1:]:
        raise SensorError(f"the check sum of the line {line[:40]!r} is wrong: bytes were lost")
    return line[:-1]


def is_text(line: bytes) -> bool:
    """No sum sees the upper two bits of a byte; in a capital they make what no text has."""
    return line.isascii() and line.decode("ascii").isprintable()


class ScanRequest(NamedTuple):
    """A request for scans.

    Attributes
    ----------
    kind : str
        GD or GS for the latest turn, MD or MS for a stream; with D distances take three characters,
        with S two.
    first, last : int
        Steps.
    cluster : int
        So many neighbours are reported as the nearest of them.
    skip : int
        So many turns are left out after each.
    scans : int
        Scans of a stream; 0 goes on until QT.
    """

    kind: str
    first: int
    last: int
    cluster: int = 1
    skip: int = 0
    scans: int = 0

    @property
    def text(self) -> str:
        """The text that is sent, without its end of line.

        Examples
        --------
        >>> ScanRequest("GD", 44, 725).text, ScanRequest("MS", 44, 725, 1, 0, 3).text
        ('GD0044072501', 'MS0044072501003')
        """
        steps = f"{self.kind}{self.first:04}{self.last:04}{self.cluster:02}"
        return f"{steps}{self.skip}{self.scans:02}" if self.streams else steps

    def check(self) -> None:
        """Raise a ValueError where a number does not fit into its field."""
        arrays.one_of(self.kind, "kind", CHARACTERS)
        widths = {"first": 4, "last": 4, "cluster": 2, "skip": 1, "scans": 2}
        for name, width in widths.items():
            arrays.whole(getattr(self, name), name, least=0, most=10**width - 1)

    @property
    def streams(self) -> bool:
        """Whether the answer is a stream of scans, and not the latest one."""
        return self.kind[0] == "M"

    @property
    def beams(self) -> int:
        """Distances in the answer; the last cluster may be a smaller one."""
        return -(-self.steps // max(self.cluster, 1))

    @property
    def steps(self) -> int:
        """Steps from the first to the last."""
        return self.last - self.first + 1

    @property
    def size(self) -> int:
        """Bytes of the answer, echo and ends of lines included."""
        data = self.beams * CHARACTERS[self.kind]
        return len(self.text) + 1 + 4 + 6 + data + 2 * -(-data // BLOCK) + 1


def parse_request(text: str) -> ScanRequest:
    """Read the text of a request for scans.

    Raises
    ------
    SensorError

    Examples
    --------
    >>> parse_request("GD0044072501").last
    725
    """
    found = _SCAN.fullmatch(arrays.instance(text, "text", str))
    if found is None:
        raise SensorError(f"{text[:20]!r} is no request for scans, as GD0044072501 is")
    single, stream, *numbers = found.groups()
    return ScanRequest(single or stream, *(int(number or 0) for number in numbers))


def encode_scan(clock: int, millimetres: ArrayLike, characters: int) -> list[bytes]:
    """Lines of a scan after its status: the clock, then blocks, each with its sum.

    Parameters
    ----------
    clock : int, milliseconds
        Wraps after 24 bits.
    millimetres : (n,) int array
    characters : int
        2 cuts distances at 4095 mm.

    Examples
    --------
    >>> encode_scan(6968830, [392, 381], 3)
    [b'JUGnD', b'06805m`']
    """
    arrays.whole(clock, "clock", least=0)
    arrays.whole(characters, "characters", most=8)
    met = np.minimum(arrays.indices(millimetres, "millimetres"), 64**characters - 1)
    data = encode(met, characters)
    blocks = [data[i : i + BLOCK] for i in range(0, len(data), BLOCK)]
    return [line + checksum(line) for line in (encode(clock % 64**4, 4), *blocks)]


def encode_reply(echo: str, status: str, body: Iterable[bytes] = ()) -> bytes:
    r"""A whole reply of SCIP 2.0, its empty line included.

    Examples
    --------
    >>> encode_reply("BM", "02")
    b'BM\n02R\n\n'
    """
    told = ascii_bytes(status, "status")
    return b"\n".join(
        [ascii_bytes(echo, "echo"), told + checksum(told), *byte_lines(body), b"", b""]
    )


def encode_reply_1(echo: str, status: str, body: Iterable[bytes] = ()) -> bytes:
    r"""A whole reply of SCIP 1.1: one character of status, no sums.

    Examples
    --------
    >>> encode_reply_1("L1", "0")
    b'L1\n0\n\n'
    """
    told = ascii_bytes(status, "status")
    return b"\n".join([ascii_bytes(echo, "echo"), told, *byte_lines(body), b"", b""])


def parse_scan_1(lines: Iterable[bytes]) -> NDArray[np.int64]:
    """Distances in millimetres of SCIP 1.1's G: two characters each, no sums, no clock.

    Raises
    ------
    SensorError
    """
    return decode(b"".join(byte_lines(lines, "lines")), 2)


def ascii_bytes(text: str, name: str) -> bytes:
    """A word or a text as bytes; the sensor knows no letters but those of ASCII."""
    if not arrays.instance(text, name, str).isascii():
        raise ValueError(f"{name} must be in ASCII, got {text[:20]!r}")
    return text.encode("ascii")


def byte_lines(value: Iterable[bytes], name: str = "body") -> list[bytes]:
    """Lines of a reply, as a list.

    Examples
    --------
    >>> byte_lines(b"JUGnD")
    Traceback (most recent call last):
    ValueError: body must be lines of bytes, one after the other
    """
    lines = list(value) if isinstance(value, Iterable) else [value]
    if not all(isinstance(line, bytes) for line in lines):
        raise ValueError(f"{name} must be lines of bytes, one after the other")
    return lines
