"""The CSV files that keep runs, line by line, and the DataFrames that are made of them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files import existing, read_table, table_text

if TYPE_CHECKING:
    import pandas as pd

#: A threshold of a method: metres, radians, a number of scans, or None where another decides.
Threshold = float | int | None
#: One line of a file: the name of each column -> its value; `thresholds` is a dictionary.
Row = dict[str, Any]
#: The columns of a file in their order, and how each is read.
Columns = Mapping[str, Callable[[str], Any]]


#: Words that are thresholds.
WORDS: dict[str, Threshold] = {"None": None, "True": True, "False": False}
#: A count and a number are at most this.
LARGEST_NUMBER = 2**53
#: As many thresholds have all methods together, at most.
MOST_THRESHOLD_NAMES = 200


def _whole(cell: str) -> int:
    """A count."""
    if not (cell.isascii() and cell.isdigit() and len(cell) < 17 and int(cell) <= LARGEST_NUMBER):
        raise ValueError(cell)
    return int(cell)


def _cell_number(cell: str, least: float = 0.0, most: float = LARGEST_NUMBER) -> float:
    """A number within bounds, or NaN where nothing was measured."""
    value = float(cell)
    if "_" in cell or value < least or value > most:
        raise ValueError(cell)
    return value


def _threshold(text: str) -> Threshold:
    if text in WORDS:
        return WORDS[text]
    if text.lstrip("-").isdigit() and text.isascii():
        return int(text) if abs(float(text)) <= LARGEST_NUMBER else _cell_number(text)
    value = float(text)
    if "_" in text or value != value:  # NaN is a threshold that a method does not have
        raise ValueError(text)
    return value


def _flags(cell: str) -> str:
    """One 0 or 1 for each of some things."""
    if not cell or set(cell) - {"0", "1"}:
        raise ValueError(cell)
    return cell


def _thresholds(text: str) -> dict[str, Threshold]:
    """Thresholds as a file keeps them, to the last digit: `distance=0.2;angle=0.1745`."""
    pairs = [pair.split("=") for pair in text.split(";") if pair]
    found = {name: _threshold(value) for name, value in pairs}
    if len(found) < len(pairs) or any(not n.isidentifier() or n in NO_THRESHOLDS for n in found):
        raise ValueError(text)
    return found


#: What a sweep writes. A filter of 0 m, an empty cell, drops nothing; segments may become more, so
#: that a reduction may be below 0.
RUNS: Columns = {
    "map": str,
    "method": str,
    "thresholds": _thresholds,
    "filtered": lambda cell: _cell_number(cell or "0", most=1e7),
    "n_before": _whole,
    "n_after": _whole,
    "reduction": lambda cell: _cell_number(cell, -LARGEST_NUMBER, 1.0),
    "quality": lambda cell: _cell_number(cell, most=1.0),
    "seconds": _cell_number,
    "digest": str,
    "invented": lambda cell: _cell_number(cell or "nan"),
    "missed": lambda cell: _cell_number(cell or "nan"),
}
#: What a sweep wrote before it measured metres: such files are read, and gone on with, as they are.
FORMER: Columns = {name: kind for name, kind in RUNS.items() if name not in ("invented", "missed")}
ONLINE: Columns = {
    "method": str,
    "thresholds": _thresholds,
    "scans": _whole,
    "seconds": _cell_number,
    "live": _whole,
}
ALIGNMENTS: Columns = {
    **dict.fromkeys(("log", "method"), str),
    **dict.fromkeys(("scans", "used", "compared"), _whole),
    **dict.fromkeys(("mean", "deviation", "rms", "p95", "largest"), _cell_number),
    "above_0.2": lambda cell: _cell_number(cell, most=1.0),
    **dict.fromkeys(("heading", "seconds"), _cell_number),
}
#: Maps judged by the walls of their building. Means over maps, shares of what could be known, and
#: one 0 or 1 for each map: whether all four figures are good.
WALLS_COLUMNS: Columns = {
    **dict.fromkeys(("group", "sensor", "noise", "method"), str),
    "thresholds": _thresholds,
    **dict.fromkeys(
        ("per_wall", "largest", "found", "missed", "invented", "doubled"), _cell_number
    ),
    "offset": _cell_number,
    "all_four": _flags,
}
#: Every column that is no threshold.
NO_THRESHOLDS = {*RUNS, *ONLINE} - {"thresholds"}


def as_frame(rows: Iterable[Row], columns: Columns) -> pd.DataFrame:
    """Rows of a file as a DataFrame: each threshold becomes a column, NaN where there is none."""
    import pandas as pd

    kept = list(rows)
    names = dict.fromkeys(name for row in kept for name in row.get("thresholds", ()))
    order = [n for column in columns for n in (names if column == "thresholds" else [column])]
    frame = pd.DataFrame([row.get("thresholds", {}) | row for row in kept], columns=order)
    whole = {
        name: "Int64"  # stays whole where another method leaves a gap
        for name in names
        if {type(row["thresholds"].get(name)) for row in kept} <= {int, type(None)}
    }
    return frame.astype(whole)


def columns_of(path: Path) -> Columns:
    """The columns of a file of runs: those of now, but where its head is the former one."""
    existing(path)
    with path.open("rb") as file:
        former = csv_line(FORMER).encode()
        return FORMER if file.readline(len(former)) == former else RUNS


def read_rows(path: Path, columns: Columns) -> list[Row]:
    """The whole lines of a CSV file; a ValueError names file, line and what was expected there."""
    return checked_rows(read_table(path, list(columns)), columns)


def checked_rows(lines: Iterable[tuple[list[str], str]], columns: Columns) -> list[Row]:
    """Rows of cells with their places, each cell as its column wants it."""
    rows: list[Row] = []
    names: set[str] = set()
    for cells, where in lines:
        try:
            pairs = zip(columns.items(), cells, strict=True)
            row = {name: kind(cell) for (name, kind), cell in pairs}
        except (ValueError, OverflowError) as error:
            said = str(cells)[:300]
            raise ValueError(f"{where}: expected {','.join(columns)}, got {said}") from error
        names.update(row.get("thresholds", ()))
        if len(names) > MOST_THRESHOLD_NAMES:  # each becomes a column as long as the file
            raise ValueError(
                f"{where}: expected at most {MOST_THRESHOLD_NAMES} names of thresholds in all"
            )
        rows.append(row)
    return rows


def row_line(row: Row, columns: Columns = RUNS) -> str:
    """A line of a CSV file with its end."""
    named = ";".join(f"{name}={value!r}" for name, value in row["thresholds"].items())
    text = {
        "thresholds": named,
        "filtered": row.get("filtered") or "",
        "seconds": round(row["seconds"], 6),
    }
    return csv_line([text.get(name, row.get(name)) for name in columns])


def csv_line(cells: Iterable[object]) -> str:
    """Cells as one line of CSV text with its end."""
    return table_text([list(cells)])


@contextmanager
def journal(path: str | Path | None) -> Iterator[tuple[list[Row], Callable[[Row], None]]]:
    """The rows of a file, which may not be there yet, and a function that adds one at once.

    A file that was cut off within a line, or within its head, is mended first; one with the former
    columns keeps them; None keeps nothing. A file that holds something else is refused.
    """
    if path is None:
        yield [], lambda row: None
        return
    path = Path(path)
    head = csv_line(RUNS).encode()
    begun = existing(path) is not None and not head.startswith(path.read_bytes())
    columns = columns_of(path) if begun else RUNS
    rows = read_rows(path, columns) if begun else []  # before it changes: it may be another file
    if path.exists():
        os.truncate(path, path.read_bytes().rfind(b"\n") + 1)
    with path.open("a", encoding="utf-8", newline="") as file:

        def add(line: str) -> None:
            """Write a whole line out of this process: it survives whatever happens to it."""
            file.write(line)
            file.flush()

        if path.stat().st_size == 0:
            add(csv_line(RUNS))
        yield rows, lambda row: add(row_line(row, columns))
