"""What is said on the line: requests of the host, and the replies that a sensor makes of them."""

import re
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ._coding import SensorError, checksum, encode

#: Data characters in a block.
BLOCK = 64
#: Characters of a distance, by command.
CHARACTERS = {"GD": 3, "MD": 3, "GS": 2, "MS": 2}

_SCAN = re.compile(r"(?:(G[DS])|(M[DS]))([0-9]{4})([0-9]{4})([0-9]{2})(?(2)([0-9])([0-9]{2}))")


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
        """As it is sent, without its end of line.

        Examples
        --------
        >>> ScanRequest("GD", 44, 725).text, ScanRequest("MS", 44, 725, 1, 0, 3).text
        ('GD0044072501', 'MS0044072501003')
        """
        steps = f"{self.kind}{self.first:04}{self.last:04}{self.cluster:02}"
        return f"{steps}{self.skip}{self.scans:02}" if self.kind[0] == "M" else steps

    def check(self) -> None:
        """See that every number fits into its field.

        Raises
        ------
        ValueError
        """
        widths = {"first": 4, "last": 4, "cluster": 2, "skip": 1, "scans": 2}
        for name, width in widths.items():
            if not 0 <= getattr(self, name) < 10**width:
                raise ValueError(f"{name} must be 0 to {10**width - 1}, got {getattr(self, name)}")

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
    """The request for scans that a text is.

    Raises
    ------
    SensorError

    Examples
    --------
    >>> parse_request("GD0044072501").last
    725
    """
    found = _SCAN.fullmatch(text)
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
    data = encode(np.minimum(millimetres, 64**characters - 1), characters)
    blocks = [data[i : i + BLOCK] for i in range(0, len(data), BLOCK)]
    return [line + checksum(line) for line in (encode(clock % 64**4, 4), *blocks)]


def encode_reply(echo: str, status: str, body: Iterable[bytes] = ()) -> bytes:
    r"""A whole reply of SCIP 2.0, its empty line included.

    Examples
    --------
    >>> encode_reply("BM", "02")
    b'BM\n02R\n\n'
    """
    lines = [echo.encode("ascii"), status.encode("ascii") + checksum(status.encode("ascii")), *body]
    return b"\n".join([*lines, b"", b""])


def encode_reply_1(echo: str, status: str, body: Iterable[bytes] = ()) -> bytes:
    r"""A whole reply of SCIP 1.1: one character of status, no sums.

    Examples
    --------
    >>> encode_reply_1("L1", "0")
    b'L1\n0\n\n'
    """
    return b"\n".join([echo.encode("ascii"), status.encode("ascii"), *body, b"", b""])
