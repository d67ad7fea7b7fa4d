"""Experiments: methods over thresholds and maps, and what they reach at equal quality.

`sweep` runs them, here or on any `concurrent.futures.Executor`, and returns a pandas DataFrame with
one row a run; `equal_quality` and `pareto` compare. `load_records`, `load_online`,
`load_alignments` and `load_walls` give the runs that come with segmap; `good_maps` compares those
against true walls.
"""

from ._compare import equal_quality, front, good_maps, pareto, reduction_at
from ._online import growth
from ._plan import default_thresholds
from ._records import (
    load_alignments,
    load_online,
    load_records,
    load_walls,
    read_records,
    select,
    thresholds_of,
    thresholds_text,
    write_records,
)
from ._sweep import sweep

__all__ = [
    "default_thresholds", "equal_quality", "front", "good_maps", "growth", "load_alignments",
    "load_online", "load_records", "load_walls", "pareto", "read_records",
    "reduction_at", "select", "sweep", "thresholds_of", "thresholds_text", "write_records",
]  # fmt: skip
