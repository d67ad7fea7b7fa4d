"""A filter of particles, as B 2.2.2 sketches it: each is a pose, and weighs what the scan says."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import exp, floor, log, sqrt

from ..lines import Point, placed

Pose = Sequence[float]


def fit(value: Callable[[Point], float], points: Sequence[Point], pose: Pose) -> float:
    """Geometric mean over the ends of a scan of .9 times what each is worth, and .1.

    `value` says what an end is worth at a place, 0 to 1; points are metres in the robot's frame.

    Examples
    --------
    >>> fit(lambda place: 1.0, [(1.0, 0.0)], (0.0, 0.0, 0.0))
    1.0
    """
    logs = [log(0.9 * value(placed(point, pose)) + 0.1) for point in points]
    return exp(sum(logs) / len(logs))


def weighed(weights: Sequence[float], fits: Sequence[float], beams: float = 10) -> list[float]:
    """Weights times the fits, as often as a scan has independent beams; they sum to 1.

    Examples
    --------
    >>> weighed([0.5, 0.5], [0.8, 0.4], beams=2)
    [0.8, 0.2]
    """
    each = [w * f**beams for w, f in zip(weights, fits, strict=True)]
    return [w / sum(each) for w in each]


def enough(
    poses: Sequence[Pose], size: Pose = (0.25, 0.25, 0.2), least: int = 300, error: float = 0.05
) -> int:
    """How many of the first particles are enough for the cells in which they lie (Fox 2003).

    `size` is that of a cell, metres and radians.

    Examples
    --------
    >>> enough([(0.0, 0.0, 0.0)] * 1000), enough([(k, 0.0, 0.0) for k in range(1000)])
    (300, 1000)
    """
    cells = set()
    for count, pose in enumerate(poses, 1):
        cells.add(tuple(floor(p / s) for p, s in zip(pose, size, strict=True)))
        k = max(len(cells) - 1, 1)
        a = 2 / (9 * k)
        if count >= max(k / (2 * error) * (1 - a + sqrt(a) * 2.326) ** 3, least):
            return count
    return len(poses)
