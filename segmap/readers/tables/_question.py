"""What is asked of a table that does not say what its columns are: what each of them may be."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from itertools import groupby, islice
from pathlib import Path
from typing import NamedTuple

from ..packed import log_file
from ._columns import (
    BEAM_ROLES,
    OF_POSES,
    POSES_ALONE,
    UNIT_WORDS,
    UNITS,
    Column,
    meaning,
    missing_in,
    words_of,
)
from ._layout import Layout, fields_of, layout_of, runs_of

#: What a column of words may be.
OF_WORDS = ("time", "new", "error", "scan")
OF_A_POSE = ("time", "x", "y", "angle")
#: Of more columns without a head nobody chooses the angle: they are a scan a row, if anything.
MOST_COLUMNS = 12
SHOWN_ROWS = 6
#: Of them a message shows the first, and so many characters of each.
TOLD_ROWS = 3
#: Of the lines of words above them it shows the last.
TOLD_WORDS = 5
TOLD_CHARACTERS = 70
#: Units in the order in which they are offered; feet and inches are rare, and said.
OFFERED = ("mm", "cm", "m", "deg", "rad", "s", "ms", "us", "ns")
VIEW_UNSAID = (
    "where the first and the last range of a row point is not said (degrees, counter-clockwise "
    "from straight ahead)"
)
ALL_RANGES = (
    "how many numbers N of a row stand before its ranges, and the unit of these, is not said (N is "
    "0, or names for -*N, as in time_s,-*3,ranges_m; a # goes before a first row that is a head)"
)
#: All roles with their units, as `every_name` has them.
OTHER_NAMES = " (cw is clockwise, - left out, angle_deg/10 tenths; there are {})".format(
    "; ".join(
        ", ".join(roles) + (f" with _{', _'.join(units)}" if units else "")
        for units, roles in groupby(UNITS, key=lambda role: UNITS[role])
    )
)


class ColumnChoices(NamedTuple):
    """What the columns of a table may be, as far as it says so."""

    missing: str  #: what it does not say, in words; empty where it says all
    choices: tuple[tuple[str, ...], ...]  #: names that each column may have; all ranges are one
    rows: tuple[tuple[str, ...], ...]  #: the first rows, as texts
    needs_view: bool = False  #: whether a row is a scan, and nothing says where its beams point
    are_poses: bool = False
    words: tuple[str, ...] = ()  #: lines that are no rows, in which the answer may stand

    @property
    def every_name(self) -> tuple[str, ...]:
        """All names of columns, for who knows better than the file."""
        return tuple(
            Column(role, unit, is_clockwise).name
            for role in UNITS
            for unit in ("", *UNITS[role])
            for is_clockwise in ((None, True) if role == "angle" else (None,))
            if Column(role, unit).is_whole or role == "time"
        )

    @property
    def columns(self) -> str:
        """The names of the columns, with `|` where one must choose."""
        names = ",".join("|".join(choice) for choice in self.choices)
        return re.sub("(?<![^,])-(,-)+(?![^,])", lambda run: f"-*{run[0].count('-')}", names)

    def question(self, name: str) -> str:
        """The question about a file of that name, with what to write."""
        if not self.choices:
            return self.missing
        first = (*self.words[-TOLD_WORDS:], *map(",".join, self.rows[:TOLD_ROWS]))
        shown = "".join(f"    {line[:TOLD_CHARACTERS]}\n" for line in first)
        option = " --view FIRST LAST" * self.needs_view
        argument = ", view=(FIRST, LAST)" * self.needs_view
        asked = f"{self.missing}; its first rows:\n{shown}"
        named = (meaning(name) for choice in self.choices for name in choice)
        roles = {column.role for column in named if column}
        if not self.are_poses and not any({*kind} <= roles for kind in BEAM_ROLES):
            return f"{asked}No other column of it can be that: there is no scan in it."
        columns = f"-*N,{self.columns}" if self.missing.startswith(ALL_RANGES) else self.columns
        reads = "read_trajectory" if self.are_poses else "read_csv"
        words = "" if self.are_poses else f"    --columns '{columns}'{option}\n"
        return (
            f"{asked}Where a | stands choose one{OTHER_NAMES * (not self.are_poses)}:\n{words}"
            f"    segmap.readers.{reads}({name!r}, columns='{columns}'{argument})\n"
            f"or keep them beside the file in {name}.toml, as columns = '...'"
            f"{' and view = [FIRST, LAST]' * self.needs_view}"
        )


def choices_of(layout: Layout, of_poses: str = "") -> ColumnChoices:
    """What is asked of a table, or of a file of poses of which so much is not said."""
    if layout.unsaid:
        return ColumnChoices(layout.unsaid, (), ())
    rows = tuple(tuple(layout.fields(row)) for row in layout.rows[:SHOWN_ROWS])
    if layout.head:
        runs = runs_of(layout.head)
    elif len(layout.kinds) > MOST_COLUMNS:
        runs = [("", len(list(run))) for _, run in groupby(layout.kinds)]
    else:
        runs = [("", 1)] * len(layout.kinds)
    kinds, names = iter(layout.kinds), [name for name, _ in runs]
    columns = [(name, count, [*islice(kinds, count)][-1]) for name, count in runs]
    asked = ColumnChoices(of_poses or missing_in(names), (), rows, words=layout.words)
    if of_poses:
        return asked._replace(choices=_choices(columns, OF_A_POSE), are_poses=True)
    if asked.missing == POSES_ALONE:
        return asked._replace(rows=())
    roles = {column.role for column in map(meaning, names) if column}
    is_wide = any(count > 1 and is_number for _, count, is_number in columns)
    if "ranges" in roles or (is_wide and not {"angle", "range"} <= roles):
        choices = _choices(columns, BEAM_ROLES[0])
        open_ = [name for name, choice in zip(names, choices, strict=True) if choice[1:]]
        missing = f"what {', '.join(map(repr, open_))} hold, and in which unit, is not said"
        missing = (missing if open_ else "") if layout.head else ALL_RANGES
        missing = " and ".join(filter(None, (missing, VIEW_UNSAID * (layout.view is None))))
        return asked._replace(missing=missing, choices=choices, needs_view=layout.view is None)
    points = sum(role in roles for role in "xy") > sum(r in roles for r in ("angle", "range"))
    asked = asked._replace(choices=_choices(columns, BEAM_ROLES[3 if points else 1]))
    heads = (fields_of(line, layout.separator) for line in layout.words)
    if not layout.head and (head := next((h for h in heads if not missing_in(h)), None)):
        differ = f"its head names {len(head)} columns, and its rows have {len(names)} fields"
        differ += " (is its decimal mark the one that separates them, too?)"
        return asked._replace(missing=differ)
    if way := layout.way_in_words:
        whole = (("angle_deg",), ("angle_rad",))
        either = tuple((*c, f"{c[0]}_cw") if c in whole else c for c in asked.choices)
        missing = asked.missing or f"no name says which way angles grow, as {way!r} does"
        return asked._replace(missing=missing, choices=either)
    return asked


def _choices(
    columns: Sequence[tuple[str, int, bool]], needed: Sequence[str]
) -> tuple[tuple[str, ...], ...]:
    """What each column may be, of its name, how many are alike, and whether it holds numbers."""
    meanings = [
        column if (column := meaning(name)) and (is_number or column.role in OF_WORDS) else None
        for name, _, is_number in columns
    ]
    counts = Counter(column.role for column in meanings if column)
    lacking = [role for role in needed if role not in counts]
    choices = list[tuple[str, ...]]()
    for column, (name, count, is_number) in zip(meanings, columns, strict=True):
        if column is None:
            words = words_of(name)
            unit = UNIT_WORDS.get(words[-1], "") if words[1:] else ""
            roles = lacking if count > 1 or "ranges" not in lacking else []
            if "time" not in counts and (unit or ("ranges" in needed and count == 1)):
                roles = [*roles, "time"]
            roles = [role for role in roles if is_number and (not unit or unit in UNITS[role])]
            names = _names_of(roles, Column("", unit))
            choices.append((*names, "-" if count == 1 else f"-*{count}"))
            continue
        role, pose, is_one_of_two = column.role, OF_POSES.get(column.role), counts[column.role] > 1
        roles = [role] if is_one_of_two or not pose or role in needed else []
        roles += [pose] if pose and (is_one_of_two or role not in needed) else []
        roles = ["angle", role] if role == "pose_theta" and "angle" in lacking else roles
        is_bare_time = role == "time" and not column.unit
        names = ("time",) if is_bare_time and not is_number else _names_of(roles, column)
        is_open = is_one_of_two or roles != [role] or (is_bare_time and is_number)
        choices.append((*names, *["-"] * is_open))
    return tuple(choices)


def _names_of(roles: Sequence[str], column: Column) -> tuple[str, ...]:
    """Names of a column of such roles: one for each unit that it may have, and way of angles."""
    if [*roles] == [column.role] and column.is_whole:
        return (column.name,)
    ways = (True,) if column.clockwise else (None, True)
    return tuple(
        Column(role, unit, is_clockwise).name
        for role in roles
        for is_clockwise in (ways if role == "angle" else (None,))
        for unit in ([column.unit] if column.unit else [u for u in OFFERED if u in UNITS[role]])
    )


def column_choices(path: str | Path) -> ColumnChoices:
    """What the columns of a table may be: where it does not say it, a choice for each.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "it.csv"
    ...     _ = path.write_text("scan;angle_deg;range\\n0;0;1500\\n0;90;2000\\n")
    ...     asked = column_choices(path)
    >>> asked.columns, asked.rows[0]
    ('scan,angle_deg,range_mm|range_cm|range_m', ('0', '0', '1500'))
    """
    with log_file(path) as place:
        return choices_of(layout_of(place))
