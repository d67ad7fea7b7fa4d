"""How far two segments are apart, how well a reduced map keeps its walls, how good poses are.

Segment distance and quality: A 2.7.7 and 6.2.2; grades: A 6.2.3; relation errors: Kuemmerle et al.
"""

from ._against_walls import AgainstWalls, against_walls
from ._coverage import invented, missed
from ._doubled import doubled_walls
from ._metrics import (
    distance_terms,
    errors,
    grade_quality,
    grade_reduction,
    quality,
    reduction_rate,
    relation_errors,
    segment_distance,
)

__all__ = [
    "AgainstWalls", "against_walls", "distance_terms", "doubled_walls", "errors", "grade_quality",
    "grade_reduction", "invented", "missed", "quality", "reduction_rate", "relation_errors",
    "segment_distance",
]  # fmt: skip
