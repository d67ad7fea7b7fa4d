"""Maps of segments: the tables and arrays that `exports.write_segments` writes.

    x1,y1,x2,y2,scan
    0.0,0.0,1.5,0.1,0

Metres; the scan is the index of the one that a segment came from.
"""

from __future__ import annotations

from array import array
from pathlib import Path

import numpy as np

from ..arrays import LIMIT, Array
from ..files import escape
from ..segments import SegmentMap
from .lines import Lines, LogError, float_fields
from .packed import log_file

SEGMENT_COLUMNS = ["x1", "y1", "x2", "y2", "scan"]


def read_segments(path: str | Path) -> SegmentMap:
    """Read a map of segments: a table or an NPZ file, told apart by what is in them.

    A table has comma-separated lines below the head `x1,y1,x2,y2,scan` and may be packed; an NPZ
    file is what `SegmentMap.save` wrote, with points and sensors. The numbers are those that were
    written, bit for bit.

    Raises
    ------
    LogError
        A file that cannot be read or is none of the two, a row that is damaged, with its line. A
        packed file of more than 1 MB and 50 times its size.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "walls.csv"
    ...     _ = path.write_text("x1,y1,x2,y2,scan\\n0,0,1.5,0.1,7\\n")
    ...     read_segments(path).segments
    array([[[0. , 0. ],
            [1.5, 0.1]]])
    """
    with log_file(path) as place:
        with place.open("rb") as file:
            is_arrays = file.read(2) == b"PK"
        if not is_arrays:
            return _table(place)
        try:
            return SegmentMap.load(place)
        except ValueError as fault:
            raise LogError(place, str(fault).removeprefix(f"{escape(place)}: ")) from None


def _table(path: Path) -> SegmentMap:
    lines, values, head = Lines(path, separator=","), array("d"), list[str]()

    def take(fields: list[str]) -> None:
        if head:
            values.extend(_segment_row(fields))
            return
        head.extend(field.strip() for field in fields)
        if head != SEGMENT_COLUMNS:
            raise ValueError(
                f"expected the head {','.join(SEGMENT_COLUMNS)}, got {','.join(fields)[:80]!r}"
            )

    for _ in lines.each(take):
        pass
    if not head:
        raise LogError(path, f"is empty, expected the head {','.join(SEGMENT_COLUMNS)}")
    rows = np.array(values).reshape(-1, 5)
    return SegmentMap(rows[:, :4].reshape(-1, 2, 2), rows[:, 4])


def _segment_row(fields: list[str]) -> Array:
    """Two end points, metres, and a scan: (5,) array."""
    row = float_fields(fields, "x1,y1,x2,y2,scan")
    if len(row) != 5:
        raise ValueError(f"expected 5 fields x1,y1,x2,y2,scan, got {len(row)}")
    if not (np.abs(row[:4]) <= LIMIT).all():
        raise ValueError(f"expected metres for x1,y1,x2,y2, got {','.join(fields[:4])[:80]}")
    if not (abs(row[4]) < 2**53 and row[4] % 1 == 0):
        raise ValueError(f"expected a whole number for scan, got {fields[4][:40]}")
    return row
