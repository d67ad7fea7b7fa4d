"""What a file of ROS 2 could do to its reader, looked for before `rosbags` opens it."""

from __future__ import annotations

import re
import sqlite3
import struct
from contextlib import closing
from pathlib import Path

from segmap.readers.lines import LogError
from segmap.readers.packed import Budget

CHUNK_RECORD = 6
#: Bytes of a chunk before the name of its packing.
CHUNK_HEAD_BYTES = 28


def check_mcap(path: Path, budget: Budget) -> None:
    """Unpack each chunk once, within bounds; `rosbags` does so again, as a whole."""
    end = path.stat().st_size
    with path.open("rb") as file:
        file.seek(8)
        while len(head := file.read(9)) == 9:
            code, size = struct.unpack("<BQ", head)
            next_record = file.tell() + size
            if code == CHUNK_RECORD and next_record <= end:
                record = file.read(size)
                (length,) = struct.unpack_from("<I", record, CHUNK_HEAD_BYTES)
                start = CHUNK_HEAD_BYTES + 4 + length
                packing = record[CHUNK_HEAD_BYTES + 4 : start].decode("ascii", "replace")
                if packing in ("lz4", "zstd"):
                    budget.unpacked(packing, record[start + 8 :])
            if next_record > end:
                return
            file.seek(next_record)


def check_database(path: Path) -> None:
    """Refuse tables that are computed, and pages that are in use twice: either may never end."""
    uri = f"{path.resolve().as_uri()}?mode=ro&immutable=1"
    with closing(sqlite3.connect(uri, uri=True)) as database:
        for kind, sql in database.execute("SELECT type, sql FROM sqlite_master"):
            if kind not in ("table", "index") or re.search(r"(?i)\bvirtual\b|\bas\s*\(", sql or ""):
                raise LogError(path, f"holds a {kind} that no recorder makes: {(sql or '')[:80]}")
        (answer,) = database.execute("PRAGMA quick_check(1)").fetchone()
    if answer != "ok":
        raise sqlite3.DatabaseError(answer.replace("\n", " ")[:200])
