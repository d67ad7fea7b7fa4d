"""Lines of a text file, plain or gzip, within bounds, and what to do about damaged ones."""

import gzip
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, TypeVar, cast

from ..scans import NOTHING_SKIPPED, Skipped

#: No line of a log is longer, in bytes: 1000 beams with intensities take 20 000.
MAX_LINE = 1 << 20
#: What a damaged or wrong gzip stream raises while it is read.
BROKEN_GZIP = (EOFError, gzip.BadGzipFile, zlib.error)

T = TypeVar("T")


class LogError(ValueError):
    """A file that is no log, or a damaged one.

    Attributes
    ----------
    path : Path
    line : int or None
        Number of the line, from 1, where the fault lies in one.
    reason : str
        What was found and what was expected.

    Examples
    --------
    >>> raise LogError(Path("intel.log"), "no range, expected 180", line=7)
    Traceback (most recent call last):
    segmap.readers._lines.LogError: intel.log, line 7: no range, expected 180
    """

    def __init__(self, path: Path, reason: str, line: int | None = None) -> None:
        place = f"{path}, line {line}" if line else f"{path}"
        super().__init__(f"{place}: {reason}")
        self.path, self.line, self.reason = path, line, reason


class Lines:
    """The fields of each line of a file; empty lines and comments (`#`) are left out.

    Parameters
    ----------
    path : Path
    on_error : "raise" or "skip"
        Whether the first damaged line ends the reading or is only counted in `.skipped`.
    separator : str or None
        Between fields; None for white space.
    """

    def __init__(self, path: Path, on_error: str = "raise", separator: str | None = None) -> None:
        self.path, self.on_error, self.separator = path, on_error, separator
        self.number = 0
        self.skipped = NOTHING_SKIPPED

    def error(self, reason: str) -> LogError:
        """An error about the line that was read last."""
        return LogError(self.path, reason, self.number)

    def damaged(self, reason: str) -> None:
        """Report the present line as damaged: raise, or count it."""
        if self.on_error == "raise":
            raise self.error(reason)
        first = self.skipped.reason or str(self.error(reason))
        self.skipped = Skipped(self.skipped.lines + 1, first)

    def no_scan(self, expected: str) -> LogError:
        """An error about a file that has been read to its end in vain."""
        if self.number == 0:
            return LogError(self.path, f"is empty, expected {expected}")
        found = f"; first damaged: {self.skipped.reason}" if self.skipped else ""
        return LogError(self.path, f"holds no scan, expected {expected}{found}")

    def each(self, parse: Callable[[list[str]], T]) -> Iterator[T]:
        """What `parse` makes of the fields of each line; its ValueError tells of a damaged one."""
        for fields in self:
            try:
                parsed = parse(fields)
            except ValueError as fault:
                self.damaged(str(fault))
            else:
                yield parsed

    def __iter__(self) -> Iterator[list[str]]:
        for line in self._decoded():
            fields = line.split(self.separator)
            if line and not line.startswith("#") and fields:
                yield fields

    def _decoded(self) -> Iterator[str]:
        try:
            with open_bytes(self.path) as file:
                yield from self._bounded(file)
        except BROKEN_GZIP as fault:
            self.damaged(f"the gzip stream is broken ({fault}), expected it to go on")
        except OSError as fault:
            raise LogError(self.path, f"cannot be read ({fault.strerror or fault})") from fault

    def _bounded(self, file: IO[bytes]) -> Iterator[str]:
        self.number = 0
        while line := file.readline(MAX_LINE + 1):
            self.number += 1
            if len(line) > MAX_LINE:
                raise self.error(f"longer than {MAX_LINE} bytes, expected a line of a log")
            yield line.decode("ascii", "replace").strip()


def open_bytes(path: Path) -> IO[bytes]:
    """Open a file for reading, through gzip where its first bytes say so."""
    with path.open("rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
    return cast(IO[bytes], gzip.open(path, "rb")) if packed else path.open("rb")
