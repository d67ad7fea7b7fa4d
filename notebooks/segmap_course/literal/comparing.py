"""Methods at equal quality (A 6.2.3), run by run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

#: Quality and reduction of a run.
Run = Sequence[float]


def is_beaten(run: Run, runs: Sequence[Run]) -> bool:
    """Whether another run is at least as good in quality and reduction, and better in one."""
    q, r = run
    return any(a >= q and b >= r and (a > q or b > r) for a, b in runs)


def front(runs: Sequence[Run]) -> list[tuple[float, ...]]:
    """The runs that no other one beats, each once, by ascending quality."""
    return sorted({tuple(run) for run in runs if not is_beaten(run, runs)})


def reduction_at(runs: Sequence[Run], quality: float) -> float:
    """Reduction of a method at a quality: on straight lines along its front."""
    ends = front(runs)
    if quality <= ends[0][0]:
        return ends[0][1]
    for (q, r), (next_q, next_r) in pairwise(ends):
        if quality <= next_q:
            return r + (quality - q) / (next_q - q) * (next_r - r)
    return math.nan
