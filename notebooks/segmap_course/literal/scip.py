"""What a Hokuyo sends by SCIP 2.0: sums, numbers of six bits a character, blocks, directions."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi


def sum_of(text: bytes) -> int:
    """The character that closes a line: the sum of its bytes, cut to six bits, from '0' on.

    Examples
    --------
    >>> chr(sum_of(b"00"))
    'P'
    """
    return (sum(text) & 63) + ord("0")


def without_sum(line: bytes) -> bytes:
    """A line without its last character; an error where that is not its sum.

    Examples
    --------
    >>> without_sum(b"00P")
    b'00'
    """
    if not line or line[-1] != sum_of(line[:-1]):
        raise ValueError(f"the sum of {line!r} is wrong")
    return line[:-1]


def number_of(characters: bytes) -> int:
    """A number of six bits a character, the most significant first, from '0' on.

    Examples
    --------
    >>> number_of(b"1Dh"), number_of(b"m2@0")
    (5432, 16000000)
    """
    number = 0
    for character in characters:
        digit = character - ord("0")
        if not 0 <= digit < 64:
            raise ValueError(f"{characters!r} is no number")
        number = 64 * number + digit
    return number


def distances_of(blocks: Iterable[bytes]) -> list[int]:
    """Millimetres of a scan: sums are checked, blocks joined, then three characters a number.

    Examples
    --------
    >>> distances_of([b"06805m`"])
    [392, 381]
    """
    text = b"".join(without_sum(block) for block in blocks)
    return [number_of(text[k : k + 3]) for k in range(0, len(text), 3)]


def direction_of(beam: int, first: int = 44, front: int = 384, steps: int = 1024) -> float:
    """Where the beam of a number looks, radians, to the left; the beam of step `front` is ahead.

    Examples
    --------
    >>> direction_of(340)
    0.0
    """
    return (first + beam - front) * 2 * pi / steps
