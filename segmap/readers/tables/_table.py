"""Tables whose columns are declared: a beam a row, or a scan a row.

Rows of one scan number are one scan, wherever they stand. Where nothing says which rows are one
scan, it ends where the angle wraps, or where a sweep turns back. A range of 0 or below is no
measurement.

Assumed: angles are counter-clockwise where no name says `cw`; a robot's laser sits at its centre.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...scans import LONGEST_TURN_S, LaserScan, Log
from ...scans.error_codes import as_ranges
from ..lines import HeadError, Lines, LogError
from ..raw_scans import COUNTERCLOCKWISE, beams_of_message, or_none, place_of
from ._columns import BEAM_ROLES, MESSAGE_NUMBERS, POSE, places_of, ranges_in
from ._layout import Layout
from ._question import choices_of
from ._rows import Rows

#: No scan has more beams.
MOST_BEAMS_READ = 100_000
#: So much is told of the lines of words in a table.
TOLD_CHARACTERS = 160
#: Names of columns that say who measured.
WHO = re.compile(r"(?i)(sensor|laser|lidar|robot|device|frame|topic|channel)([ _-]?(id|no|name))?")
#: A scan of end points may begin so much before the first one did.
SAME_DIRECTION_RAD = np.radians(0.5)


def read_declared_rows(path: Path, name: str, on_error: str, layout: Layout) -> Log:
    """The log that a table holds."""
    if not layout.is_whole:
        raise HeadError(path, choices_of(layout).question(path.name), layout.line or None)
    lines = Lines(path, on_error)
    rows, places, notes = Rows(lines, layout), places_of(layout.names), list(layout.notes)
    _refuse_several(path, rows, layout)
    beam = next(kind for kind in BEAM_ROLES if {*kind} <= {*places})
    others = {role for kind in BEAM_ROLES for role in kind} - {*beam}
    others |= set() if {*POSE} <= {*places} else {*POSE}
    places = {role: at for role, at in places.items() if role not in others}
    table: dict[str, Array] = {}
    for role, (place, column) in places.items():
        values = rows.values(place, column) if role != "ranges" else None
        if values is not None:
            table[role] = values
        elif role == "time":
            notes.append(f"{layout.names[place]!r} says no unit of time and is left out")
    used = {place for place, _ in places.values()} | {*ranges_in(layout.names)}
    unused = [
        name or f"column {k + 1}"
        for k, name in enumerate(layout.names)
        if k not in used and name != "-" and (name or rows.columns[k].notna().any())
        if not WHO.fullmatch(name)
    ]
    if layout.words:
        notes.append(f"not read: {', '.join(map(repr, layout.words[:3]))}"[:TOLD_CHARACTERS])
    if unused:
        notes.append(f"left out: {', '.join(map(repr, unused))}")
    if {"time", "nanosec"} <= {*table}:
        table["time"] = table["time"] + table["nanosec"]
    ranges = rows.ranges() if "ranges" in places else []
    wrong = int((~rows.good).sum())
    if wrong > len(rows.good) - wrong:
        what = f"{wrong} of {len(rows.good)} lines are no {layout.columns}"
        raise LogError(path, f"{what}: {lines.first.reason if lines.first else ''}")
    if "ranges" in places:
        scans = _a_scan_a_row(rows, ranges, table)
    else:
        table = {role: values[rows.good] for role, values in table.items()}
        scans = _a_beam_a_row(path, table, layout, notes)
    if any(scan.odometry is not None for scan in scans):
        notes.append(place_of(np.zeros(3)))
    return Log(name, scans, None, lines.skipped, assumed=notes)


def _refuse_several(path: Path, rows: Rows, layout: Layout) -> None:
    """A column of the file itself that says that several sensors measured ends the reading."""
    for place, name in enumerate(layout.names):
        if WHO.fullmatch(name) and (values := [*dict.fromkeys(rows.columns[place])])[1:]:
            what = f"{name!r} holds {', '.join(map(str, values[:3]))}: expected one sensor a log"
            if not layout.head:
                raise HeadError(path, what)
            table = f"pandas.read_csv({path.name!r}, sep={layout.separator!r})"
            code = f"for who, part in {table}.groupby({layout.head[place]!r}):"
            written = f"part.to_csv(f'{name}_{{who}}.csv', index=False)"
            raise HeadError(path, f"{what}, which these lines part:\n    {code}\n        {written}")


def _a_scan_a_row(
    rows: Rows, ranges: Sequence[Array], table: Mapping[str, Array]
) -> list[LaserScan]:
    """Scans whose beams point where the rows say, as messages of ROS do, or else the view."""
    path, view, scans, near = rows.lines.path, rows.layout.view, list[LaserScan](), False
    usual = {"range_min": 0.0, "range_max": np.inf, "time_increment": 0.0}
    if view is not None:
        directions = np.linspace(*view, len(ranges[0]))
        factor = places_of(rows.layout.names)["ranges"][1].factor
        if len(directions) > 2 and np.allclose(ranges[0] / factor, directions, atol=1e-6):
            what = "its first row holds the directions of the view: a head is one with # before it"
            raise HeadError(path, what)
        usual["angle_min"] = np.radians(view[0])
        usual["angle_increment"] = np.radians(view[1] - view[0]) / max(len(directions) - 1, 1)
    for k in np.flatnonzero(rows.good).tolist():
        far, stated = ranges[k], {role: table[role][k] for role in MESSAGE_NUMBERS if role in table}
        message = SimpleNamespace(**usual | stated)
        try:
            if "angle_max" in stated:  # intensities stand behind the ranges
                steps = (message.angle_max - message.angle_min) / (
                    message.angle_increment or np.nan
                )
                if not 0 <= round(np.nan_to_num(steps, nan=-1)) < len(far):
                    what = f"of {steps + 1:.0f} from angle_min to angle_max"
                    raise ValueError(f"expected the ranges {what}, got {len(far)} fields")
                far = far[: round(steps) + 1]
            message.ranges = far
            when = table["time"][k] if "time" in table else np.nan
            scan = beams_of_message(message, when, _pose(table, k))
        except ValueError as fault:
            rows.damaged(k, str(fault))
            continue
        near = near or bool((far <= scan.max_range).any())
        scans.append(scan)
    if not scans:
        raise rows.lines.no_scan("lines with ranges")
    if not near and any(np.isfinite(far).any() for far in ranges):
        what = "all its ranges lie beyond range_max: expected metres, as ROS has them"
        raise LogError(path, what)
    return scans


def _pose(table: Mapping[str, Array], row: int) -> Array | None:
    pose = [table[role][row] for role in POSE if role in table]
    return or_none(np.array(pose)) if len(pose) == len(POSE) else None


def _a_beam_a_row(
    path: Path, table: dict[str, Array], layout: Layout, notes: list[str]
) -> list[LaserScan]:
    if "urg" in table:
        table["range"], codes = as_ranges(table["urg"])
        table["codes"] = codes.astype(float)
    elif "range" not in table:
        met = np.hypot(table["x"], table["y"]) > 0  # others ended nowhere
        table = {role: values[met] for role, values in table.items()}
        table["range"] = np.hypot(table["x"], table["y"])
        table["angle"] = _from_first(np.arctan2(table["y"], table["x"]))
    ways = {column.clockwise for _, column in places_of(layout.names).values()}
    is_clockwise = True in ways
    if ways == {None}:
        notes.append(COUNTERCLOCKWISE)
    if "error" in table:
        table["range"] = np.where(table["error"] > 0, np.nan, table["range"])
    table["range"] = np.where(table["range"] > 0, table["range"], np.nan)
    ends: NDArray[np.int64] = np.empty(0, np.int64)  # a text of a Hokuyo is one scan
    if "scan" in table:
        table, ends = _by_number(path, table)
    elif table.get("new", np.zeros(1)).any():
        ends = np.flatnonzero(table["new"][1:])
    elif "urg" not in table:
        ends, how = ends_of_turns(table["angle"])
        notes += [f"a scan ends where the angle {how}"] * bool(len(ends))
    times = table.get("time", np.full(len(table["angle"]), np.nan))
    back = np.flatnonzero(np.diff(times) < 0)
    if len(back) > max(len(ends), 1):
        raise LogError(
            path, f"its times go back {len(back)} times: sort its rows by time, or name the scans"
        )
    scans = []
    for begin, end in pairwise([0, *(ends + 1).tolist(), len(times)]):
        if end - begin > MOST_BEAMS_READ:
            what = f"expected at most {MOST_BEAMS_READ} beams in a scan, got {end - begin}"
            raise LogError(path, f"{what}: a column `scan` or `new` says where one ends")
        way = (
            slice(end - 1, begin - 1 if begin else None, -1) if is_clockwise else slice(begin, end)
        )
        angles, ranges, when = (table.get(role, times)[way] for role in ("angle", "range", "time"))
        first = float(np.min(when))
        if np.ptp(when) > LONGEST_TURN_S:
            words = f"the beams of a scan take {np.ptp(when):.6g} s, and no laser turns so slowly"
            raise LogError(path, f"{words}: are its times milliseconds, or is it several scans?")
        delays = when - first if np.ptp(when) > 0 else None
        errors = table["codes"][way].astype(np.int64) if "codes" in table else None
        pose = _pose(table, begin)
        scans.append(LaserScan(ranges, angles, first, pose, codes=errors, delays=delays))
    return scans


def _by_number(
    path: Path, table: Mapping[str, Array]
) -> tuple[dict[str, Array], NDArray[np.int64]]:
    """The beams with those of one scan together, in the order of the file, and where scans end."""
    number = table["scan"]
    if len(np.flatnonzero(np.diff(number))) + 1 > len(np.unique(number)):  # numbers come back
        beams = np.unique(np.stack([number, table["angle"]]), axis=1)
        if beams.shape[1] < len(number):
            what = "scan numbers come back, with directions that their scans have already"
            raise LogError(path, f"{what}: expected the rows of one recording")
        order = np.argsort(number, kind="stable")
        table = {role: values[order] for role, values in table.items()}
    return dict(table), np.flatnonzero(np.diff(table["scan"]))


def _direction(steps: Array) -> float:
    """The sign of most steps from beam to beam."""
    return 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0


def _from_first(angles: Array) -> Array:
    """Angles of points in their order, that wrap where the first of them lies."""
    onwards = _direction(np.diff(np.unwrap(angles)))
    first = angles[:1] - onwards * SAME_DIRECTION_RAD
    return np.asarray(first + onwards * np.mod(onwards * (angles - first), 2 * np.pi))


def ends_of_turns(angles: Array) -> tuple[NDArray[np.int64], str]:
    """Last beams of turns, or of sweeps to and fro, by their places, and what tells them."""
    steps = np.diff(angles)
    wraps = np.flatnonzero(-_direction(steps) * steps > min(np.ptp(angles) / 2, np.pi))
    if len(wraps):
        return wraps, "wraps"
    aside = angles - (angles.max() + angles.min()) / 2
    outer = np.flatnonzero(np.abs(aside) > np.ptp(angles) / 4)
    visits = np.split(outer, np.flatnonzero(np.diff(np.sign(aside[outer]))) + 1)
    ends = [int(v[np.abs(aside[v]).argmax()]) for v in visits[1:-1]]
    return np.array(ends, int), "turns back"
