"""What every map of a log begins and ends with: a pose for each scan, and why it holds nothing."""

from __future__ import annotations

import numpy as np

from .. import arrays
from ..arrays import Array, Poses, unit_checks
from ._scans import Log


def checked_poses(log: Log, poses: Poses) -> Array:
    """Poses of an alignment or an array, `(k, 3)`, metres and radians: one a scan, or ValueError.

    Rows of NaN have no pose.
    """
    arrays.instance(log, "log", Log)
    if poses is None:
        raise ValueError(
            f"poses must have shape ({len(log)}, 3), got None: this log has no such poses"
        )
    return arrays.poses(poses, count=len(log), missing=True)


def warn_if_empty_map(empty: bool, log: Log, poses: Array, nothing: str) -> None:
    """Say why a map of a log is empty: scans without pose `(k, 3)` or valid beam, or `nothing`."""
    if not empty or not len(log):
        return
    placed = [scan for scan, row in zip(log, poses, strict=True) if np.isfinite(row).all()]
    blind = [scan for scan in placed if not scan.valid.any()]
    beams = np.concatenate([np.empty(0), *(scan.ranges for scan in blind)])
    infinite, low = int((~np.isfinite(beams)).sum()), int((beams <= 0).sum())
    why = (
        f"with no valid beam (of their {len(beams)} beams {infinite} not finite, {low} not above 0"
    )
    why += f", {len(beams) - infinite - low} at max_range or beyond)"
    parts = [(len(log) - len(placed), "without a pose (NaN)"), (len(blind), why)]
    parts.append((len(placed) - len(blind), nothing))
    reasons = ", ".join(f"{count} of {len(log)} scans {text}" for count, text in parts if count)
    text = f"the map of log {log.name!r} is empty: {reasons}"
    unit_checks.warn(text)
