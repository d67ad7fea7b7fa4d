"""The path that a user names: it must lead to a file, and what is wrong with it is a LogError."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .. import arrays
from ._lines import LogError


def named(path: str | Path) -> Path:
    """The path of a log; a name that no file can have is an error of the log."""
    if isinstance(path, str) and "\0" in path:
        raise LogError(Path(path), "a path has no NUL in it, expected that of a log")
    return arrays.file(path)


@contextmanager
def asking(path: Path) -> Iterator[None]:
    """Turn what the operating system refuses, links in a circle too, into a LogError."""
    try:
        yield
    except (OSError, RuntimeError) as fault:
        reason = getattr(fault, "strerror", None) or fault
        raise LogError(path, f"cannot be read ({reason})") from fault


def checked_file(path: Path) -> Path:
    """The path, where a regular file is."""
    if not path.is_file():
        found = "is no file" if path.exists() else "does not exist"
        raise LogError(path, f"{found}, expected a log file or a folder of one")
    return path


def stem(name: str) -> str:
    """The name of a log: that of its file, without what tells its kind."""
    return name.removesuffix(".gz").removesuffix(".zip").rsplit(".", 1)[0]
