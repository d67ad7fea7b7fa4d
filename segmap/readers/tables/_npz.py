"""Arrays in an NPZ file of numpy's: the shortest way from a script of one's own to a log.

    np.savez("mine.npz", ranges=ranges, angles=angles, odometry=odometry, times=times)

`ranges` is `(k, n)`, or `(n,)` for one scan; `angles` `(n,)`, or `(k, n)` where they differ from
scan to scan. `odometry` and `truth`, `(k, 3)`, and `times`, `(k,)`, NaN where a scan has none, may
be left out. So may `max_range`, one number or `(k,)`, the `sensor_pose` on the robot, `(3,)` or
`(k, 3)`, the sensor's `codes`, `(k, n)`, and the `delays` of the beams, `(n,)` or `(k, n)`; with
`order_known` these are as in `LaserScan` and `Log`. Scans
that are shorter than the longest have so many `beams`, `(k,)`, at the front of their row. Metres,
radians counter-clockwise, seconds. A range that is not finite or not positive is no measurement.
Other arrays are left out and told; nothing is unpickled.

Assumed: without `sensor_pose` the laser sits at the robot's centre. What another reader `assumed`
of a log that segmap wrote is kept, an array of texts.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import arrays
from ...arrays import Array
from ...files import escape, members, read_arrays
from ...progress import each
from ...scans import LaserScan, Log
from ..lines import LATEST_TIME_S, LogError
from ..raw_scans import known_truth, or_none, place_of
from ..text import Binary

NEEDED = ("ranges", "angles")
KNOWN = {
    *NEEDED, "odometry", "truth", "times", "max_range", "sensor_pose", "codes", "delays",
    "order_known", "beams", "assumed", "format", "session.json",
}  # fmt: skip


def claims(path: Path) -> bool:
    """Whether a file is a zip that holds an array."""
    return any(name.endswith(".npy") for name in members(path))


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read arrays: whole or not at all, whatever `on_error`."""
    try:
        by_name = read_arrays(path)
    except ValueError as fault:
        raise LogError(path, str(fault).removeprefix(f"{escape(path)}: ")) from fault
    if missing := [needed for needed in NEEDED if needed not in by_name]:
        got = f"got {', '.join(sorted(by_name))[:80]}; no {missing[0]}"
        raise LogError(path, f"expected arrays {' and '.join(NEEDED)}, {got}")
    try:
        return log_from_arrays(name, by_name)
    except ValueError as fault:
        raise LogError(path, str(fault)) from fault


ARRAYS = Binary("NPZ", claims, read)


def log_from_arrays(name: str, by_name: Mapping[str, NDArray[Any]]) -> Log:
    """A log of arrays by their names."""
    ranges = np.atleast_2d(arrays.numbers(by_name["ranges"], "ranges"))
    if ranges.ndim != 2 or not len(ranges):
        raise ValueError(f"ranges must have shape (k, n), got {ranges.shape}")
    shape, count = ranges.shape, len(ranges)
    angles = _each(by_name, "angles", np.empty(0), *shape)
    times = _each(by_name, "times", np.array(np.nan), count)
    is_known = np.isfinite(times) & (np.abs(times) <= LATEST_TIME_S)
    if not (is_known | np.isnan(times)).all() or ("times" in by_name and not is_known.any()):
        raise ValueError(f"times must be ({count},) finite seconds, NaN where a scan has none")
    odometry, truth = (
        arrays.poses(np.atleast_2d(by_name[kind]), kind, count=count, missing=True)
        if kind in by_name
        else np.full((count, 3), np.nan)
        for kind in ("odometry", "truth")
    )
    places = _each(by_name, "sensor_pose", np.zeros(3), count, 3)
    most = _each(by_name, "max_range", np.array(np.inf), count)
    codes = _each(by_name, "codes", np.empty(0), *shape) if "codes" in by_name else None
    delays = _each(by_name, "delays", np.full(shape[1], np.nan), *shape)
    beams = arrays.indices(by_name.get("beams", np.full(count, shape[1])), "beams")
    if beams.shape != (count,) or not ((beams >= 0) & (beams <= shape[1])).all():
        raise ValueError(f"beams must be {count} numbers from 0 to {shape[1]}")
    far, scans = np.where(ranges > 0, ranges, np.nan), list[LaserScan]()
    for k in each(range(count), "reading scan"):
        part = slice(int(beams[k]))
        place = times[k], or_none(odometry[k]), most[k], places[k]
        code = None if codes is None else codes[k, part]
        scans.append(
            LaserScan(far[k, part], angles[k, part], *place, code, or_none(delays[k, part]))
        )
    ordered = arrays.switch(by_name.get("order_known", np.array(True)).tolist(), "order_known")
    assumed = list(map(str, np.ravel(by_name.get("assumed", ())).tolist()))
    if "sensor_pose" not in by_name and {"odometry", "truth"} & set(by_name):
        assumed.append(place_of(np.zeros(3)))
    if others := sorted({*by_name} - KNOWN):
        assumed.append(f"left out: {', '.join(map(escape, others))[:80]}")
    return Log(name, scans, known_truth(truth), order_known=ordered, assumed=assumed)


def _each(
    by_name: Mapping[str, NDArray[Any]], name: str, default: Array, count: int, *row: int
) -> Array:
    """An array that stands once for all scans, of shape `row`, or once for each of `count`."""
    rows = arrays.numbers(by_name.get(name, default), name)
    if rows.shape not in (row, (count, *row)):
        raise ValueError(f"{name} must have shape {row} or {(count, *row)}, got {rows.shape}")
    return np.broadcast_to(rows, (count, *row))
