"""Lines of numbers in a fixed order, without words: of CoreSLAM, Rawseeds, and a Hokuyo's beams.

CoreSLAM (Mines ParisTech), a Hokuyo URG-04LX on a robot with two wheels: a header, then ranges in
millimetres. What most lines of a file have decides: 24 fields and 683 ranges (`test_lab2`, `exp1`),
or 13 and 682 (`test_lab`); a line of another length is damaged. The time is in microseconds; of the
ticks of the wheels since the start the right ones count backwards with 13 fields, as CoreSLAM's own
programs take them. Wheels that stand at zero in the whole file mean that there is no odometry.
Between two lines the robot is taken to drive an exact arc; the odometry starts at 0, 0, 0.

Rawseeds, the file of one laser, comma-separated, metres and seconds:

    t, count, offset [quarter degrees], ranges          a SICK, its beams as in `half_turn`
    t, 681 ranges                                       a Hokuyo

A Hokuyo's readings as text, a scan a file, a beam a line: millimetres, then radians. Here nothing
says how far the sensor sees or how fast it turns, and there are no times.

Values of a Hokuyo below 20 mm are error codes, see `error_codes`. There is no truth.

Assumed: a Hokuyo is a URG-04LX; its beams are 360/1024 degree apart, the middle one straight ahead,
and it turns in 0.1 s, which gives each beam its time. Of CoreSLAM, since its programs have it so: a
wheel of 77 mm radius makes 2000 ticks a turn, the wheels are 330 mm apart, the laser sits 145 mm
ahead of their axle. Of Rawseeds: a laser sits at the robot's centre, rear ones face backwards.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...arrays import LIMIT, Array
from ...poses import compose
from ...scans import LaserScan, Log
from ...scans.error_codes import LOWEST, as_ranges
from .._lines import MOST_DIRECTION_RAD, Lines, LogError, float_fields, is_number, time
from .._raw_scans import (
    COUNTERCLOCKWISE,
    NOWHERE,
    URG_ASSUMED,
    URG_REACH,
    URG_STEP,
    Extrinsic,
    RawScan,
    centred,
    half_turn,
    uncorrected,
    urg_delays,
    view_of,
)
from .._text import TextFormat, by_names
from ._columns import LEAST_VIEW_RAD, TELLING_ROWS, Columns, named, with_units_told
from ._fields import LEADING, decimal
from ._layout import Beams, Layout
from ._numbers import guessed
from ._table import MOST_BEAMS_READ
from ._wide import (
    LEAST_BARE_BEAMS,
    LEAST_BEAMS,
    URG_BEAMS,
    VIEWS_DEG,
    first_fields,
    unit_of_ranges,
    usual_view,
    with_head,
)

#: Lines of CoreSLAM by the number of their fields, and the sign of the right wheel.
CORESLAM_LINES = {
    707: ("time - left right -*20 ranges*683", 1),
    695: ("time left right -*10 ranges*682", -1),
}
METRES_PER_TICK = 2 * np.pi * 0.077 / 2000
WHEEL_SEPARATION = 0.330
#: More ticks than this no wheel turns.
MOST_TICKS = 1e12
#: What the files do not say of the robot.
CORESLAM_ASSUMED = (
    "wheels of 77 mm radius, 2000 ticks a turn, 330 mm apart",
    "the laser sits 0.145 m ahead of the robot's centre",
)
#: Fields of a line of a Hokuyo of Rawseeds.
RAWSEEDS_HOKUYO = 682
#: The same of its odometry and of its truth.
RAWSEEDS_POSES = (7, 13)
#: What two numbers a line do not say.
HOKUYO_TEXT_ASSUMED = (
    "ranges in millimetres",
    "angles in radians",
    COUNTERCLOCKWISE,
    "values below 20 are error codes of a URG-04LX",
)
#: So many numbers that rise from line to line are times.
LEAST_TIMES = 5
#: Ranges of two beams side by side mostly differ by less than such a share.
ALIKE_SHARE = 0.1
#: Before the ranges of a line that nobody names stand so many other numbers, if any.
MOST_OTHERS = 3
POSE_NAMES = ["x_m", "y_m", "theta_rad"]
#: Nothing that is measured, nor a time in nanoseconds, is as large.
MOST_MEASURED = 1e30
#: No line begins with more numbers that are no ranges.
MOST_HEAD_NUMBERS = 30
#: Before the ranges of a line of BreezySLAM's examples stand so many numbers, and one behind them.
BREEZY_NUMBERS = 24
TOLD_OF_BREEZY = (
    f"{BREEZY_NUMBERS} numbers before the ranges and one behind them are none, as BreezySLAM's "
    "examples have them: wheels are left out"
)


def urg_scan(laser: str, millimetres: Array, when: float) -> RawScan:
    """A scan of a URG-04LX, whose ranges and codes are `(n,)`."""
    ranges, codes = as_ranges(millimetres)
    angles = centred(len(ranges), URG_STEP)
    turn = codes, urg_delays(angles), (URG_ASSUMED,)
    return RawScan(laser, ranges, angles, when, NOWHERE, NOWHERE, URG_REACH, *turn)


class CoreSlam(TextFormat):
    """A log of CoreSLAM: of the layout that most lines have, the first where none has any."""

    by_shape = True
    name, expected = "CoreSLAM", f"lines of {' or '.join(map(str, CORESLAM_LINES))} numbers"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        counts = Counter(map(len, Lines(lines.path, "skip")))
        self.form, self.sign = CORESLAM_LINES[max(CORESLAM_LINES, key=lambda n: counts[n])]
        self.ticks: list[Array] = []

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        return len(fields) in CORESLAM_LINES and fields[0].isdecimal() and is_number(fields[-1])

    def _take(self, fields: list[str]) -> None:
        said = by_names(self.form, fields)
        wheels = float_fields([*said["left"], *said["right"]], "the ticks of the wheels")
        if not (np.abs(wheels) <= MOST_TICKS).all():
            raise ValueError(f"expected the ticks of the wheels, got {wheels.tolist()}")
        found = float_fields(said["ranges"], "ranges")
        self.scans.append(urg_scan("hokuyo", found, time(said["time"][0], unit=1e-6)))
        self.ticks.append(wheels * (1, self.sign))

    def _finished(self) -> Sequence[RawScan]:
        ticks, scans = np.array(self.ticks), list[RawScan](self.scans)
        if not np.ptp(ticks, axis=0).any() and not ticks.all():
            return scans
        poses = integrate(METRES_PER_TICK * np.diff(ticks, axis=0))
        more = (URG_ASSUMED, *CORESLAM_ASSUMED)
        pairs = zip(scans, poses, strict=True)
        return [scan._replace(odometry=pose, assumed=more) for scan, pose in pairs]

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        return uncorrected(scans, np.array([0.145, 0.0, 0.0]), is_stated=True)


def integrate(driven: Array) -> Array:
    """Poses of the robot, `(k + 1, 3)`, from what its left and right wheel drove, `(k, 2)`.

    Examples
    --------
    >>> integrate(np.array([[0.0, np.pi * 0.330 / 2]])).round(4)  # a quarter turn round the left
    array([[0.    , 0.    , 0.    ],
           [0.165 , 0.165 , 1.5708]])
    """
    left, right = driven.T
    turn = (right - left) / WHEEL_SEPARATION
    chord = (left + right) / 2 * np.sinc(turn / (2 * np.pi))
    steps = np.stack([chord * np.cos(turn / 2), chord * np.sin(turn / 2), turn], -1)
    poses = [np.zeros(3)]
    for step in steps:
        poses.append(compose(poses[-1], step))
    return np.array(poses)


class Rawseeds(TextFormat):
    """The file of one laser; with it odometry and truth, where its folder is read."""

    by_shape = True
    name, separator = "Rawseeds", ","
    expected = "lines of a SICK or Hokuyo file"

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line, split at commas, is one of these files."""
        metres = len(fields) == RAWSEEDS_HOKUYO and any("." in field for field in fields[1:])
        known = metres or len(fields) in RAWSEEDS_POSES
        return is_number(fields[0]) and (
            known or (len(fields) > 1 and fields[1].strip() == str(len(fields) - 3))
        )

    def _take(self, fields: list[str]) -> None:
        fields = [field.strip() for field in fields]
        when = time(fields[0])
        if len(fields) == RAWSEEDS_HOKUYO:
            metres = np.clip(float_fields(fields[1:], "ranges"), -LIMIT, LIMIT)
            self.scans.append(urg_scan("hokuyo", 1000 * metres, when))
            return
        if len(fields) in RAWSEEDS_POSES:
            raise ValueError(
                "holds poses and no scan: read its folder, or the poses by --truth and "
                "read_trajectory"
            )
        said = by_names("time n offset ranges*n", fields)
        (quarters,) = float_fields(said["offset"], "the offset")
        if not abs(quarters) <= 720:
            raise ValueError(f"expected an offset in quarter degrees, got {fields[2][:40]}")
        found = float_fields(said["ranges"], "ranges")
        angles = half_turn(len(found)) + np.radians(quarters / 4)
        self.scans.append(RawScan("sick", found, angles, when))

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        backwards = np.pi if "REAR" in self.lines.path.name.upper() else 0.0
        return uncorrected(scans, np.array([0.0, 0.0, backwards]))


