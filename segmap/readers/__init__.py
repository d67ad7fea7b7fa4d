"""Log files: whatever a robot recorded becomes a `Log`.

`read` recognises the format by what is in the file; `load` reads a log that comes with segmap.
"""

from pathlib import Path

from ..scans import Log
from . import _bundled, _carmen
from ._lines import LogError

__all__ = ["LogError", "load", "read"]


def read(path: str | Path, *, on_error: str = "raise") -> Log:
    """Read a log."""
    if on_error not in ("raise", "skip"):
        raise ValueError(f"on_error must be 'raise' or 'skip', got {on_error!r}")
    path = Path(path)
    name = path.name.removesuffix(".gz").rsplit(".", 1)[0]
    return _carmen.read(path, name, on_error)


def load(name: str) -> Log:
    """Read one of the logs that come with segmap."""
    return read(_bundled.find(name))
