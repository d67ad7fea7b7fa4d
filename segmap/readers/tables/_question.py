"""What is asked of a table that does not say what its columns are: what each of them may be."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from ..packed import log_file
from ._columns import UNITS, Column, meaning, missing_in
from ._layout import MOST_COLUMNS, Layout, fields_of, layout_of, merged

POSES = ("time", "x", "y", "angle")
SHOWN_ROWS = 6
#: Of them a message shows the first, and so many characters of each.
TOLD_ROWS = 3
TOLD_CHARACTERS = 70
#: Units in the order in which they are offered; feet and inches are rare, and said.
OFFERED = ("mm", "cm", "m", "deg", "rad", "s", "ms", "us", "ns")
VIEW_UNSAID = (
    "where the first and the last range of a row point is not said (degrees, counter-clockwise "
    "from straight ahead)"
)
ALL_RANGES = (
    "whether the numbers of a row are ranges, and in which unit, is not said (others before them "
    "are named first, as in time_s,-*3,ranges_m)"
)


class ColumnChoices(NamedTuple):
    """What the columns of a table may be, as far as it says so."""

    missing: str  #: what it does not say, in words; empty where it says all
    choices: tuple[tuple[str, ...], ...]  #: of each column from the left; those of ranges are one
    rows: tuple[tuple[str, ...], ...]  #: the first ones, as texts
    needs_view: bool = False  #: whether a row is a scan, and nothing says where its beams point
    are_poses: bool = False

    @property
    def columns(self) -> str:
        """The names of the columns, with `|` where one must choose."""
        return ",".join("|".join(choice) for choice in self.choices)

    def told(self, name: str) -> str:
        """The question about a file of that name, with what to write."""
        shown = "".join(f"    {','.join(row)[:TOLD_CHARACTERS]}\n" for row in self.rows[:TOLD_ROWS])
        option, argument = (
            (" --view FIRST LAST", ", view=(FIRST, LAST)") if self.needs_view else ("", "")
        )
        reads = "read_trajectory" if self.are_poses else "read_csv"
        words = "" if self.are_poses else f"    --columns '{self.columns}'{option}\n"
        return (
            f"{self.missing}; its first rows:\n{shown}Where a | stands choose one:\n{words}"
            f"    segmap.readers.{reads}({name!r}, columns='{self.columns}'{argument})\n"
            f"or keep them beside the file in {name}.toml, as columns = '...'"
            f"{' and view = [FIRST, LAST]' * self.needs_view}"
        )


def choices_of(layout: Layout, of_poses: str = "") -> ColumnChoices:
    """What is asked of a table, or of a file of poses of which so much is not said."""
    parts = merged(layout.head) if layout.head else [("", 1)] * len(layout.kinds)
    ends = [sum(count for _, count in parts[: k + 1]) for k in range(len(parts))]
    names = [(name, layout.kinds[end - 1]) for (name, _), end in zip(parts, ends, strict=True)]
    rows = tuple(tuple(fields_of(row, layout.separator)) for row in layout.rows[:SHOWN_ROWS])
    if of_poses:
        return ColumnChoices(of_poses, _choices(names, POSES), rows, are_poses=True)
    if len(names) > MOST_COLUMNS:  # a scan a row
        grouped = groupby(names, key=lambda each: each[1] and meaning(each[0]) is None)
        names = [
            each for unknown, run in grouped for each in ([("ranges", True)] if unknown else run)
        ]
    choices = _choices(names)
    if not any(choice[0].startswith("ranges") for choice in choices):
        return ColumnChoices(missing_in([name for name, _ in names]), choices, rows)
    open_ = [name for (name, _), choice in zip(names, choices, strict=True) if choice[1:]]
    missing = f"the unit of {', '.join(map(repr, open_))} is not said" if open_ else ""
    missing = missing if layout.head else ALL_RANGES
    missing = " and ".join(filter(None, (missing, VIEW_UNSAID * (layout.view is None))))
    return ColumnChoices(missing, choices, rows, layout.view is None)


def _choices(
    names: Sequence[tuple[str, bool]], needed: Sequence[str] = ()
) -> tuple[tuple[str, ...], ...]:
    """What each column may be, of its name and whether it holds numbers."""
    columns = [meaning(name) for name, _ in names]
    roles = Counter(column.role for column in columns if column)
    if not needed:
        points = sum(role in roles for role in "xy") > sum(r in roles for r in ("angle", "range"))
        needed = ("ranges",) if "ranges" in roles else ("x", "y") if points else ("angle", "range")
    lacking = [role for role in needed if role not in roles]
    if lacking == ["angle", "range"]:
        lacking += ["x", "y", "time", "scan"]
    found = []
    for column, (_, is_number) in zip(columns, names, strict=True):
        if column is None:
            of_roles = [Column(role) for role in lacking] if is_number else []
            found.append((*(name for each in of_roles for name in _units_of(each)), "-"))
            continue
        offered = _units_of(column)
        twin = roles[column.role] > 1
        pose = {"x": "pose_x", "y": "pose_y", "angle": "pose_theta"}.get(column.role)
        if pose and (twin or column.role not in needed):
            offered = (*(offered if twin else ()), *_units_of(column._replace(role=pose)), "-")
        elif twin or (column.role == "time" and not column.unit and is_number):
            offered = (*offered, "-")
        found.append(offered)
    return tuple(found)


def _units_of(column: Column) -> tuple[str, ...]:
    """Names of a column, one for each unit that it may have."""
    if column.is_whole:
        return (column.name,)
    units = UNITS[column.role]
    return tuple(column._replace(unit=unit).name for unit in OFFERED if unit in units)


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
