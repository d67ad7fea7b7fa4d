"""The CSV files of runs: pandas reads and writes them, a line a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files import escape, stat_file, write_bytes

if TYPE_CHECKING:
    import pandas as pd

#: A threshold of a method: metres, radians, a number of scans, or None where another decides.
Threshold = float | int | None
#: One run: the name of each column -> its value; `thresholds` is a dictionary.
Row = dict[str, Any]

#: What a sweep writes.
RUN_COLUMNS = [
    *("map", "method", "thresholds", "filtered", "n_before", "n_after", "reduction", "quality"),
    *("seconds", "invented", "missed"),
]
#: Columns that hold numbers.
NUMBER_COLUMNS: dict[str, Callable[[str], float]] = {
    **dict.fromkeys(("n_before", "n_after"), int),
    **dict.fromkeys(
        ("filtered", "reduction", "quality", "seconds", "invented", "missed"),
        lambda text: float(text or "nan"),
    ),
}
#: Every column, also of `load_online`, that is no threshold.
NO_THRESHOLDS = {*RUN_COLUMNS, "scans", "live"} - {"thresholds"}
#: Words that are thresholds.
WORDS: dict[str, Threshold] = {"None": None, "True": True, "False": False}


def as_frame(rows: Iterable[Row]) -> pd.DataFrame:
    """Runs as a DataFrame: each threshold becomes a column, NaN where there is none."""
    import pandas as pd

    runs = list(rows)
    names = dict.fromkeys(name for row in runs for name in row["thresholds"])
    before, after = RUN_COLUMNS[:2], RUN_COLUMNS[3:]
    frame = pd.DataFrame(
        [row["thresholds"] | row for row in runs], columns=[*before, *names, *after]
    )
    whole = {
        name: "Int64"  # stays whole where another method leaves a gap
        for name in names
        if {type(row["thresholds"].get(name)) for row in runs} <= {int, type(None)}
    }
    return frame.astype(whole)


def read_rows(path: Path) -> list[Row]:
    """The lines of a file of runs; a ValueError where it is none."""
    import pandas as pd

    stat_file(path)
    of_column: Any = {"map": str, "method": str, "thresholds": thresholds_in, **NUMBER_COLUMNS}
    try:
        cells = pd.read_csv(path, converters=of_column)[RUN_COLUMNS].fillna({"filtered": 0.0})
    except (ValueError, KeyError) as error:
        columns = ",".join(RUN_COLUMNS)
        raise ValueError(
            f"{escape(path.name)}: expected a CSV file of runs, {columns} ({escape(error)})"
        ) from error
    return cells.to_dict("records")  # type: ignore[return-value]


def thresholds_in(text: str) -> dict[str, Threshold]:
    """Thresholds as a file keeps them, to the last digit: `distance=0.2;angle=0.1745`."""
    pairs = (pair.split("=") for pair in text.split(";") if pair)
    return {name: WORDS[value] if value in WORDS else _value_of(value) for name, value in pairs}


def _value_of(text: str) -> float:
    return int(text) if text.lstrip("-").isdecimal() else float(text)


def write_rows(path: Path, rows: Iterable[Row]) -> None:
    """Write runs as CSV, whole or not at all; halves of letters in a name are written out."""
    import pandas as pd

    named = (
        row | {"thresholds": ";".join(f"{k}={v!r}" for k, v in row["thresholds"].items())}
        for row in rows
    )
    text = pd.DataFrame(named, columns=RUN_COLUMNS).to_csv(index=False, lineterminator="\n")
    write_bytes(path, text.encode("utf-8", "backslashreplace"))
