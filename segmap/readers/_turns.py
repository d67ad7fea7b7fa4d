"""Formats of a beam a line, of a sensor that turns: beams in a row, cut into scans."""

from __future__ import annotations

import numpy as np

from ..arrays import LIMIT
from ..scans import LaserScan, Log
from ._lines import is_number
from ._text import TextFormat

#: A beam points nowhere beyond two turns, radians.
MOST_DIRECTION_RAD = 4 * np.pi
#: No scan has more beams.
MOST_BEAMS_READ = 100_000
#: Said of a log whose file does not say which way angles grow.
COUNTERCLOCKWISE = "beams counter-clockwise"
#: What a line says of one beam: angle, range, time, number of the scan; the last two NaN where the
#: line has none.
Beam = tuple[float, float, float, float]


class Beams(TextFormat):
    """A format whose lines are beams, in the order in which they were measured.

    A scan ends where its number changes; without numbers, where the angle wraps. Its time is that
    of its first beam, where the lines have any; each beam keeps its own. Scans of a clockwise
    sensor are turned round.
    """

    clockwise = True
    #: What the lines leave unsaid.
    assumed: tuple[str, ...] = ()

    def _log(self, name: str) -> Log:
        table = np.array(self.scans)
        angles, numbers = table[:, 0], table[:, 3]
        if np.isfinite(numbers).all():
            ends = np.diff(numbers) != 0
        else:
            steps = np.diff(angles)
            onwards = 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0
            ends = -onwards * steps > min(np.ptp(angles) / 2, np.pi)
            self.assumed += ("a scan ends where the angle wraps",) * bool(ends.any())
        parts = np.split(table, np.flatnonzero(ends) + 1)
        if max(map(len, parts)) > MOST_BEAMS_READ:
            raise self.lines.error(
                f"expected at most {MOST_BEAMS_READ} beams in a scan: where does one end?"
            )
        scans = []
        for part in parts:
            angles, ranges, times, _ = part.T
            time, delays = times[0], None
            if self.clockwise:
                angles, ranges, times = -angles[::-1], ranges[::-1], times[::-1]
            if np.ptp(times) > 0:  # neither unknown nor one time for all
                time, delays = times.min(), times - times.min()
            scans.append(LaserScan(ranges, angles, time, delays=delays))
        return Log(name, scans, None, self.lines.skipped, assumed=self.assumed)


def number_field(field: str, what: str, factor: float = 1.0) -> float:
    """A field as a finite number, times the factor that makes metres or radians of it."""
    found = float(field) * factor if is_number(field) else np.nan
    if not abs(found) <= LIMIT:
        raise ValueError(f"expected a number for {what}, got {field[:40]!r}")
    return found


def direction_field(field: str, factor: float) -> float:
    """A direction in radians, within two turns."""
    found = number_field(field, "the angle", factor)
    if not abs(found) <= MOST_DIRECTION_RAD:
        raise ValueError(f"expected an angle within two turns, got {field[:40]!r}")
    return found


def distance(field: str, factor: float) -> float:
    """A range in metres; `inf` as it stands, NaN for nothing measured: an empty field, nan, 0."""
    if field.lower() in ("", "nan", "-nan", "null", "none"):
        return np.nan
    if field.lower() in ("inf", "+inf", "infinity"):
        return np.inf
    found = number_field(field, "the range", factor)
    return found if found > 0 else np.nan
