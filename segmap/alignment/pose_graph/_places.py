"""What places look like, and which old ones are proposed for a loop: the cheapest of each pass."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array

#: A descriptor tells what a place looks like from any heading: the share of points in each ring.
DESCRIPTOR_RINGS = 16
#: Radius of the outermost ring, metres.
DESCRIPTOR_RADIUS_M = 8.0
#: Key frames that follow each other by less than this are one pass.
PASS_GAP_FRAMES = 3
#: Passes that are searched.
SEARCHED_PASSES = 3
#: Of two places one is better that holds so much more of the scan: below it false places match.
OVERLAP_GAIN = 0.1


def descriptor(points: Array) -> Array:
    """Shares of points `(m, 2)`, metres, by their distance from the origin, (16,) array."""
    distance = np.hypot(points[:, 0], points[:, 1])
    near = distance[distance <= DESCRIPTOR_RADIUS_M]
    ring = (near * (DESCRIPTOR_RINGS / DESCRIPTOR_RADIUS_M)).astype(np.int64)
    counts = np.bincount(np.minimum(ring, DESCRIPTOR_RINGS - 1), minlength=DESCRIPTOR_RINGS)
    return np.asarray(counts / max(counts.sum(), 1))


def best_of_passes(members: NDArray[np.int64], cost: Array) -> list[int]:
    """The cheapest of each run of neighbouring key frames, at most three, cheapest first.

    `cost` is that of each member, `(m,)`.
    """
    cuts = np.flatnonzero(np.diff(members) > PASS_GAP_FRAMES) + 1
    passes = [run for run in np.split(np.arange(len(members)), cuts) if len(run)]
    best = sorted((run[np.argmin(cost[run])] for run in passes), key=lambda k: float(cost[k]))
    return [int(members[k]) for k in best[:SEARCHED_PASSES]]
