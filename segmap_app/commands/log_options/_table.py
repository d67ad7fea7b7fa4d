"""The table of a command: a row for each log."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from segmap.files import write_bytes

#: Exit code where a log gave no map.
NO_MAP = 3


def write_table(path: Path, rows: Sequence[dict[str, Any]]) -> None:
    """A row for each log, a column for each figure: `aligned.matched` and so on."""
    text = io.StringIO()
    table = csv.DictWriter(text, list(dict.fromkeys(name for row in rows for name in row)))
    table.writeheader()
    table.writerows(rows)
    write_bytes(path, text.getvalue().encode("utf-8", "backslashreplace"))


def figures(said: dict[str, Any], begin: str = "") -> Iterator[tuple[str, Any]]:
    """Each figure with the words that lead to it."""
    for word, value in said.items():
        if isinstance(value, dict):
            yield from figures(value, f"{begin}{word}.")
        else:
            yield f"{begin}{word}", value


def read_table(path: Path | None) -> list[dict[str, Any]]:
    """The rows of a table that is there already, none where it is not."""
    with suppress(FileNotFoundError):
        if path is not None:
            with path.open(newline="", encoding="utf-8") as file:
                return [row for row in csv.DictReader(file) if row.get("source")]
    return []
