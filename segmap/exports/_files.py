"""Files that appear only when they are complete."""

from __future__ import annotations

import gzip
import os
from collections.abc import Iterable
from pathlib import Path


def write_lines(path: Path, lines: Iterable[str]) -> None:
    """Write lines of ASCII text."""
    write_bytes(path, "".join(f"{line}\n" for line in lines).encode("ascii"))


def write_bytes(path: Path, data: bytes) -> None:
    """Write beside the place and move it there; packed where the name ends in `.gz`."""
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: the folder {path.parent} does not exist")
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_bytes(gzip.compress(data, mtime=0) if path.suffix == ".gz" else data)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
