"""Exercises of the chapters on the sensor: its characters and its clock."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from segmap.arrays import Array
from segmap.hokuyo import decode

from ._exercise import Exercise
from .draws import scans as draws_scans


# ------------------------------------------------------------------------- the sensor
def _joined(lines: list[bytes]) -> bytes:
    return b"".join(line[:-1] for line in lines)


def _digits(text: bytes) -> Array:
    return np.frombuffer(text, np.uint8).astype(float).reshape(-1, 3) - 0x30


def _sums_kept(lines: list[bytes]) -> Array:
    text = b"".join(lines)
    return decode(text[: len(text) // 3 * 3], 3).astype(float)


check_distances = Exercise(
    "distances(lines) -> (n,) millimetres; lines: list of bytes, each a block of characters and "
    "its sum; three characters a distance, of six bits each, most significant first, from '0' on",
    lambda lines: decode(_joined(lines), 3).astype(float),
    {
        "one block": ([draws_scans.with_sum(b"06805m1Dh")],),
        "a distance that crosses a border": (
            [draws_scans.with_sum(b"06805m1D"), draws_scans.with_sum(b"h000007")],
        ),
        "no block": ([],),
    },
    {
        "the first character is the most significant one": (
            lambda lines: _digits(_joined(lines)) @ (1, 64, 4096)
        ),
        "the character '0' stands for 0: take 0x30 from each": (
            lambda lines: decode(_joined(lines), 3) + 0x30 * 4161
        ),
        "the last character of each block is its sum, no part of a number": _sums_kept,
        "a block need not hold whole numbers: join the blocks, then decode": (
            lambda lines: [d for line in lines for d in decode(line[:-1][:6], 3)]
        ),
        "a character carries six bits: the parts count 4096, 64 and 1, not 65536, 256 and 1": (
            lambda lines: _digits(_joined(lines)) @ (65536, 256, 1)
        ),
        "millimetres are asked for, not metres": (lambda lines: decode(_joined(lines), 3) / 1000),
    },
    draw=draws_scans.distances,
    own=(decode,),
)


def _unwrapped(stamps: ArrayLike, wrap: float = draws_scans.WRAP) -> Array:
    return np.append(0, np.cumsum(np.diff(np.asarray(stamps, float)) % wrap)) / 1000


check_unwrapped = Exercise(
    "unwrapped(stamps) -> (n,) seconds since the first; stamps (n,) in milliseconds, which start "
    "again at 0 after 2 ** 24 - 1",
    _unwrapped,
    {
        "three turns": (np.array([500, 600, 800]),),
        "a clock that wraps": (np.array([draws_scans.WRAP - 150, draws_scans.WRAP - 50, 50, 150]),),
        "a clock that wraps twice": (np.array([draws_scans.WRAP - 1, 8_000_000, 16_000_000, 99]),),
    },
    {
        "after 2 ** 24 - 1 comes 0, not a time before": lambda s: (s - s[0]) / 1000,
        "it may wrap more than once: add up the steps from stamp to stamp": (
            lambda s: (s - s[0]) % draws_scans.WRAP / 1000
        ),
        "from 2 ** 24 - 1 to 0 is one millisecond: there are 2 ** 24 values": (
            lambda s: _unwrapped(s, draws_scans.WRAP - 1)
        ),
        "stamps are milliseconds, not seconds": lambda s: 1000 * _unwrapped(s),
        "time counts from the first stamp: subtract it": (lambda s: _unwrapped(s) + s[0] / 1000),
        "after the clock has started again all later stamps are later, not this one alone": (
            lambda s: (s - s[0] + draws_scans.WRAP * (np.diff(s, prepend=s[0]) < 0)) / 1000
        ),
    },
    draw=draws_scans.unwrapped,
)
