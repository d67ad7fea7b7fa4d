"""Which format a file is of: by its first bytes or header, then by what most first lines are."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.metadata import entry_points
from itertools import islice
from pathlib import Path

from . import tables
from ._others import other_file, other_text, words_with_numbers
from .carmen import CARMEN_FORMATS
from .lines import Lines, UnknownFormat
from .tables import TABLE_FORMATS
from .text import Binary, Parts, TextFormat

#: These are asked first, in this order.
BINARY_FORMATS: tuple[Binary, ...] = (tables.ARRAYS,)
FOLDER_FORMATS: tuple[Binary, ...] = tables.TABLE_FOLDERS
TEXT_FORMATS: tuple[type[TextFormat], ...] = (*CARMEN_FORMATS, *TABLE_FORMATS)
#: Lines that are looked at; a damaged one among them does not change what most of them say.
LOOKED_AT_LINES = 200
#: Least share of lines with the words of a format, where a head names columns.
WORDS_SHARE = 0.1
#: Least share of lines of a format that has no words of its own.
SHAPE_SHARE = 0.5


def registered_formats() -> list[Binary | type[TextFormat]]:
    """The formats that other packages add by the entry point `segmap.formats`."""
    try:
        return [form for point in entry_points(group="segmap.formats") for form in point.load()]
    except ImportError:  # a package that is installed in part
        return []


def names_of_formats() -> list[str]:
    """Names of all formats of single files."""
    forms = (*TEXT_FORMATS, *BINARY_FORMATS, tables.TABLE, *registered_formats())
    return [form.name for form in forms]


def what_to_do() -> str:
    """What a user writes whose data are in none of the formats."""
    return f"""\
Known formats: {", ".join(names_of_formats())}.
Tables say what their columns are: a head such as angle_deg,range_mm, a file NAME.toml beside \
them, --columns or segmap.readers.read_csv.
Measurements in arrays (metres, radians, seconds) become a log by three lines:
    import segmap
    scans = [segmap.LaserScan(ranges, angles, time=t) for t, ranges in measured]
    log = segmap.Log("mine", scans)"""


def in_parts() -> list[tuple[Binary, Parts]]:
    """The formats whose logs may lie in several files."""
    forms = [form for form in registered_formats() if isinstance(form, Binary)]
    return [(form, form.parts) for form in forms if form.parts]


def recognise(path: Path) -> Binary | type[TextFormat]:
    """The format of a file or folder, by what speaks for it.

    That is the first bytes or what lies in a folder; then the words with which lines begin; then a
    head that names columns; then the shape of most of the first lines. What a table does not say is
    asked for.
    """
    for form in FOLDER_FORMATS if path.is_dir() else BINARY_FORMATS:
        if form.claims(path):
            return form
    stated = other_file(path) if path.is_file() else ""
    if path.is_dir() or stated:
        for other in registered_formats():
            if isinstance(other, Binary) and other.claims(path):
                return other
    if stated:
        raise UnknownFormat(path, f"{stated}\n{what_to_do()}")
    if path.is_dir():
        first = next((file for file in sorted(path.iterdir()) if file.is_file()), None)
        words = first and other_file(first)
        raise UnknownFormat(
            path,
            "holds no log, expected a Rawseeds recording (SICK_FRONT.csv or HOKUYO_FRONT.csv, "
            "ODOMETRY_XYT.csv, GROUNDTRUTH.csv), a bag of ROS 2 (metadata.yaml) "
            "or numbered files with a scan each, whose heads, or segmap.readers.read_csv(folder, "
            "columns='range_mm,angle_rad'), or urg_mm of a Hokuyo, say their columns"
            f"{f'; its first file {words}' if words else ''}\n{what_to_do()}",
        )
    lines = Lines(path, "skip", separator="\n")
    sample = [line[0] for line in islice(lines, LOOKED_AT_LINES)]

    @cache
    def split_at(separator: str | None) -> list[list[str]]:
        return [fields for line in sample if (fields := line.split(separator))]

    def vote(form: type[TextFormat]) -> int:
        return sum(map(form.claims, split_at(form.separator)))

    votes = {form: vote(form) for form in TEXT_FORMATS}
    if max(votes.values()) < len(sample):  # none of ours says all of it
        votes |= {form: vote(form) for form in registered_formats() if not isinstance(form, Binary)}
    words = other_text(path.name, sample) if sample else ""
    for share, by_shape in ((WORDS_SHARE, False), (SHAPE_SHARE, True)):
        least = max(share * len(sample), 1)
        forms = [form for form in votes if votes[form] >= least and form.by_shape <= by_shape]
        if forms:
            return max(forms, key=lambda form: votes[form])
        if sample and not (by_shape or words) and tables.TABLE.claims(path):
            return tables.TABLE
    if lines.first:
        raise UnknownFormat(path, lines.first.reason, lines.first.line)
    raise UnknownFormat(
        path, f"{words}\n{what_to_do()}" if words else _looks_like(path, sample, lines.number)
    )


def _looks_like(path: Path, sample: Sequence[str], count: int) -> str:
    """What a file of no known format holds, and what to do with it."""
    if not count:
        return f"is empty, expected a log\n{what_to_do()}"
    if not sample:
        return f"is of no known format: it has comments only\n{what_to_do()}"
    if asked := tables.asked_of(path):
        return asked
    if opened := words_with_numbers(path.name, sample):
        return f"{opened}\n{what_to_do()}"
    return f"is of no known format: it starts with {sample[0][:40]!r}\n{what_to_do()}"
