"""segmap: maps of line segments, and quadtree maps, from 2D laser scans.

Metres, radians, seconds; poses are x, y, heading; `a_from_b` carries points of b into a.
"""

from . import (
    _display,
    alignment,
    angles,
    extraction,
    metrics,
    poses,
    quadtree,
    readers,
    reduction,
    scans,
    segments,
    simulation,
)
from .extraction import build_map, extract_clusters, extract_polylines
from .metrics import quality, reduction_rate, segment_distance
from .readers import LogError, load, read
from .reduction import METHODS, Reduction, fusion
from .scans import LaserScan, Log
from .segments import SegmentMap

__version__ = "0.1"

__all__ = [
    "METHODS",
    "LaserScan",
    "Log",
    "LogError",
    "Reduction",
    "SegmentMap",
    "alignment",
    "angles",
    "build_map",
    "extract_clusters",
    "extract_polylines",
    "extraction",
    "fusion",
    "load",
    "metrics",
    "poses",
    "quadtree",
    "quality",
    "read",
    "readers",
    "reduction",
    "reduction_rate",
    "scans",
    "segment_distance",
    "segments",
    "simulation",
]


@_display.picture.register
def _draw(value: _display.Pictured) -> bytes:
    """Import the drawings when a notebook first asks for a picture."""
    from . import plotting

    return plotting.thumbnail(value)
