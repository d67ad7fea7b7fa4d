"""Experiments: methods over thresholds and maps, and what they reach at equal quality.

`sweep` runs them, here or on any `concurrent.futures.Executor`; `equal_quality` and `pareto`
compare. `thesis_results` and `load_records` give the runs that come with segmap.
"""

from ._alignments import (
    PUBLISHED,
    AlignmentRun,
    Published,
    alignment_table,
    load_alignments,
    read_alignments,
)
from ._bundled import THESIS_FILTERS, THESIS_GRIDS, load_records, thesis_grid, thesis_results
from ._compare import (
    Standing,
    Standings,
    by_method,
    by_setting,
    equal_quality,
    front,
    pareto,
    points_of,
    reduction_at,
)
from ._conclusions import Answer, Conclusion, conclusion_table, conclusions, density, filter_change
from ._online import Pace, load_pace
from ._records import Record, Records, number_words
from ._storage import (
    Judged,
    Kept,
    Ways,
    along,
    judge,
    keep,
    occupied_centres,
    storage_table,
    wall_errors,
)
from ._sweep import digest, sweep

__all__ = [
    "PUBLISHED",
    "THESIS_FILTERS",
    "THESIS_GRIDS",
    "AlignmentRun",
    "Answer",
    "Conclusion",
    "Judged",
    "Kept",
    "Pace",
    "Published",
    "Record",
    "Records",
    "Standing",
    "Standings",
    "Ways",
    "alignment_table",
    "along",
    "by_method",
    "by_setting",
    "conclusion_table",
    "conclusions",
    "density",
    "digest",
    "equal_quality",
    "filter_change",
    "front",
    "judge",
    "keep",
    "load_alignments",
    "load_pace",
    "load_records",
    "number_words",
    "occupied_centres",
    "pareto",
    "points_of",
    "read_alignments",
    "reduction_at",
    "storage_table",
    "sweep",
    "thesis_grid",
    "thesis_results",
    "wall_errors",
]
