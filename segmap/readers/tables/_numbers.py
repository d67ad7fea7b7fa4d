"""What the numbers of a table tell: which columns are angle and range, and where a scan ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...arrays import Array
from ...scans import LaserScan
from ._columns import (
    COLUMN_UNITS,
    LEAST_VIEW_RAD,
    MOST_METRES,
    TELLING_ROWS,
    TICK_WORDS,
    Column,
    named,
    plain_words,
    units_said,
    with_units_told,
)

#: How many they usually are.
USUAL_TICKS = (1024, 1440, 2048, 4096, 8192, 16384, 65536)
#: A scan may begin so much before the first one did.
SAME_DIRECTION_RAD = np.radians(0.5)
#: A time that stands for a turn goes through such a share of the view at least.
LEAST_TURN_SHARE = 0.8
#: It begins such a share of the view from where the first one does at most.
BEGIN_SHARE = 1 / 16
#: The last of a turn may lie so many beams behind the first of another.
MORE_BEAMS = 3
#: One in so many may be of another kind.
ODD_TURNS = 10
#: Scans of another sensor look where those of the first do, with this share of their beams, ...
LEAST_SHARED = 0.25
#: ... and see other ranges: by so much, metres, ...
LEAST_OTHER_M = 0.05
#: ... and by so many times what the ranges of one change from scan to scan.
LEAST_OTHER = 2.0
#: So many pairs of scans tell it.
MOST_PAIRS = 200


def guessed(rows: Array) -> tuple[str, ...]:
    """Names of columns without names, by their numbers `(m, k)`; none where these do not tell."""
    count, usable = rows.shape[1], [int(k) for k in np.flatnonzero(np.isfinite(rows).all(0))]
    if len(rows) < TELLING_ROWS or not 2 <= len(usable) <= 8:
        return ()
    sweeps = [k for k in usable if _sweeps(rows[:, k])]
    if len(sweeps) > 1:  # an index counts by ones
        sweeps = [k for k in sweeps if not _counts_up(rows[:, k])] or sweeps
    if len(sweeps) > 1:
        sweeps = [k for k in sweeps if (np.diff(rows[:, k]) < 0).any()] or sweeps
        sweeps = [max(sweeps, key=lambda k: float(np.ptp(rows[:, k])))]
    clocks = [k for k in usable if (np.diff(rows[:, k]) >= 0).all() and np.ptp(rows[:, k])]
    if len(sweeps) != 1:
        return ()
    (angle,) = sweeps
    others = [k for k in usable if k != angle and k not in clocks and np.ptp(rows[:, k])]
    others = [k for k in others if (rows[:, k] >= 0).all() and not _counts_up(rows[:, k])]
    if not others:
        return ()
    ranked = sorted(others, key=lambda k: len(np.unique(rows[:, k])))
    distance, names = ranked[-1], ["-"] * count
    if len(ranked) > 1 and len(np.unique(rows[:, ranked[-2]])) == len(np.unique(rows[:, distance])):
        return ()
    names[angle], names[distance] = "angle", "range"
    if clocks and angle not in clocks[:1]:
        counts = _counts_up(rows[:, clocks[0]])
        names[clocks[0]] = "scan" if counts else "time"
        if counts and len(np.unique(rows[:, clocks[0]])) == len(rows):
            names[clocks[0]] = "-"  # an index
    return tuple(names)


def _sweeps(values: Array) -> bool:
    """Whether numbers go one way like the angle of a laser that turns, and at times fall back."""
    steps = np.diff(values)
    ahead = steps if (steps > 0).sum() >= (steps < 0).sum() else -steps
    span, falls = float(np.ptp(values)), -ahead[ahead < 0]
    if not LEAST_VIEW_RAD <= span <= 720 or np.abs(values).max() > 720:
        return False
    return bool(_goes_one_way(values) and (falls > span / 2).sum() >= 0.5 * len(falls))


def _goes_one_way(values: Array) -> bool:
    signs = np.sign(np.diff(values))
    return max((signs > 0).sum(), (signs < 0).sum()) >= 0.8 * len(signs)


def _points_in(rows: Array, places: Sequence[int]) -> list[int]:
    """The columns of two that are x and y, as numbers below 0 tell that go to and fro."""
    changing = [k for k in places if len({*rows[:, k]}) > TELLING_ROWS]
    is_angle = any(_goes_one_way(rows[:, k]) for k in changing)
    below = any((rows[:, k] < 0).any() for k in changing[:2])
    return changing[:2] if len(changing) >= 2 and below and not is_angle else []


def _counts_up(values: Array) -> bool:
    steps = np.diff(values)
    return bool((steps[steps > 0] == 1).all() and values.min() in (0, 1))


def _turn_like(values: Array) -> tuple[bool, float]:
    """How much numbers are like angles, in an order."""
    return _sweeps(values), float(np.ptp(values[np.isfinite(values)]))


def _measured_like(values: Array) -> tuple[int, float]:
    """How much numbers are like ranges, in an order: many different ones, and large."""
    known = values[np.isfinite(values)]
    return len(np.unique(known)), float(np.median(known))


def proposed_names(names: Sequence[str], rows: Array) -> list[str]:
    """A name with a unit for each column, as good as anybody can tell: it may be wrong."""
    columns, _ = with_units_told(named(names), rows)
    by_place = {column.place: (role, column) for role, column in columns.by_role.items()}
    if not by_place and (guess := guessed(rows)):
        columns, _ = with_units_told(named(guess), rows)
        by_place = {column.place: (role, column) for role, column in columns.by_role.items()}
    free = [k for k in range(len(names)) if k not in by_place and np.isfinite(rows[:, k]).any()]
    if not {"angle", "range", "x", "y"} & {*columns.by_role} and (xy := _points_in(rows, free)):
        by_place |= {k: (role, Column(k, None, "")) for k, role in zip(xy, "xy", strict=True)}
        columns = columns._replace(by_role={role: column for role, column in by_place.values()})
    for role, likely in (("angle", _turn_like), ("range", _measured_like)):
        if role not in columns.by_role and free and not {"x", "y"} <= {*columns.by_role}:
            place = max(free, key=lambda k, likely=likely: likely(rows[:, k]))  # type: ignore[misc]
            free.remove(place)
            by_place[place] = role, Column(place, None, "")
    usual = {"angle": np.pi / 180, "heading": 1.0, "range": 0.001, "time": 1.0}
    usual |= dict.fromkeys(("x", "y", "pose_x", "pose_y"), 1.0)
    found = ["-"] * len(names)
    for place, (role, column) in by_place.items():
        if role not in usual:
            found[place] = role
            continue
        most = np.nanmax(np.abs(rows[:, place]), initial=0.0)
        if column.factor not in (None, *COLUMN_UNITS[role].values()):
            found[place] = column.name
            continue
        if {*plain_words(column.name)} & {*TICK_WORDS}:
            turn = next((count for count in USUAL_TICKS if most < count), USUAL_TICKS[-1])
            found[place] = f"angle_ticks{turn}"
            continue
        large = most > MOST_METRES
        lengths = role in ("range", "x", "y")
        by_size = (0.001 if large else 1.0) if lengths else usual[role]
        factor = next(iter(units_said(role, names[place])), column.factor or by_size)
        units: Mapping[str, float] = COLUMN_UNITS[role]
        suffix = "_cw" if role == "angle" and columns.clockwise else ""
        found[place] = f"{role}_{next(word for word, f in units.items() if f == factor)}{suffix}"
    return found


# ------------------------------------------------------------------------------ where scans end
def is_time_of_turns(times: Array, angles: Array) -> bool:
    """Whether each time stands for one turn, or one sweep to or fro, wherever these begin.

    There is a direction then which no turn goes across: each begins behind it and ends before it.
    Where a clock of another step cuts turns, their begin moves on.
    """
    ends = np.flatnonzero(np.diff(times)) + 1
    if not np.isfinite(times).all() or not len(ends):
        return False
    view, turns = float(np.ptp(angles)), np.split(angles, ends)
    beam = view / float(np.median([*map(len, turns)]))
    gone = np.array([_folded(np.diff(turn), view + beam).sum() for turn in turns])
    if not np.median(np.abs(gone)) > LEAST_TURN_SHARE * view:
        return False
    begins = np.array([turn[0] for turn in turns])
    for way in (1, -1):
        of_way = np.sign(gone) == way
        begin = _folded(way * (begins[of_way] - begins[of_way][:1]), view + beam)
        end, few = np.sort(begin + np.abs(gone[of_way])), of_way.sum() // ODD_TURNS
        begin = np.sort(begin)
        if len(begin) and (
            end[-1 - few] - begin[few] > view + MORE_BEAMS * beam
            or abs(np.median(begin)) > BEGIN_SHARE * view
        ):
            return False
    return True


def _folded(steps: Array, view: float) -> Array:
    """Steps of an angle that begins anew behind the view."""
    return np.asarray(np.mod(steps + view / 2, view) - view / 2)


def ends_of_turns(angles: Array) -> tuple[list[int], str]:
    """Last beams of turns and of sweeps to and fro, by their places, and what tells them.

    Where a sweep has less than half of the beams of the other way, it is a part of that one.
    """
    steps = np.diff(angles)
    onwards = 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0
    wraps = np.flatnonzero(-onwards * steps > min(np.ptp(angles) / 2, np.pi))
    if len(wraps):
        return wraps.tolist(), "wraps"
    aside = angles - (angles.max() + angles.min()) / 2
    outer = np.flatnonzero(np.abs(aside) > np.ptp(angles) / 4)
    visits = np.split(outer, np.flatnonzero(np.diff(np.sign(aside[outer]))) + 1)
    ends = [int(v[np.abs(aside[v]).argmax()]) for v in visits[1:-1]]
    beams = np.diff([-1, *ends, len(angles) - 1])
    if len(beams) > 3:
        first, second = (float(np.median(beams[k::2])) for k in (0, 1))
        if min(first, second) < max(first, second) / 2:  # a scan begins where the angle is back
            backs = visits[1:-1][int(second < first) :: 2]
            ends = [int(v[-1 - np.abs(aside[v])[::-1].argmax()]) - 1 for v in backs]
            return ends, "is back, the few beams of its way back included"
    return ends, "turns back"


def from_first(angles: Array) -> Array:
    """Angles of points in their order, that wrap where the first of them lies."""
    steps = np.diff(np.unwrap(angles))
    onwards = 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0
    first = angles[0] - onwards * SAME_DIRECTION_RAD
    return np.asarray(first + onwards * np.mod(onwards * (angles - first), 2 * np.pi))


# ------------------------------------------------------------------------------ who measured
def by_beam(scans: Sequence[LaserScan]) -> Array:
    """Of each beam what orders the scans, the scan, angle and range, `(4, n)`."""
    times = (np.nan if scan.time is None else scan.time for scan in scans)
    rows = zip(times, scans, strict=True)
    return beams_in(
        [np.stack([s.angles, s.ranges, *np.full((2, len(s)), t)], axis=1) for t, s in rows]
    )


def beams_in(parts: Sequence[Array]) -> Array:
    """The same of scans that hold angle, range, time and number of each beam, `(n, 4 or more)`."""
    table, sizes = np.concatenate(parts)[:, :4], [*map(len, parts)]
    scan = np.repeat(np.arange(len(parts), dtype=float), sizes)
    begins = np.repeat([part[0, 2:4] if len(part) else (0, 0) for part in parts], sizes, axis=0)
    orders = [order for order in begins.T if np.isfinite(order).all() and np.ptp(order)]
    return np.array([orders[0] if orders else scan, scan, *table.T[:2]])


def parts_sensors(who: Array, order: Array, scan: Array, angles: Array, ranges: Array) -> bool:
    """Whether what a column says of beams, `(n,)`, parts them into recordings of several sensors.

    Ordered in time their scans alternate, look the same way and see other ranges, while scans of
    each go on from one to the next. Beams that come between others of their scan do not look so.
    """
    rows = np.lexsort((angles, scan, who, order))
    rows = rows[np.isfinite(ranges[rows])]
    keys = np.array([order, who, scan])[:, rows]
    groups = np.split(rows, np.flatnonzero(np.diff(keys).any(axis=0)) + 1)
    said = np.array([who[group[0]] for group in groups if len(group)])
    places = [np.flatnonzero(said == value) for value in np.unique(said)]
    changes = np.flatnonzero(np.diff(said))
    fewest = min(map(len, places), default=0)
    if len(places) < 2 or fewest < 2 or len(changes) < fewest:
        return False

    def change(pairs: Array, unlike: float) -> float:
        """Metres by which ranges of scans differ that look the same way."""
        found = []
        for first, second in pairs[:: len(pairs) // MOST_PAIRS + 1]:
            a, b = groups[first], groups[second]
            together = np.concatenate([a, b]) if scan[a[0]] == scan[b[0]] else a
            steps = np.diff(np.sort(angles[together]))
            half = np.median(steps[steps > 0]) / 2 if (steps > 0).any() else 0.0
            near = b[np.clip(np.searchsorted(angles[b], angles[a] - half), 0, len(b) - 1)]
            same = np.abs(angles[near] - angles[a]) < half
            enough = same.any() and same.sum() >= LEAST_SHARED * max(len(a), len(b))
            found.append(np.median(np.abs(ranges[near] - ranges[a])[same]) if enough else unlike)
        return float(np.median(found))

    other = change(np.stack([changes, changes + 1], axis=1), 0.0)
    own = np.concatenate([np.stack([each[:-1], each[1:]], axis=1) for each in places])
    return other > max(LEAST_OTHER_M, LEAST_OTHER * change(own, np.inf))
