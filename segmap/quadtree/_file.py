"""A tree in a file: written whole or not at all, and refused where it is of another kind."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..files import read_npz, shown, write_npz
from . import _kernels as kernels

#: What a file calls itself, with the version of its layout.
FORMAT = "segmap quadtree 1"


class Stored(NamedTuple):
    """What a file holds."""

    state: NDArray[np.int64]  #: block, level, largest, x and y of the corner, bias, scans
    lengths: Array  #: resolution, x and y of the corner, free resolution or 0, metres
    vis: kernels.Counts
    occ: kernels.Counts


def write_stored(path: Path, stored: Stored) -> None:
    """Write a file that is whole or absent."""
    write_npz(path, FORMAT, stored._asdict())


def read_stored(path: Path) -> Stored:
    """Read a file and check that it is of this kind; what a writer of ours put in it is right."""
    arrays = read_npz(path, FORMAT)
    if wrong := _fault(arrays):
        raise ValueError(f"{shown(path)}: damaged, {wrong}")
    return Stored(**arrays)


# ------------------------------------------------------------------------------- checks
def _fault(arrays: dict[str, Any]) -> str:
    """What keeps the arrays from being a map; empty where nothing does."""
    if set(arrays) != set(Stored._fields):
        return f"it holds {sorted(arrays)}, expected {sorted(Stored._fields)}"
    state, lengths, vis, occ = (arrays[name] for name in Stored._fields)
    kinds = [(state, np.int64, 7), (lengths, np.float64, 4), (vis, np.int32, vis.size)]
    for array, kind, count in [*kinds, (occ, np.int32, vis.size)]:
        if array.dtype != kind or array.shape != (count,):
            return f"an array is {array.dtype} {array.shape}, expected {np.dtype(kind)} ({count},)"
    block, level, largest, x, y, bias, scans = state.tolist()
    sizes = np.isfinite(lengths).all() and lengths[0] > 0 and 2 <= level <= largest < kernels.DEPTH
    # the root holds the square that it grew from, whose corner is cell 0, 0
    counts = bias >= 1 and 0 <= scans < kernels.FARTHEST_CELL
    if not (sizes and counts and all(0 <= -at < 1 << level for at in (x, y))):
        return "its sizes make no sense"
    return "" if 0 <= block < vis.size // 4 else "its blocks do not hang together"
