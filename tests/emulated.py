"""A world whose scans betray a single wrong range, and what the laser's tests share."""

import os
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

SHARED = Path(__file__).resolve().parents[1].parent / "shared" / "data"

needs_terminals = pytest.mark.skipif(
    not hasattr(os, "openpty") or sys.platform == "win32",
    reason="the emulator needs pseudo-terminals, which Windows has not",
)


def capture(name: str) -> bytes:
    """The bytes of a capture beside the project."""
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"{name} lies beside the project and is absent here; it may not be shipped")
    from segmap.readers._lines import open_bytes

    with open_bytes(path) as file:
        return file.read()


def pattern(turn: int) -> np.ndarray:
    """Millimetres that grow by 31 a step and by 7919 a turn, modulo 3900, from 100 on."""
    return 100 + (7919 * turn + 31 * np.arange(769)) % 3900


def turn_of(scan, first: int = 44) -> int:
    """Which turn (modulo 3900) of `pattern` a scan shows; fails where one beam is of another."""
    met = np.rint(1000 * scan.ranges).astype(int)
    starts = (met - 100 - 31 * (first + np.arange(len(met)))) % 3900
    assert (starts == starts[0]).all(), "a range that the sensor never measured"
    return int(starts[0]) * pow(7919, -1, 3900) % 3900


def open_files() -> int:
    """Files that this process holds open; 0 where the system does not tell."""
    folder = Path("/proc/self/fd")
    return len(list(folder.iterdir())) if folder.exists() else 0


def emulator_threads() -> list[str]:
    return [t.name for t in threading.enumerate() if t.name == "URG emulator"]
