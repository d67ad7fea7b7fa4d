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
from ..segments import SegmentMap
from ._lines import Lines, LogError, numbers
from ._opening import asking, checked_file, named

HEAD = ["x1", "y1", "x2", "y2", "scan"]


def read_segments(path: str | Path) -> SegmentMap:
    """Read a map of segments: a table or an NPZ file, told apart by what is in them.

    Parameters
    ----------
    path : str or Path
        A table of comma-separated lines below the head `x1,y1,x2,y2,scan`, metres, plain or packed;
        or what `SegmentMap.save` wrote.

    Returns
    -------
    SegmentMap
        The numbers that `exports.write_segments` was given, bit for bit: `segments` as (n, 2, 2)
        array, metres. An NPZ file brings points and sensors too.

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
    place = named(path)
    with asking(place):
        with checked_file(place).open("rb") as file:
            is_arrays = file.read(2) == b"PK"
        return _arrays(place) if is_arrays else _table(place)


def _arrays(path: Path) -> SegmentMap:
    try:
        return SegmentMap.load(path)
    except ValueError as fault:
        raise LogError(path, str(fault).removeprefix(f"{path}: ")) from None


def _table(path: Path) -> SegmentMap:
    lines, table = Lines(path, separator=","), _Table()
    for _ in lines.each(table.take):
        pass
    if not table.has_head:
        raise LogError(path, f"is empty, expected the head {','.join(HEAD)}")
    rows = np.array(table.values).reshape(-1, 5)
    return SegmentMap(rows[:, :4].reshape(-1, 2, 2), rows[:, 4])


class _Table:
    """What the lines of one table said so far."""

    def __init__(self) -> None:
        self.has_head, self.values = False, array("d")

    def take(self, fields: list[str]) -> None:
        """Take in one line."""
        if self.has_head:
            self.values.extend(_row(fields))
        elif [field.strip() for field in fields] != HEAD:
            raise ValueError(f"expected the head {','.join(HEAD)}, got {','.join(fields)[:80]!r}")
        self.has_head = True


def _row(fields: list[str]) -> Array:
    """Two end points, metres, and a scan: (5,) array."""
    found = numbers(fields, "x1,y1,x2,y2,scan")
    if len(found) != 5:
        raise ValueError(f"expected 5 fields x1,y1,x2,y2,scan, got {len(found)}")
    if not (np.abs(found[:4]) <= LIMIT).all():
        raise ValueError(f"expected metres for x1,y1,x2,y2, got {','.join(fields[:4])[:80]}")
    if not (abs(found[4]) < 2**53 and found[4] % 1 == 0):
        raise ValueError(f"expected a whole number for scan, got {fields[4][:40]}")
    return found
