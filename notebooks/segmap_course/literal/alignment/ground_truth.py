"""Poses between poses that somebody else has measured (A 3.3.3)."""

from __future__ import annotations

import math
from collections.abc import Sequence


def pose_between(
    before: Sequence[float], after: Sequence[float], share: float
) -> tuple[float, float, float]:
    """Pose at a share of the way between two known ones, the heading by the shorter way round.

    Metres and radians.

    Examples
    --------
    >>> pose_between((0.0, 0.0, 3.0), (2.0, 0.0, -3.0), 0.5)[0]
    1.0
    """
    turn = (after[2] - before[2] + math.pi) % (2 * math.pi) - math.pi
    x, y = (before[k] + share * (after[k] - before[k]) for k in (0, 1))
    return x, y, (before[2] + share * turn + math.pi) % (2 * math.pi) - math.pi
