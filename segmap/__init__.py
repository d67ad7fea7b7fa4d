"""segmap: maps of buildings from a 2D laser, as line segments and as a quadtree.

Metres, radians, seconds; poses are x, y, heading; `a_from_b` carries points of b into a. Wrong
arguments end as a `ValueError` that names the argument, its value and what was expected, bad files
as a `LogError` that names file and line, a lost sensor as a `SensorError`.

Most methods are those of two theses of the Politecnico di Milano, which the docstrings call A and
B, with the number of the section, table or figure:

- **A**: M. Deambrogi and M. Ferrario, *Implementazione e confronto sperimentale di metodi per la
  riduzione di segmenti ridondanti in mappe indoor costruite da robot mobili*, 2012. "A 4.4.4" is
  its section 4.4.4. Segments: alignment, reduction, quality.
- **B**: M. Brenna, *Costruzione di mappe basate su quadtree*, 2007. Quadtree maps, scores,
  matchers, and the Hokuyo URG-04LX.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from . import display

if TYPE_CHECKING:
    from . import (
        alignment,
        angles,
        arrays,
        experiments,
        exports,
        extraction,
        matching,
        metrics,
        panels,
        plan,
        plotting,
        poses,
        progress,
        quadtree,
        readers,
        reduction,
        scans,
        segments,
        sensors,
        simulation,
        testing,
    )
    from .extraction import build_map, extract_clusters, extract_polylines
    from .metrics import quality, reduction_rate, segment_distance
    from .readers import LogError, load, read
    from .reduction import METHODS, Reduction, fusion
    from .scans import LaserScan, Log
    from .segments import SegmentMap

__version__ = "0.2.0"

__all__ = [
    "METHODS",
    "LaserScan",
    "Log",
    "LogError",
    "Reduction",
    "SegmentMap",
    "alignment",
    "angles",
    "arrays",
    "build_map",
    "experiments",
    "exports",
    "extract_clusters",
    "extract_polylines",
    "extraction",
    "fusion",
    "load",
    "matching",
    "metrics",
    "panels",
    "plan",
    "plotting",
    "poses",
    "progress",
    "quadtree",
    "quality",
    "read",
    "readers",
    "reduction",
    "reduction_rate",
    "scans",
    "segment_distance",
    "segments",
    "sensors",
    "simulation",
    "testing",
]

#: What has a name here too, by the package that it is of.
_OFTEN_USED = {
    "extraction": ("build_map", "extract_clusters", "extract_polylines"),
    "metrics": ("quality", "reduction_rate", "segment_distance"),
    "readers": ("LogError", "load", "read"),
    "reduction": ("METHODS", "Reduction", "fusion"),
    "scans": ("LaserScan", "Log"),
    "segments": ("SegmentMap",),
}
#: The extra that brings a package which not everybody has.
_EXTRA = {"ipywidgets": "lab", "IPython": "lab", "serial": "laser"}


def __getattr__(name: str) -> Any:
    """Packages load when first named: some bring pandas, matplotlib or widgets."""
    if name not in __all__:
        raise AttributeError(f"module 'segmap' has no attribute {name!r}")
    for package, names in _OFTEN_USED.items():
        if name in names:
            return getattr(importlib.import_module(f"segmap.{package}"), name)
    try:
        return importlib.import_module(f"segmap.{name}")
    except ModuleNotFoundError as error:
        if (missing := error.name or "") not in _EXTRA:
            raise
        hint = f"segmap.{name} needs {missing}: {display.pip_install(_EXTRA[missing])}"
        raise ImportError(hint, name=missing) from error


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])


@display.picture.register
def _draw(value: display.Pictured) -> bytes:
    """Import the drawings when a notebook first asks for a picture."""
    from . import plotting

    return plotting.thumbnail(value)
