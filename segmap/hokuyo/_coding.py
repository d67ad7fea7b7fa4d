"""SCIP's coding of numbers as characters, and its check sums. Pure functions."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Characters lie from "0" on, six bits each.
ZERO = 0x30
#: A clock of four characters wraps after so many milliseconds: 4 h 39 min 37 s.
CLOCK = 1 << 24


class SensorError(RuntimeError):
    """A laser that is lost, busy or says something else than its protocol: what to do about it."""


def encode(values: ArrayLike, characters: int) -> bytes:
    """Whole numbers as so many characters each, most significant first.

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
    numbers = np.atleast_1d(np.asarray(values, np.int64))
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
    if len(text) % characters:
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
    return bytes([(sum(text) & 63) + ZERO])


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
