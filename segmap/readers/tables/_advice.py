"""What is shown of a table whose columns nobody names, and what to do with it."""

from __future__ import annotations

from pathlib import Path

from .._lines import is_number
from ..packed import log_file
from ._columns import named
from ._fields import TABLE_COMMENTS, decimal, sample, split
from ._layout import Layout, begin_of, layout_of, rows_below
from ._messages import SHOWN_ROWS, records_of, shown_records
from ._numbers import proposed_names

#: Of more columns nobody chooses the angle: they are scans, if anything.
MOST_CHOSEN_COLUMNS = 20


def first_rows(path: str | Path) -> tuple[list[str], list[list[str]]]:
    """Names that may fit the columns of a table, with units, and its first rows, as texts.

    Nothing of a file whose beams stand in no columns: with a name beside each number, in brackets.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "it.csv"
    ...     _ = path.write_text("a;b\\n0;1500\\n90;2000\\n")
    ...     first_rows(path)
    (['angle_deg', 'range_mm'], [['0', '1500'], ['90', '2000']])
    """
    with log_file(path) as place:
        if records := records_of(place):
            return shown_records(records, place)
        separator, line = begin_of(place)
        lines = [(k, t) for k, t in sample(place) if k > line and not t.startswith(TABLE_COMMENTS)]
        rows = [split(text, separator) for _, text in lines]
        lengths = [len(row) for row in rows]
        wide = max({*lengths}, key=lengths.count, default=0)
        found = layout_of(place)
        if found and (found.labels or found.nested):  # there are no columns
            return [], []
        head = split(dict(sample(place)).get(line, ""), separator)
        kinds = (found.names if found else (), tuple(head), ("-",) * wide)
        names = next(names for names in kinds if len(names) == wide)
        table = rows_below(Layout(separator, line, names, named(names)), lines)
        return proposed_names(names, table) if wide else [], rows[:SHOWN_ROWS]


def looks_like(path: Path) -> str:
    """What a file without a format holds, and three lines of Python that read it, if numbers."""
    lines = [(k, line) for k, line in sample(path) if not line.startswith(TABLE_COMMENTS)]
    separator, line = begin_of(path)
    rows = [split(text, separator) for number, text in lines if number > line]
    fields = [*map(decimal, rows[0])] if rows else []
    if len(rows) < 2 or len(fields) < 2 or not all(map(is_number, fields)):
        return ""
    count, mark = len(rows[0]), {None: "white space", "\t": "tabs"}.get(separator, f"{separator!r}")
    first = "".join(f"    {text[:70]}\n" for _, text in lines[:3])
    if count > MOST_CHOSEN_COLUMNS:
        how = "a line above that names them, time_s,r0,r1,r2,..., says what they are"
        return f"It looks like {count} columns between {mark}:\n{first}If they are scans, {how}.\n"
    names, _ = first_rows(path)
    if not names:
        return ""
    head, chosen = split(dict(lines).get(line, ""), separator), ",".join(names)
    odd = [
        repr(n) for n, to in zip(head, names, strict=False) if to != "-" and not named([n]).by_role
    ]
    what = f"No known name or unit is {', '.join(odd)}." if len(head) == count else ""
    return (
        f"It looks like {count} columns between {mark}:\n{first}"
        f"{what or 'Which is which nobody says.'} If it is so, --columns {chosen} reads it, or\n"
        f"    import segmap\n"
        f"    log = segmap.readers.read_csv({path.name!r}, columns={chosen!r})\n"
        f"    log[0].ranges, log[0].angles\n"
    )
