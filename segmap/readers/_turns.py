"""Beams in a row, of a sensor that turns, cut into scans."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..arrays import LIMIT, Array
from ..scans import LaserScan
from ._lines import Lines, is_number

#: A beam points nowhere beyond two turns, radians.
MOST_TURN = 4 * np.pi
#: No scan has more beams.
MOST_BEAMS = 100_000
#: What a line says of one beam: angle in radians, range in metres, time in seconds, number of the
#: scan; the last two NaN where the line has none.
Beam = tuple[float, float, float, float]


def number(field: str, what: str, factor: float = 1.0) -> float:
    """A field as a finite number, times the factor that makes metres or radians of it."""
    found = float(field) * factor if is_number(field) else np.nan
    if not abs(found) <= LIMIT:
        raise ValueError(f"expected a number for {what}, got {field[:40]!r}")
    return found


def angle(field: str, factor: float) -> float:
    """A direction in radians, within two turns."""
    found = number(field, "the angle", factor)
    if not abs(found) <= MOST_TURN:
        raise ValueError(f"expected an angle within two turns, got {field[:40]!r}")
    return found


def distance(field: str, factor: float) -> float:
    """A range in metres; `inf` as it stands, NaN for nothing measured: an empty field, nan, 0."""
    if field.lower() in ("", "nan", "-nan", "null", "none"):
        return np.nan
    if field.lower() in ("inf", "+inf", "infinity"):
        return np.inf
    found = number(field, "the range", factor)
    return found if found > 0 else np.nan


def to_scans(beams: Sequence[Beam], lines: Lines, *, clockwise: bool = False) -> list[LaserScan]:
    """Scans of beams in the order of the file; those of a clockwise sensor are turned round.

    A scan ends where its number changes; without numbers, where the angle wraps. Its time is that
    of its first beam, or its place in the log.
    """
    table = np.array(beams)
    parts = np.split(table, _starts(table))
    if max(map(len, parts)) > MOST_BEAMS:
        raise lines.error(f"expected at most {MOST_BEAMS} beams in a scan: where does one end?")
    return [_scan(part, k, clockwise) for k, part in enumerate(parts)]


def _starts(table: Array) -> NDArray[np.intp]:
    """Where scans begin, but for the first: `(m,)`, indices."""
    angles, scans = table[:, 0], table[:, 3]
    if np.isfinite(scans).all():
        return np.flatnonzero(np.diff(scans)) + 1
    steps = np.diff(angles)
    onwards = 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0
    wrap = min(np.ptp(angles) / 2, np.pi)
    return np.flatnonzero(-onwards * steps > wrap) + 1


def _scan(part: Array, place: int, clockwise: bool) -> LaserScan:
    when = place if np.isnan(part[0, 2]) else part[0, 2]
    if clockwise:
        part = part[::-1] * (-1, 1, 1, 1)
    return LaserScan(part[:, 1], part[:, 0], when)
