"""Files that appear only when they are complete, and tables whose every line is checked.

What is no regular file is neither read nor replaced.
"""

from __future__ import annotations

import csv
import gzip
import io
import os
import stat
import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

#: A packed file unpacks to at most this many bytes, or to this many times its own: logs shrink to a
#: third or a fifth, trees to a sixth, the most regular tree to a 23rd, and what shrinks to a
#: thousandth is made to fill the memory.
UNPACKED, RATIO = 1 << 20, 50


def existing(path: Path) -> os.stat_result | None:
    """The regular file that a path or its link leads to; None where nothing is there yet.

    Raises
    ------
    ValueError
        For a folder, a device or a pipe: reading could wait for ever, replacing would destroy it.
    OSError
        Where the path cannot be asked for, links in a circle for instance.
    """
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    if not stat.S_ISREG(found.st_mode):
        kind = "a folder" if stat.S_ISDIR(found.st_mode) else "a device or a pipe"
        raise ValueError(f"{path} is {kind}, no regular file: name a file")
    return found


@contextmanager
def replacing(path: Path, *, sync: bool = True) -> Iterator[IO[bytes]]:
    """A file written beside its place, and moved there once it is complete.

    A file that was there keeps its mode, and its owner where this user may give files away. A
    symbolic link stays, and what it leads to is replaced. With `sync` the disk has it all before;
    a recorder has no time for that.

    Raises
    ------
    ValueError, OSError
        As `existing`; for a folder that does not exist, or cannot be written to.
    """
    old, place = existing(path), Path(os.path.realpath(path))
    if not place.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: the folder {place.parent} does not exist")
    part = place.with_name(f".segmap-{os.getpid()}-{threading.get_ident()}.part")
    mode = 0o666 if old is None else 0o600
    try:
        with open(part, "wb", opener=lambda name, how: os.open(name, how, mode)) as target:
            yield target
            target.flush()
            if sync:
                os.fsync(target.fileno())
        if old is not None:
            _give(part, old)
        part.replace(place)
    finally:
        part.unlink(missing_ok=True)


def _give(part: Path, old: os.stat_result) -> None:
    """Give a new file the owner and the mode of the old one."""
    new = part.stat()
    if (new.st_uid, new.st_gid) != (old.st_uid, old.st_gid):
        for owner in (-1, old.st_uid):
            with suppress(PermissionError):
                os.chown(part, owner, old.st_gid)
    part.chmod(old.st_mode & 0o777)


def write_lines(path: Path, lines: Iterable[str]) -> None:
    """Write lines of ASCII text."""
    write_bytes(path, "".join(f"{line}\n" for line in lines).encode("ascii"))


def write_bytes(path: Path, data: bytes) -> None:
    """Write bytes, packed where the name ends in `.gz`."""
    with replacing(path) as target:
        target.write(packed(data) if path.suffix == ".gz" else data)


def packed(data: bytes) -> bytes:
    """Bytes as gzip, never so small that a reader takes them for a bomb."""
    found = gzip.compress(data, mtime=0)
    bomb = len(data) > max(UNPACKED, RATIO * len(found))
    return gzip.compress(data, 0, mtime=0) if bomb else found


# ------------------------------------------------------------------------------ tables
def table_text(rows: Iterable[Sequence[object]]) -> str:
    """Rows of cells as CSV text, a line each."""
    target = io.StringIO()
    csv.writer(target, lineterminator="\n").writerows(rows)
    return target.getvalue()


def read_table(path: Path, head: Sequence[str]) -> Iterator[tuple[list[str], str]]:
    """Cells of each line below the head of a CSV file, and where they stand, for an error.

    A last line without an end was cut off when its writer was stopped: it is left out.

    Raises
    ------
    ValueError
        Naming file and line: another head, bytes that are no text, quotes that do not end.
    """
    existing(path)
    return table_lines(path.read_bytes(), path.name, head)


def table_lines(data: bytes, name: str, head: Sequence[str]) -> Iterator[tuple[list[str], str]]:
    """The same of bytes that such a file holds."""
    data = data[: data.rfind(b"\n") + 1] or data
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise ValueError(f"{name}, line {line}: expected text in UTF-8, got {error}") from error
    rows = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        first = next(rows, [])
        if first != list(head):
            said = ",".join(first)[:200]
            raise ValueError(f"{name}, line 1: expected the head {','.join(head)}, got {said}")
        for cells in rows:
            yield cells, f"{name}, line {rows.line_num}"
    except csv.Error as error:
        raise ValueError(f"{name}, line {rows.line_num}: expected a CSV line, {error}") from error
