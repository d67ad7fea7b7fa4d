"""Arrays in an NPZ file of numpy's: the shortest way from a script of one's own to a log.

    np.savez("mine.npz", ranges=ranges, angles=angles, odometry=odometry, times=times)

`ranges` is `(k, n)`, or `(n,)` for one scan; `angles` `(n,)`, or `(k, n)` where they differ from
scan to scan. `odometry` and `truth`, `(k, 3)`, and `times`, `(k,)`, may be left out: scans are
numbered then. Metres, radians counter-clockwise, seconds. A range that is not finite or not
positive is no measurement. Other arrays are left out; nothing is unpickled.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import arrays
from ...arrays import Array
from ...files import read_arrays
from ...scans import LaserScan, Log
from .._lines import LATEST, LogError

NEEDED = ("ranges", "angles")
#: Where a zip file holds the length of the first name, and the name.
NAME_LENGTH, NAME = 26, 30


def claims(path: Path) -> bool:
    """Whether a file is a zip whose first member is an array."""
    with path.open("rb") as file:
        start = file.read(NAME + 300)
    length = int.from_bytes(start[NAME_LENGTH : NAME_LENGTH + 2], "little")
    return start.startswith(b"PK\x03\x04") and start[NAME : NAME + length].endswith(b".npy")


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read arrays: whole or not at all, whatever `on_error`."""
    try:
        held = read_arrays(path)
    except ValueError as fault:
        raise LogError(path, str(fault).removeprefix(f"{path}: ")) from fault
    if missing := [needed for needed in NEEDED if needed not in held]:
        known = ", ".join(sorted(held)[:10])
        raise LogError(
            path, f"expected arrays {' and '.join(NEEDED)}, got {known}; no {missing[0]}"
        )
    try:
        return _log(name, held)
    except ValueError as fault:
        raise LogError(path, str(fault)) from fault


def _log(name: str, held: Mapping[str, NDArray[Any]]) -> Log:
    ranges = np.atleast_2d(arrays.numbers(held["ranges"], "ranges"))
    if ranges.ndim != 2 or not len(ranges):
        raise ValueError(f"ranges must have shape (k, n), got {ranges.shape}")
    angles = _angles(held["angles"], ranges.shape)
    times = _times(held.get("times"), len(ranges))
    odometry = _poses(held, "odometry", len(ranges))
    scans = [
        LaserScan(np.where(r > 0, r, np.nan), a, t, None if np.isnan(o).any() else o)
        for r, a, t, o in zip(ranges, angles, times, odometry, strict=True)
    ]
    truth = _poses(held, "truth", len(ranges))
    return Log(name, scans, truth if np.isfinite(truth).any() else None)


def _angles(given: NDArray[Any], shape: tuple[int, ...]) -> Array:
    found = arrays.numbers(given, "angles")
    if found.shape not in (shape, shape[1:]):
        raise ValueError(f"angles must have shape {shape[1:]} or {shape}, got {found.shape}")
    return np.broadcast_to(found, shape)


def _times(given: NDArray[Any] | None, count: int) -> Array:
    if given is None:
        return np.arange(count, dtype=float)
    found = np.atleast_1d(arrays.numbers(given, "times"))
    if found.shape != (count,) or not (np.abs(found) <= LATEST).all():
        raise ValueError(f"times must be ({count},) finite seconds, got shape {found.shape}")
    return found


def _poses(held: Mapping[str, NDArray[Any]], name: str, count: int) -> Array:
    if name not in held:
        return np.full((count, 3), np.nan)
    return arrays.poses(np.atleast_2d(held[name]), name, count=count, missing=True)