class HokuyoText(TextFormat):
    """One scan."""

    by_shape = True
    name, expected = "Hokuyo text", "lines of range in millimetres and angle in radians"

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        if len(fields) != 2 or not all(map(is_number, fields)):
            return False
        return float(fields[0]) % 1 == 0 and abs(float(fields[1])) <= MOST_DIRECTION_RAD

    @classmethod
    def fits(cls, lines: Sequence[str]) -> bool:
        """Whether the second column goes one way, and the first holds no whole degrees."""
        rows = [found for line in lines if cls.claims(found := line.split())]
        table = np.array(rows, float).reshape(-1, 2)
        steps = np.sign(np.diff(table[:, 1]))
        return abs(steps.sum()) >= 0.8 * np.abs(steps).sum() and guessed(table)[:1] != ("angle",)

    def _take(self, fields: list[str]) -> None:
        beam = float_fields(fields, "range and angle")
        if len(beam) != 2 or abs(beam[0]) > LIMIT or not abs(beam[1]) <= MOST_DIRECTION_RAD:
            raise ValueError(f"expected {self.expected}, got {' '.join(fields)[:80]}")
        if len(self.scans) == MOST_BEAMS_READ:
            raise self.lines.error(
                f"expected one scan, but there are more than {MOST_BEAMS_READ} beams"
            )
        self.scans.append(beam)

    def _log(self, name: str) -> Log:
        millimetres, angles = np.array(self.scans).T
        ranges, codes = as_ranges(millimetres)
        scan = LaserScan(ranges, angles, np.nan, codes=codes)
        return Log(name, [scan], None, self.lines.skipped, assumed=HOKUYO_TEXT_ASSUMED)


