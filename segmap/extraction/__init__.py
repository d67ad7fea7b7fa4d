"""From the points of a scan to line segments: distance clusters (A 3.2, 5.1) and polylines (A 6.2).

Points come in the order of the beams. Both methods first cut that order where two neighbours are
at least `gap` apart; a polyline is then split and merged until it follows the points.
"""

from collections.abc import Callable
from typing import Any

from ._extraction import (
    build_map,
    extract_clusters,
    extract_polylines,
    fit_line,
)

__all__ = ["METHODS", "build_map", "extract_clusters", "extract_polylines", "fit_line"]

#: Ways to find the segments of a scan; both tell the points behind each.
METHODS: dict[str, Callable[..., Any]] = {
    "extract_polylines": extract_polylines,
    "extract_clusters": extract_clusters,
}
