"""Two sessions of one building, tied by places that are found on the map of the first."""

from __future__ import annotations

from typing import Any

from .. import alignment, arrays
from ..alignment import Alignment, LiveGraph
from ..arrays import Array
from ..quadtree import build_map
from ..scans import LaserScan, Log
from ._search import search

#: Scans that score less are not believed (`Places.found`), and to look for them takes long.
LEAST_MERGE_FIT = 0.7
#: Side of a cell of the map, metres: the search joins smaller ones.
MERGE_CELL_M = 0.05


@arrays.checked
def merge(first: Log, second: Log, **thresholds: Any) -> Alignment:
    """Align two sessions of a building, each alone, and tie them: `alignment.merge_graphs`.

    `thresholds` are those of `pose_graph`. Nothing need lead from one to the other: odometry and
    clock may be others.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("room")
    >>> merge(log[:40], log[20:])
    Alignment(merge: 81 scans, 81 used)
    """
    logs = arrays.instance(first, "first", Log), arrays.instance(second, "second", Log)
    graphs = LiveGraph(**thresholds), LiveGraph(**thresholds)
    for graph, log in zip(graphs, logs, strict=True):
        graph.extend(log)
    map = build_map(first, graphs[0].refine(), resolution=MERGE_CELL_M)

    def places(scan: LaserScan) -> Array:
        candidates = search(map, scan, least=LEAST_MERGE_FIT)
        return candidates.poses[: int(candidates.found)]

    return alignment.merge_graphs(*graphs, places)
