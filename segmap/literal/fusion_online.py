"""Fusion on-line (A 2.7.9, table 2.16): after each scan, Fusion of the map and the scan."""

from __future__ import annotations

from collections.abc import Sequence

from .fusion import fusion
from .hybrid import Found, by_scan
from .lines import Segment


def fusion_online(
    segments: Sequence[Segment], scans: Sequence[int], *, tolerance: float = 0.04
) -> Found:
    """The map that Fusion makes of the map before and of a scan, scan after scan."""
    walls: list[Segment] = []
    parents = [-1] * len(segments)
    for new in by_scan(segments, scans):
        fused, into = fusion([*walls, *(segments[i] for i in new)], tolerance=tolerance)
        parents = [into[k] if k >= 0 else -1 for k in parents]
        for i, k in zip(new, into[len(walls) :], strict=True):
            parents[i] = k
        walls = list(fused)
    return walls, parents
