"""Exercises of the chapters on the laser: characters to distances, stamps to seconds."""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..hokuyo import checksum, decode
from ._exercise import Case, Exercise, Mistake

#: The sensor's clock, milliseconds, starts again here.
WRAP = 1 << 24


def _digits(text: bytes) -> Array:
    return np.frombuffer(text, np.uint8).astype(float).reshape(-1, 3) - 0x30


def _distances(lines: list[bytes]) -> Array:
    return decode(b"".join(line[:-1] for line in lines), 3).astype(float)


def _with_sum(text: bytes) -> bytes:
    return text + checksum(text)


_ONE = [_with_sum(b"06805m1Dh")]
_TWO = [_with_sum(b"06805m1D"), _with_sum(b"h000007")]

check_distances = Exercise(
    "distances",
    "distances(lines) -> (n,) millimetres; lines: list of bytes, each a block of characters and "
    "its sum; three characters a distance, of six bits each, most significant first, from '0' on",
    _distances,
    (
        Case("one block", (_ONE,)),
        Case("a distance that crosses a border", (_TWO,)),
        Case("no block", ([],)),
    ),
    (
        Mistake(
            "reversed",
            lambda lines: _digits(b"".join(line[:-1] for line in lines)) @ (1, 64, 4096),
            "the first character is the most significant one",
        ),
        Mistake(
            "ASCII",
            lambda lines: decode(b"".join(line[:-1] for line in lines), 3) + 0x30 * 4161,
            "the character '0' stands for 0: take 0x30 from each",
        ),
        Mistake(
            "sums kept",
            lambda lines: (
                decode(joined[: len(joined) // 3 * 3], 3) if (joined := b"".join(lines)) else []
            ),
            "the last character of each block is its sum, no part of a number",
        ),
        Mistake(
            "block by block",
            lambda lines: [d for line in lines for d in decode(line[:-1][:6], 3)],
            "a block need not hold whole numbers: join the blocks, then decode",
        ),
    ),
)


def unwrapped(stamps: ArrayLike) -> Array:
    """Seconds since the first of some stamps of the sensor's clock.

    Parameters
    ----------
    stamps : (n,) int array, milliseconds
        They wrap at 2 ** 24; no two in a row are farther apart than that.

    Returns
    -------
    (n,) array, seconds

    Examples
    --------
    >>> unwrapped([16777116, 16777216 - 16777216, 100])
    array([0. , 0.1, 0.2])
    """
    given = np.asarray(stamps, np.int64)
    return np.concatenate([[0.0], np.cumsum(np.diff(given) % WRAP)])[: len(given)] / 1000


def _since_first(stamps: ArrayLike) -> Array:
    given = np.asarray(stamps, float)
    return (given - given[:1]) / 1000


check_unwrapped = Exercise(
    "unwrapped",
    "unwrapped(stamps) -> (n,) seconds since the first; stamps (n,) in milliseconds, which start "
    "again at 0 after 2 ** 24 - 1",
    unwrapped,
    (
        Case("three turns", (np.array([500, 600, 800]),)),
        Case("a clock that wraps", (np.array([WRAP - 150, WRAP - 50, 50, 150]),)),
        Case("a clock that wraps twice", (np.array([WRAP - 1, 8_000_000, 16_000_000, 99]),)),
    ),
    (
        Mistake("never wraps", _since_first, "after 2 ** 24 - 1 comes 0, not a time before"),
        Mistake(
            "one wrap only",
            lambda s: (np.asarray(s) - s[0]) % WRAP / 1000,
            "it may wrap more than once: add up the steps from stamp to stamp",
        ),
        Mistake(
            "wraps a millisecond early",
            lambda s: np.append(0, np.cumsum(np.diff(np.asarray(s, float)) % (WRAP - 1))) / 1000,
            "from 2 ** 24 - 1 to 0 is one millisecond: there are 2 ** 24 values",
        ),
        Mistake(
            "milliseconds", lambda s: 1000 * unwrapped(s), "stamps are milliseconds, not seconds"
        ),
    ),
)
