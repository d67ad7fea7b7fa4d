"""The CSV files that keep runs, line by line, and the DataFrames that are made of them."""

from __future__ import annotations

import ast
import csv
import io
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

#: A threshold of a method: metres, radians, a number of scans, or None where another decides.
Threshold = float | int | None
#: One line of a file: the name of each column -> its value; `thresholds` is a dictionary.
Row = dict[str, Any]
#: The columns of a file in their order, and how each is read.
Columns = Mapping[str, Callable[[str], Any]]


def _thresholds(text: str) -> dict[str, Threshold]:
    """Thresholds as a file keeps them, to the last digit: `distance=0.2;angle=0.1745`."""
    pairs = (pair.split("=") for pair in text.split(";") if pair)
    return {name: ast.literal_eval(value) for name, value in pairs}


#: What a sweep writes. A filter of 0 m, an empty cell, drops nothing.
RUNS: Columns = {
    "map": str,
    "method": str,
    "thresholds": _thresholds,
    "filtered": lambda cell: float(cell or 0),
    "n_before": int,
    "n_after": int,
    "reduction": float,
    "quality": float,
    "seconds": float,
    "digest": str,
}
ONLINE: Columns = {
    "method": str,
    "thresholds": _thresholds,
    "scans": int,
    "seconds": float,
    "live": int,
}
ALIGNMENTS: Columns = {
    **dict.fromkeys(("log", "method"), str),
    **dict.fromkeys(("scans", "used", "compared"), int),
    **dict.fromkeys(("mean", "deviation", "rms", "p95", "largest", "above_0.2"), float),
    **dict.fromkeys(("heading", "seconds"), float),
}
#: Every column that is no threshold.
NAMES = {*RUNS, *ONLINE} - {"thresholds"}


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


def read_rows(path: Path, columns: Columns) -> list[Row]:
    """The whole lines of a CSV file.

    Raises
    ------
    ValueError
        Naming the file, the line and what was expected there.
    """
    text = path.read_bytes().decode("utf-8")
    lines = csv.reader(io.StringIO(text[: text.rfind("\n") + 1]))
    if (head := next(lines, [])) != list(columns):
        said = ",".join(head) or text
        raise ValueError(f"{path.name}, line 1: expected the head {','.join(columns)}, got {said}")
    return [_row(cells, columns, f"{path.name}, line {lines.line_num}") for cells in lines]


def _row(cells: list[str], columns: Columns, where: str) -> Row:
    try:
        pairs = zip(columns.items(), cells, strict=True)
        return {name: kind(cell) for (name, kind), cell in pairs}
    except (ValueError, SyntaxError) as error:
        raise ValueError(f"{where}: expected {','.join(columns)}, got {cells}") from error


def line_of(row: Row, columns: Columns = RUNS) -> str:
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
    target = io.StringIO()
    csv.writer(target, lineterminator="\n").writerow(cells)
    return target.getvalue()


@contextmanager
def journal(path: str | Path | None) -> Iterator[tuple[list[Row], Callable[[Row], None]]]:
    """The rows of a file, which may not be there yet, and a function that adds one at once.

    A file that was cut off within a line, or within its head, is mended first. None keeps nothing.

    Raises
    ------
    ValueError
        For a file that holds something else.
    """
    if path is None:
        yield [], lambda row: None
        return
    path = Path(path)
    begun = path.exists() and not csv_line(RUNS).startswith(path.read_bytes().decode("utf-8"))
    rows = read_rows(path, RUNS) if begun else []  # before anything changes: it may be another file
    if path.exists():
        os.truncate(path, path.read_bytes().rfind(b"\n") + 1)
    with path.open("a", encoding="utf-8", newline="") as file:

        def add(line: str) -> None:
            """Write a whole line out of this process: it survives whatever happens to it."""
            file.write(line)
            file.flush()

        if path.stat().st_size == 0:
            add(csv_line(RUNS))
        yield rows, lambda row: add(line_of(row))