# ------------------------------------------------------------------ as many numbers in each line
def bare_of(path: Path) -> Layout | None:
    """The same for lines of nothing but numbers, as many in each: a guess, and a last resort."""
    separator, lines, rows = first_fields(path)
    outer = separator[:1] if separator and len(separator) > 1 else None
    apart = all(LEADING.match(t) or (outer and t.count(outer) == 1) for _, t in lines)
    width = max(map(len, rows), default=0)
    rows = [[*map(decimal, row)] for row in rows]
    whole = [row for row in rows if len(row) == width and all(map(is_number, row))]
    heads = [row for row in rows[:1] if len(row) == width and not any(map(is_number, row))]
    if width < (LEAST_BEAMS if apart else LEAST_BARE_BEAMS) or 2 * len(whole) <= len(rows) or heads:
        return None
    table = np.array(whole, float)
    table[~(np.abs(table) < MOST_MEASURED)] = np.nan  # whose differences are nothing
    first, told, columns = table[:, 0], list[str](), Columns({})
    is_pairs = bool(_pairs_of(table[:, 1:]))
    is_time = is_pairs or ((len(first) >= LEAST_TIMES or apart) and not _begins_with_range(table))
    begin = int(is_time and bool((np.diff(first) > 0).all()))
    if begin:
        columns, told = with_units_told(named(["time"]), np.repeat(table[:, :1], 3, 0))
    if pairs := _pairs_of(table[:, begin:]):
        head = Layout(separator, 0, (*["time"][:begin], *pairs))
        found = with_head(path, head, whole, goes_on=True)
        what = f"lines of numbers are scans{', behind their times' * begin}"
        return found._replace(
            told=(f"{what}: pairs of {pairs[0][:-2]} and {pairs[1][:-2]}", *found.told)
        )
    counts = [k + 1 for k in (begin, begin + 1) if (table[:, k] == width - k - 1).all()]
    is_breezy = bool(begin) and _is_breezy(table)
    others = 0 if counts or is_breezy else _others_in(table[:, begin:])
    if others:
        names, last = ["-"] * (begin + others), table[:, begin + others - 1]
        if len(names) in (3, 4) and (last % 1).any() and np.abs(last).max() < 2 * np.pi:
            names = ["time" if begin else "-", *POSE_NAMES][-len(names) :]
        raise LogError(
            path,
            f"lines of {width} numbers, {width - begin - others} of them ranges behind "
            f"{begin + others} others? A line above that names them says so, "
            f"time_s,x_m,y_m,theta_rad, or `-` for what is none of these: "
            f"{(separator or ' ')[0].join([*names, 'ranges'])}",
        )
    if is_breezy:
        counts, told = [BREEZY_NUMBERS], [*told, TOLD_OF_BREEZY]
    places = tuple(range(max([begin, *counts]), width - is_breezy))
    factor, unit = unit_of_ranges("", table[:, places])
    angles = usual_view(len(places))
    angles = angles - np.pi * (is_breezy and np.ptp(angles) > 6)  # a turn of theirs begins behind
    told += [*unit, view_of(angles), f"lines of {width} numbers are scans"]
    codes = factor < 1 and len(places) in URG_BEAMS
    beams = Beams(places, factor, tuple(angles), least=factor * LOWEST if codes else 0.0)
    return Layout(separator, 0, (), columns, told=tuple(told), beams=beams)


