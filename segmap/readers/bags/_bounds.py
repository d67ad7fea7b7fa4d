"""What a bag would unpack to, and whether it refers to itself: looked for before it is read."""

from __future__ import annotations

import bz2
import importlib
import re
import sqlite3
import struct
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple

from ...files import MOST_UNPACKED_RATIO
from .._lines import LogError

#: A bag unpacks to at most so many bytes, or to 50 times its size: pictures shrink to a tenth,
#: a simulated laser that sees nothing to a five hundredth.
MOST_UNPACKED_BYTES = 1 << 28
#: Bytes of a metadata.yaml.
MOST_METADATA_BYTES = 1 << 22
#: Brackets in it, whose nesting costs time by its square.
MOST_BRACKETS = 10_000
CHUNK_RECORD = 6
#: Tables of a .db3, of which a copy is made where it is damaged.
RECORDER_TABLES = ("schema", "metadata", "message_definitions", "topics", "messages")
#: No table has rows beyond this number.
MOST_ROWS = 1 << 40


class Broken(NamedTuple):
    """Why a bag is not whole, and what mends a copy; of an .mcap, how many bytes are whole."""

    why: str
    whole: int = 0


class Budget:
    """How many bytes a bag may still unpack to."""

    def __init__(self, path: Path, size: int) -> None:
        self.path, self.most = path, max(MOST_UNPACKED_BYTES, MOST_UNPACKED_RATIO * size)
        self.left = self.most

    def take(self, count: int) -> None:
        """Use some of it up; where so many are not left, that is a LogError."""
        self.left -= count
        if self.left < 0:
            raise LogError(self.path, f"unpacks to more than {self.most} bytes, expected a log")

    def unpack(self, kind: str, data: bytes) -> bytes:
        """Unpack bytes of one chunk, as far as the budget goes."""
        if kind == "bz2":
            found = bz2.BZ2Decompressor().decompress(data, self.left + 1)
        elif kind == "lz4":
            frames = importlib.import_module("lz4.frame")
            found = frames.LZ4FrameDecompressor().decompress(data, self.left + 1)
        else:
            found = _zstd_bounded().ZstdDecompressor().decompress(data, self.left + 1)
        self.take(len(found))
        return found


def _zstd_bounded() -> Any:
    return importlib.import_module("rosbags.rosbag2.storage_mcap").zstd


def _check_mcap(path: Path, budget: Budget) -> Broken | None:
    """Unpack each chunk once, within bounds; `rosbags` does so again when it is wanted.

    The chunks of a file may be listed once only in its summary. Returned is where the last whole
    record ends of a file without an end.
    """
    end, starts, whole = path.stat().st_size, [], 8
    with path.open("rb") as file:
        file.seek(8)
        while len(head := file.read(9)) == 9:
            code, size = struct.unpack("<BQ", head)
            start = file.tell()
            if size > end - start:
                break
            if code == CHUNK_RECORD:
                record = file.read(size)
                (length,) = struct.unpack_from("<I", record, 28)
                kind = record[32 : 32 + length].decode("ascii", "replace")
                if kind in ("lz4", "zstd"):
                    budget.unpack(kind, record[40 + length :])
            elif code == 8:
                starts.append(file.read(24)[16:])
            file.seek(whole := start + size)
            if code == 2:
                whole = 0
                break
    if len(starts) != len(set(starts)):
        raise LogError(path, "lists a chunk twice")
    why = f"is cut off behind byte {whole}: `mcap recover` mends a copy of it"
    return Broken(why, whole) if whole else None


def _database(path: Path) -> closing[sqlite3.Connection]:
    """A database that is only read; one that is cut off too."""
    found = sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro&immutable=1", uri=True)
    found.execute("PRAGMA writable_schema = ON")  # else the size in its head must be that of it
    return closing(found)


def _check_database(path: Path) -> Broken | None:
    """Refuse tables that are none, or are computed; pages that are in use twice are damage."""
    with _database(path) as db:
        for kind, sql in db.execute("SELECT type, sql FROM sqlite_master"):
            if kind not in ("table", "index") or re.search(r"(?i)\bvirtual\b|\bas\s*\(", sql or ""):
                raise LogError(path, f"holds a {kind} that no recorder makes: {(sql or '')[:80]}")
        try:
            (said,) = db.execute("PRAGMA quick_check(1)").fetchone()
        except sqlite3.DatabaseError as fault:
            said = str(fault)
        said = said.replace("\n", " ")[:200]
        why = f"is a damaged database: {said}; `sqlite3 FILE .recover` mends a copy of it"
        return None if said == "ok" else Broken(why)


def recovered(path: Path, copy: Path) -> Path:
    """A database with the rows of a damaged one that are whole."""
    with _database(path) as old, closing(sqlite3.connect(copy)) as new:
        for table in RECORDER_TABLES:
            columns = [row[1] for row in old.execute(f"PRAGMA table_info({table})")]
            if not columns:
                continue
            names = ", ".join('"{}"'.format(name.replace('"', '""')) for name in columns)
            new.execute(f"CREATE TABLE {table} ({names})")
            marks = ", ".join("?" * len(columns))
            for row in _whole_rows(old, table):
                new.execute(f"INSERT INTO {table} VALUES ({marks})", row)
        new.commit()
    return copy


def _whole_rows(db: sqlite3.Connection, table: str) -> Iterator[tuple[Any, ...]]:
    """Rows of a table in their order, from behind what cannot be read on."""
    last, ahead = -1, 0
    while last + ahead < MOST_ROWS:
        try:
            query = f"SELECT rowid, * FROM {table} WHERE rowid > ? ORDER BY rowid"
            for number, *row in db.execute(query, (last + ahead,)):
                if number <= last:
                    raise sqlite3.DatabaseError("a page is in use twice")
                last, ahead = number, 0
                yield tuple(row)
            return
        except sqlite3.DatabaseError:
            ahead = max(2 * ahead, 1)


def check_metadata(path: Path) -> None:
    """Refuse a metadata.yaml that takes for ever, and messages that are packed one by one."""
    with path.open("rb") as file:
        text = file.read(MOST_METADATA_BYTES + 1)
    if len(text) > MOST_METADATA_BYTES or len(re.findall(rb"[\[{]", text)) > MOST_BRACKETS:
        raise LogError(path, "is larger than that of any bag")
    if b"compression_mode: message" in text.lower():
        raise LogError(path, "each message is packed: ros2 bag convert unpacks them")


def look_through(path: Path, kind: str | None, budget: Budget) -> Broken | None:
    """What a file of ROS 2 would unpack to, and whether it is whole."""
    if kind == ".mcap":
        return _check_mcap(path, budget)
    if kind == ".db3":
        return _check_database(path)
    if path.suffix in (".zstd", ".zst"):
        with _zstd_bounded().open(path, "rb") as file:
            while part := file.read(1 << 20):
                budget.take(len(part))
    return None
