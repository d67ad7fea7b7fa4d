"""A file to which a sweep adds each record as soon as it is there, and from which it goes on."""

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import IO

from ._records import Record, Records, line_of


class Journal:
    """Records in a CSV file, each a whole line before the next one begins.

    Parameters
    ----------
    path : path or None
        None keeps nothing. A last line that was cut off is dropped.

    Raises
    ------
    ValueError
        For a file that holds something else.
    """

    def __init__(self, path: str | Path | None) -> None:
        self.path = None if path is None else Path(path)
        self.records = Records()
        self._file: IO[str] | None = None

    def __enter__(self) -> "Journal":
        if self.path is not None:
            self.records = _mended(self.path)
            self._file = self.path.open("a", encoding="utf-8", newline="")
            if self.path.stat().st_size == 0:
                self._write(line_of(None))
        return self

    def __exit__(self, *error: object) -> None:
        if self._file is not None:
            self._file.close()

    def add(self, record: Record) -> None:
        """Write a record, out of this process at once: it survives whatever happens to it."""
        if self._file is not None:
            self._write(line_of(record))

    def known(self, wanted: Mapping[int, Record]) -> dict[int, Record]:
        """Of the runs that are wanted, the ones whose records are here.

        Raises
        ------
        ValueError
            Where a map of a wanted name has other segments here.
        """
        digests = {key.map: key.digest for key in wanted.values()}
        for record in self.records:
            if record.map in digests and record.digest != digests[record.map]:
                raise ValueError(
                    f"{self.path} holds records of another map called {record.map!r} (digest "
                    f"{record.digest}, now {digests[record.map]}): choose another file or name"
                )
        here = {_identity(record): record for record in self.records}
        found = {index: here.get(_identity(key)) for index, key in wanted.items()}
        return {index: record for index, record in found.items() if record is not None}

    def _write(self, line: str) -> None:
        assert self._file is not None
        self._file.write(line)
        self._file.flush()


def _identity(record: Record) -> str:
    nothing = replace(record, n_before=0, n_after=0, reduction=0.0, quality=0.0, seconds=0.0)
    thresholds = {name: record.thresholds[name] for name in sorted(record.thresholds)}
    return line_of(replace(nothing, thresholds=thresholds))


def _mended(path: Path) -> Records:
    """Records of a file, which then ends where its last whole line does."""
    if not path.exists():
        return Records()
    records = Records.read(path)  # before anything changes: it may be another file
    os.truncate(path, path.read_bytes().rfind(b"\n") + 1)
    return records
