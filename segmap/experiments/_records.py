"""What a run of a method on a map gave, many of these, and the files that keep them."""

import ast
import csv
import importlib
import io
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, overload

import numpy as np

from .._display import Table

#: A threshold of a method: metres, radians, a number of scans, or None where another decides.
Threshold = float | int | None

#: Rows that a notebook shows.
MOST_ROWS = 20


@dataclass(frozen=True)
class Record:
    """One run of one method on one map.

    Parameters
    ----------
    map, method : str
    thresholds : mapping
        Name of each threshold -> metres, radians, or a number of scans.
    filtered : float, metres, or None
        Shorter segments were dropped before (A 6.2.1); None: the map as it is.
    n_before, n_after : int
        Segments of the map, after the filter, and of what the method made of it.
    reduction, quality : float
        In `[0, 1]`, both against the map after the filter.
    seconds : float
    digest : str
        Of the map before the filter; empty where it is not known.
    """

    map: str
    method: str
    thresholds: Mapping[str, Threshold]
    filtered: float | None
    n_before: int
    n_after: int
    reduction: float
    quality: float
    seconds: float
    digest: str = ""

    @property
    def words(self) -> str:
        """Thresholds to read: `distance 0.2, angle 0.175`."""
        named = (f"{name} {number_words(value)}" for name, value in self.thresholds.items())
        return ", ".join(named)


HEAD = tuple(field.name for field in fields(Record))

#: Column -> how a table words it.
WORDS: dict[str, Any] = {
    "map": lambda r: r.map,
    "method": lambda r: r.method,
    "thresholds": lambda r: r.words,
    "filtered": lambda r: filter_words(r.filtered),
    "n_before": lambda r: r.n_before,
    "n_after": lambda r: r.n_after,
    "reduction": lambda r: f"{r.reduction:.1%}",
    "quality": lambda r: f"{r.quality:.1%}",
    "seconds": lambda r: f"{r.seconds:.3g}",
}


class Records(Sequence[Record]):
    """Records in the order of the request: to index, select from, show, write and read.

    Parameters
    ----------
    records : iterable of Record

    Examples
    --------
    >>> runs = Records(
    ...     Record("hall", "fusion", {"tolerance": t}, None, 100, n, 1 - n / 100, q, 0.01)
    ...     for t, n, q in [(0.02, 60, 0.95), (0.04, 40, 0.88)])
    >>> runs.select(tolerance=0.04)
    map   method  thresholds      filtered  n_before  n_after  reduction  quality  seconds
    hall  fusion  tolerance 0.04  no        100       40       60.0%      88.0%    0.01
    """

    def __init__(self, records: Iterable[Record] = ()) -> None:
        self._records = tuple(records)

    def select(
        self,
        *,
        map: str | None = None,
        method: str | None = None,
        filtered: float | bool | None = None,
        **thresholds: Threshold,
    ) -> "Records":
        """Records of one map, of one method, with or without a filter, with some thresholds.

        Parameters
        ----------
        map, method : str or None
            None: of all.
        filtered : float, metres, bool or None
            The least length, or whether there was a filter at all; None: both.
        **thresholds
            Each to nine digits.
        """
        return Records(
            record
            for record in self
            if map in (None, record.map)
            and method in (None, record.method)
            and _filter_is(record.filtered, filtered)
            and all(_same(record.thresholds, name, value) for name, value in thresholds.items())
        )

    def table(self, *columns: str) -> Table:
        """A table of all columns, or of those that are named, in that order."""
        chosen = columns or tuple(WORDS)
        return Table(chosen, ([WORDS[name](record) for name in chosen] for record in self))

    def to_dicts(self) -> list[dict[str, Any]]:
        """One dictionary a record; thresholds remain one of their own."""
        return [asdict(record) for record in self]

    def to_frame(self) -> Any:
        """A pandas DataFrame, thresholds one column each.

        Raises
        ------
        ImportError
            Where pandas is not installed.
        """
        try:
            pandas = importlib.import_module("pandas")
        except ImportError as error:
            raise ImportError("to_frame needs pandas: pip install pandas") from error
        return pandas.DataFrame([_flat(row) for row in self.to_dicts()])

    def write(self, path: str | Path) -> None:
        """Write a CSV file, whole or not at all: under another name first, then renamed."""
        path = Path(path)
        beside = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            text = "".join(map(line_of, self))
            beside.write_text(line_of(None) + text, encoding="utf-8", newline="")
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)

    @classmethod
    def read(cls, path: str | Path) -> "Records":
        """Read a CSV file that `write` or a sweep has written.

        A last line without an end was cut off when its writer was stopped: it is left out.

        Raises
        ------
        ValueError
            Naming the file, the line and what was expected there.
        """
        text, name = Path(path).read_bytes().decode("utf-8"), Path(path).name
        whole = text[: text.rfind("\n") + 1]
        if not whole and not line_of(None).startswith(text):
            raise ValueError(f"{name}, line 1: expected the head {','.join(HEAD)}, got {text}")
        return cls(_parsed(whole, name))

    @overload
    def __getitem__(self, index: int) -> Record: ...
    @overload
    def __getitem__(self, index: slice) -> "Records": ...
    def __getitem__(self, index: int | slice) -> "Record | Records":
        return Records(self._records[index]) if isinstance(index, slice) else self._records[index]

    def __len__(self) -> int:
        return len(self._records)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Records) and self._records == other._records

    def __repr__(self) -> str:
        return "\n".join([repr(self[:MOST_ROWS].table()), *self._more()]) if self else "no records"

    def _repr_html_(self) -> str:
        more = "".join(f"<p>{text}</p>" for text in self._more())
        return self[:MOST_ROWS].table()._repr_html_() + more

    def _more(self) -> list[str]:
        left = len(self) - MOST_ROWS
        return [f"and {left} more"] if left > 0 else []


