"""A file that a user names, its lines within bounds, damaged ones, and numbers out of fields."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Literal, TypeVar

import numpy as np

from ..arrays import LIMIT, Array
from ..files import escape
from ..progress import announce
from ..scans import NOTHING_SKIPPED, Skipped

#: No line of a log is longer, in bytes: 1000 beams with intensities take 20 000.
MAX_LINE = 1 << 20
#: How far the reading is, is told every so many lines.
LINES_PER_ANNOUNCEMENT = 200
#: What stands about a line and is none of it: white space but tabs, which separate fields, what an
#: XV-11 sends after its answers, and what a disk holds that lost power.
STRIPPED = " \r\n\v\f\x1a\0"
#: Later than this, in seconds, no clock stands.
LATEST_TIME_S = 1e12

#: A beam points nowhere beyond two turns, radians.
MOST_DIRECTION_RAD = 4 * np.pi
#: Fields of tables that say that nothing was measured.
NOT_MEASURED = (
    *("", "nan", "-nan", "null", "none", "na", "n/a", "#n/a", "-", "--", "---", "-inf"),
    *("-infinity", "1.#inf", "-1.#inf", "1.#ind", "-1.#ind", "1.#qnan", "-1.#qnan", "#num!"),
    *("#value!", "err", "error", "error:", "ol", "oor", "out of range", "timeout", "invalid"),
)
#: What a damaged line means: the end of reading, or one line less.
OnError = Literal["raise", "skip"]
T = TypeVar("T")


class LogError(ValueError):
    """A file that is no log, or a damaged one.

    It holds the `path`, the number of the `line`, from 1, where the fault lies in one, and the
    `reason`: what was found and what was expected.

    Examples
    --------
    >>> raise LogError(Path("intel.log"), "no range, expected 180", line=7)
    Traceback (most recent call last):
    segmap.readers.lines.LogError: intel.log, line 7: no range, expected 180
    """

    def __init__(self, path: Path, reason: str, line: int | None = None) -> None:
        place = f"{escape(path)}, line {line}" if line else escape(path)
        lines = reason.split("\n") if isinstance(self, UnknownFormat | HeadError) else [reason]
        message = "\n".join(map(escape, lines))  # what to do takes several
        super().__init__(f"{place}: {message}")
        self.path, self.line, self.reason = path, line, reason

    def __reduce__(self) -> tuple[type[LogError], tuple[Path, str, int | None]]:
        return type(self), (self.path, self.reason, self.line)  # from another process too


class UnknownFormat(LogError):
    """A file or folder that is no log of any format: in a folder of logs it may be passed over."""


class HeadError(LogError):
    """A table that does not say what its columns are: no line of it is at fault."""


class Reading:
    """A file while it is read: damage ends the reading ("raise"), or is counted ("skip")."""

    def __init__(self, path: Path, on_error: str = "raise") -> None:
        self.path, self.on_error, self.skipped = path, on_error, NOTHING_SKIPPED
        self.first: LogError | None = None

    def leave_out(self, fault: LogError) -> None:
        """End the reading, or leave out what is damaged, and keep the reason of the first."""
        if self.on_error == "raise":
            raise fault
        self.first = self.first or fault
        self.skipped = merged_skipped(self.skipped, Skipped(1, str(fault)))

    def why(self) -> str:
        """What was left out, for the error of a file that holds nothing else."""
        return f"; {self.skipped.lines} left out: {self.skipped.reason}" if self.skipped else ""


class Lines(Reading):
    """The fields of each line of a file; empty lines and `comments` are left out.

    Fields are separated by white space where `separator` is None.
    """

    def __init__(
        self,
        path: Path,
        on_error: str = "raise",
        separator: str | None = None,
        comments: str | tuple[str, ...] = "#",
    ) -> None:
        super().__init__(path, on_error)
        self.separator, self.comments, self.number = separator, comments, 0

    def error(self, reason: str) -> LogError:
        """An error about the line that was read last."""
        return LogError(self.path, reason, self.number)

    def no_scan(self, expected: str) -> LogError:
        """An error about a file that was read to its end and holds no scan."""
        if self.number == 0:
            return LogError(self.path, f"is empty, expected {expected}")
        damage = f"; damaged line {self.first.line}: {self.first.reason}" if self.first else ""
        return LogError(self.path, f"holds no scan, expected {expected}{damage}")

    def each(self, parse: Callable[[list[str]], T]) -> Iterator[T]:
        """The fields of each line, parsed; a ValueError of `parse` marks the line as damaged.

        A LogError ends the reading.
        """
        for fields in self:
            try:
                parsed = parse(fields)
            except LogError:
                raise
            except ValueError as fault:
                error = self.error(str(fault))
            else:
                yield parsed
                continue
            self.leave_out(error)

    def __iter__(self) -> Iterator[list[str]]:
        self.number = 0
        size = self.path.stat().st_size
        with self.path.open("rb") as file:
            while line := file.readline(MAX_LINE + 1):
                self.number += 1
                if self.number % LINES_PER_ANNOUNCEMENT == 0:
                    announce(min(file.tell() / max(size, 1), 1.0), f"reading line {self.number}")
                if len(line) > MAX_LINE:
                    raise self.error(f"longer than {MAX_LINE} bytes, expected a line of a log")
                text = line.decode("utf-8-sig", "replace").strip(STRIPPED)
                fields = text.split(self.separator)
                comment = bool(self.comments) and text.startswith(self.comments)
                if text and not (comment or text.isspace()):
                    yield fields


def stem(path: Path) -> str:
    """The name of a log: that of its file, without what tells its kind."""
    return re.sub(r"\.(gz|xz|bz2)$", "", path.resolve().name).rsplit(".", 1)[0]


def merged_skipped(first: Skipped, second: Skipped) -> Skipped:
    """What was skipped in two files together, with the reason of the first."""
    return Skipped(first.lines + second.lines, first.reason or second.reason)


# ----------------------------------------------------------------------------- fields
def float_fields(fields: Sequence[str], what: str) -> Array:
    """Fields as floats, `(n,)` array, in the unit of the file."""
    try:
        numbers = np.array(fields, float)
    except (ValueError, OverflowError):
        numbers = None
    if numbers is None or any("_" in field for field in fields):
        bad = next((f for f in fields if not is_number(f)), "")
        raise ValueError(f"expected numbers for {what}, got {bad[:40]!r}")
    return numbers


def is_number(field: str) -> bool:
    """Whether a field is a number; underscores, which Python allows in one, are refused."""
    try:
        float(field)
    except ValueError:
        return False
    return "_" not in field


def pose_fields(fields: Sequence[str], what: str) -> Array:
    """Three fields as a (3,) array, metres and radians; three times `nan` where there is none."""
    pose = float_fields(fields, what)
    if len(pose) != 3:
        raise ValueError(f"expected x, y, heading for {what}, got {len(pose)} fields")
    if not (np.isnan(pose).all() or (np.abs(pose) <= LIMIT).all()):
        raise ValueError(f"expected metres and radians for {what}, got {' '.join(fields)[:80]}")
    return pose


def time(field: str, what: str = "the time", unit: float = 1.0) -> float:
    """A field in units of `unit` seconds as seconds."""
    seconds = float(float_fields([field], what)[0]) * unit
    if not abs(seconds) <= LATEST_TIME_S:
        raise ValueError(f"expected seconds for {what}, got {field[:40]!r}")
    return seconds


def counted_fields(
    fields: Sequence[str], what: str, least: int = 1
) -> tuple[Sequence[str], Sequence[str]]:
    """Split `n f1 ... fn rest` into the n fields that the first one announces, and the rest."""
    field, rest = (fields[0], fields[1:]) if fields else ("", ())
    if not re.fullmatch("[0-9]{1,18}", field):
        raise ValueError(f"expected the number of {what}, got {field[:40]!r}")
    if not least <= int(field) <= len(rest):
        raise ValueError(f"announces {int(field)} {what}, but {len(rest)} fields follow")
    return rest[: int(field)], rest[int(field) :]
