"""The table of a command: a row for each log."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from segmap.files import write_bytes

#: Exit code where a log gave no map.
NO_MAP = 3


def write_table(path: Path, rows: Sequence[dict[str, Any]]) -> None:
    """A row for each log, a column for each figure: `aligned.matched` and so on."""
    import pandas as pd

    text = pd.json_normalize(list(rows)).convert_dtypes().to_csv(index=False)
    write_bytes(path, text.encode("utf-8", "backslashreplace"))


def read_table(path: Path | None) -> list[dict[str, Any]]:
    """The rows of a table that is there already, none where it is not."""
    import pandas as pd

    with suppress(FileNotFoundError, pd.errors.EmptyDataError):
        if path is not None:
            table: Any = pd.read_csv(path, dtype=str, keep_default_na=False)
            return [row for row in table.to_dict("records") if row.get("source")]
    return []