def filter_words(filtered: float | None) -> str:
    """How a table words a filter, metres."""
    return "no" if filtered is None else f"{filtered:.2f} m"


def number_words(value: Threshold) -> str:
    """A threshold to three digits."""
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def thresholds_text(thresholds: Mapping[str, Threshold]) -> str:
    """Thresholds as a file keeps them, to the last digit: `distance=0.2;angle=0.1745`."""
    plain = {k: v.item() if isinstance(v, np.generic) else v for k, v in thresholds.items()}
    return ";".join(f"{name}={value!r}" for name, value in plain.items())


def thresholds_from(text: str) -> dict[str, Threshold]:
    """Thresholds that `thresholds_text` has written."""
    pairs = (pair.split("=") for pair in text.split(";") if pair)
    return {name: ast.literal_eval(value) for name, value in pairs}


def holds_records(path: Path) -> bool:
    """Whether a CSV file holds records, by its head: others lie beside them."""
    with path.open(encoding="utf-8", newline="") as lines:
        return lines.readline() == line_of(None)


def line_of(record: Record | None) -> str:
    """A line of a CSV file with its end: of a record, or the head."""
    target = io.StringIO()
    csv.writer(target, lineterminator="\n").writerow(HEAD if record is None else _cells(record))
    return target.getvalue()


def _cells(record: Record) -> Iterator[object]:
    for name in HEAD:
        value = getattr(record, name)
        if name == "thresholds":
            yield thresholds_text(value)
        else:
            yield "" if value is None else value


def _parsed(text: str, file: str) -> Iterator[Record]:
    """Records of whole lines of CSV text; line numbers count from 1."""
    rows = csv.reader(io.StringIO(text))
    if text and (head := tuple(next(rows))) != HEAD:
        raise ValueError(
            f"{file}, line 1: expected the head {','.join(HEAD)}, got {','.join(head)}"
        )
    for row in rows:
        try:
            yield _record(dict(zip(HEAD, row, strict=True)))
        except (ValueError, SyntaxError) as error:
            said = f"{file}, line {rows.line_num}: expected a record, got {row}"
            raise ValueError(said) from error


def _record(row: dict[str, str]) -> Record:
    return Record(
        row["map"],
        row["method"],
        thresholds_from(row["thresholds"]),
        float(row["filtered"]) if row["filtered"] else None,
        int(row["n_before"]),
        int(row["n_after"]),
        float(row["reduction"]),
        float(row["quality"]),
        float(row["seconds"]),
        row["digest"],
    )


def _flat(row: dict[str, Any]) -> dict[str, Any]:
    first = {name: row[name] for name in ("map", "method")}
    return first | row["thresholds"] | {k: v for k, v in row.items() if k != "thresholds"}


def _filter_is(filtered: float | None, wanted: float | bool | None) -> bool:
    if wanted is None:
        return True
    if isinstance(wanted, bool):
        return (filtered is not None) == wanted
    return filtered is not None and bool(np.isclose(filtered, wanted, rtol=1e-9, atol=0))


def _same(thresholds: Mapping[str, Threshold], name: str, value: Threshold) -> bool:
    found = thresholds.get(name)
    if found is None or value is None:
        return name in thresholds and found is value
    return bool(np.isclose(found, value, rtol=1e-9, atol=0))
