"""Experiments: methods over thresholds and maps, and what they reach at equal quality.

`sweep` runs them, here or on any `concurrent.futures.Executor`; `equal_quality` and `pareto`
compare. `thesis_results` and `load_records` give the runs that come with segmap.
"""

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
from ._sweep import digest, sweep

__all__ = [
    "THESIS_FILTERS",
    "THESIS_GRIDS",
    "Answer",
    "Conclusion",
    "Pace",
    "Record",
    "Records",
    "Standing",
    "Standings",
    "by_method",
    "by_setting",
    "conclusion_table",
    "conclusions",
    "density",
    "digest",
    "equal_quality",
    "filter_change",
    "front",
    "load_pace",
    "load_records",
    "number_words",
    "pareto",
    "points_of",
    "reduction_at",
    "sweep",
    "thesis_grid",
    "thesis_results",
]
