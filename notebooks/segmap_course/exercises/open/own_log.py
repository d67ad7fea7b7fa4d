"""The open exercise on a log of one's own: read, registered, made into a map with walls."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from segmap.alignment import Alignment
from segmap.arrays import Array
from segmap.extraction import build_map
from segmap.poses import between
from segmap.readers import load
from segmap.scans import Log
from segmap.segments import length

from .._exercise import Check
from ._open import Open

#: The logs that come with segmap: none of them is a log of one's own.
BUNDLED = ("clinic", "corridor", "malaga", "room")
#: A map is made from so many scans at most, evenly chosen.
MOST_SCANS = 200
#: What the log and its map must have at least; walls are segments of 1 m and more.
WANTED = {"scans": 20, "metres": 1.0, "walls": 4}


@dataclass(frozen=True, repr=False, eq=False)
class OwnLog(Open):
    """Call it with a log and its poses: it answers with a `Check` that tells what was found.

    It passes a log that is not one of the bundled ones, with poses that move, and with walls in the
    map that both give. What the map is worth, and what was learned, is graded by hand.
    """

    task: str

    def __call__(self, log: Any, poses: Any = None) -> Check:
        """Check a log, with its poses `(k, 3)` or an `Alignment`. Raises nothing."""
        try:
            sizes = facts(log, poses)
        except Exception as error:  # whatever a student gives, the check says what is wrong with it
            return Check(self.name, False, str(error) or type(error).__name__)
        words = (
            f"{sizes['scans']:d} scans, {sizes['seconds']:.0f} s, {sizes['metres']:.1f} m driven, "
            f"{sizes['walls']:d} walls of 1 m or more, {sizes['wall metres']:.0f} m together"
        )
        short = [key for key, least in WANTED.items() if not sizes[key] >= least]
        lacking = [f"at least {WANTED[key]:g} {key} are wanted" for key in short]
        return Check(self.name, not lacking, "; ".join([words, *lacking]))


def facts(log: Any, poses: Any) -> dict[str, Any]:
    """What a log and its map hold: scans, seconds, metres driven, walls, metres of walls.

    Raises
    ------
    ValueError
        Where it is no log, one of the bundled ones, or has no poses.
    """
    if not isinstance(log, Log):
        raise ValueError("give your log first, as segmap.readers.read(path) returns it")
    if name := bundled(log):
        raise ValueError(f"this is the bundled log {name!r}: take one of your own")
    if poses is None:
        raise ValueError("give the poses too: an Alignment, or (k, 3) in metres and radians")
    poses = np.asarray(poses.poses if isinstance(poses, Alignment) else poses, float)
    if poses.shape != (len(log), 3):
        raise ValueError(f"poses must be ({len(log)}, 3), one a scan, got {poses.shape}")
    path = poses[np.isfinite(poses).all(axis=1)]
    chosen = np.unique(np.linspace(0, len(log) - 1, MOST_SCANS).round().astype(int))
    lengths = length(build_map(log[chosen], poses[chosen]).segments)
    long = lengths[lengths >= 1.0]
    return {
        "scans": len(log),
        "seconds": float(log.times[-1] - log.times[0]),
        "metres": float(np.hypot(*between(path[:-1], path[1:])[:, :2].T).sum()),
        "walls": len(long),
        "wall metres": float(long.sum()),
    }


def bundled(log: Log) -> str:
    """The name of the bundled log that half of the scans come from; empty for none."""
    own = {_mark(scan.ranges) for scan in log}
    shared = {name: len(own & _marks(name)) for name in BUNDLED}
    return next((name for name, count in shared.items() if 2 * count > len(own)), "")


@cache
def _marks(name: str) -> frozenset[bytes]:
    return frozenset(_mark(scan.ranges) for scan in load(name))


def _mark(ranges: Array) -> bytes:
    """A digest of the ranges of a scan, to a millimetre."""
    return hashlib.sha256(np.nan_to_num(ranges, posinf=-1.0).round(3).tobytes()).digest()


check_own_log = OwnLog(
    "check_own_log(log, poses): a log that does not come with segmap, with at least 20 scans and "
    "1 m driven, and poses that give a map with at least 4 walls of 1 m"
)