def _begins_with_range(table: Array) -> bool:
    """Whether the first number of a line is a range, though it may rise from line to line.

    It is always about as large as the second one or, of as many as a usual laser has beams, as some
    of the others.
    """
    first, others = table[:, 0], table[:, 1:][table[:, 1:] > 0]
    if (np.abs(first - table[:, 1]) < ALIKE_SHARE * first).all():
        return True
    if table.shape[1] not in {*VIEWS_DEG, *URG_BEAMS} or not len(others):
        return False
    return bool(((first >= others.min()) & (first <= others.max())).all())


def _is_breezy(table: Array) -> bool:
    """Whether lines are those of BreezySLAM's examples: wheels that count, zeros, ranges, one."""
    wheels, zeros = table[:, 2:4], table[:, 4:BREEZY_NUMBERS]
    if table.shape[1] < BREEZY_NUMBERS + LEAST_BARE_BEAMS or zeros.any():
        return False
    return bool((np.diff(wheels, axis=0) >= 0).all() and np.ptp(wheels, axis=0).all())


def _others_in(table: Array) -> int:
    """How many numbers before the ranges of a line are none, as far as numbers tell.

    They rise all the time, or are below 0 by more than one code; where a usual laser has fewer
    beams, they may be any few, or always the same.
    """
    count, begin = table.shape[1], table[:, :MOST_HEAD_NUMBERS]
    rise = np.all(np.diff(table, axis=0) > 0, axis=0) & (len(table) >= TELLING_ROWS)
    rise[0] &= not _begins_with_range(table)
    least = np.fmin.reduce(table, axis=0)
    below = (least < 0) & (least != np.fmax.reduce(np.where(table < 0, table, np.nan), axis=0))
    odd = np.flatnonzero(rise | below)
    told = int(odd[-1]) + 1 if 0 < len(odd) <= MOST_HEAD_NUMBERS and odd[-1] < begin.shape[1] else 0
    usual = {*VIEWS_DEG, *URG_BEAMS}
    if count in usual:
        return told
    alike = int((np.ptp(begin, axis=0) == 0).cumprod().sum()) if len(table) > 1 else 0
    most = max(MOST_OTHERS, told, alike)
    return next((n for n in range(max(told, 1), most + 1) if count - n in usual), told)


def _pairs_of(table: Array) -> list[str]:
    """Names of columns `(m, 2 n)` that are angles and ranges in turn; none of others.

    Angles go one way, and from angle to range and on numbers go up and down.
    """
    signs = np.sign(np.diff(table, axis=1))
    zigzag = signs[:, 1:] * signs[:, :-1] < 0
    halves = table[:, ::2], table[:, 1::2]
    ways = [np.sign(np.diff(half, axis=1)) for half in halves]
    spans = [
        np.ptp(h) if abs(w.sum()) > 0.9 * w.size else 0.0 for h, w in zip(halves, ways, strict=True)
    ]
    if table.shape[1] % 2 or zigzag.sum() < 0.8 * zigzag.size or max(spans) < LEAST_VIEW_RAD:
        return []
    names = ("angle", "range") if spans[0] > spans[1] else ("range", "angle")
    return [f"{name}_{k}" for k in range(table.shape[1] // 2) for name in names]
