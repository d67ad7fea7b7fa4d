"""Ways to find the lines of a scan, and how much of what a scan could see each of them finds."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from segmap import simulation
from segmap.arrays import Array
from segmap.poses import transform
from segmap.scans import LaserScan
from segmap.segments import angle, extreme_projections, length, point_distance

from . import literal

#: Three sensors: a short fan of many beams, half a turn of few, a whole turn.
LINE_SENSORS = (
    simulation.URG_04LX,
    simulation.SICK_LMS200,
    simulation.Sensor("360 degrees", 360, -np.pi, np.radians(1), max_range=12.0, sigma=0.01),
)
#: What lies so near to a wall, metres, is found: three deviations of a point.
FOUND_WITHIN_M = 0.03
#: A wall counts where so many beams hit it, on so many metres.
SEEN_BEAMS = 8
SEEN_METRES = 0.3


Finder = Callable[..., Array]


def _again(method: Callable[..., list[list[tuple[float, float]]]], seeded: bool = False) -> Finder:
    def found(points: Array, **options: Any) -> Array:
        if seeded:
            options["rng"] = np.random.default_rng(1)
        return np.reshape(method(points.tolist(), **options), (-1, 2, 2))

    return found


#: Name -> points `(n, 2)`, metres, to segments `(k, 2, 2)`.
LINE_FINDERS: dict[str, Finder] = {
    "split and merge": _again(literal.extract_polylines),
    "incremental": _again(literal.lines_incremental),
    "line regression": _again(literal.lines_regression),
    "RANSAC": _again(literal.lines_ransac, seeded=True),
    "Hough": _again(literal.lines_hough),
    "EM": _again(literal.lines_em, seeded=True),
    "clusters": _again(literal.extract_clusters),
}


class View(NamedTuple):
    """A scan, its pose, all walls of its building, and what of them it could see, metres."""

    scan: LaserScan
    pose: Array
    walls: Array
    visible: Array


@cache
def office_views(sensor: simulation.Sensor, offices: int = 2) -> tuple[View, ...]:
    """Eleven views in each of some offices, by a sensor.

    Examples
    --------
    >>> len(office_views(LINE_SENSORS[0], offices=1))
    11
    """
    stops = [(0.7, 5), (11.3, 5), (10, 5), (10, 7.4), (10, 2.6), (10, 5), (6, 5), (6, 7.4)]
    path = simulation.drive(
        [*stops, (6, 2.6), (6, 5), (2, 5), (2, 7.4), (2, 2.6), (2, 5)], step=0.2
    )
    views = []
    for seed in range(offices):
        walls = simulation.office(rng=np.random.default_rng(seed))
        scans, exact = (
            simulation.simulate(walls, path[10::40], sensor=s, rng=np.random.default_rng(seed))
            for s in (sensor, sensor.ideal())
        )
        for scan, sight, pose in zip(scans, exact, path[10::40], strict=True):
            views.append(View(scan, pose, walls, visible_walls(walls, sight, pose)))
    return tuple(views)


def visible_walls(walls: Array, exact: LaserScan, pose: Array) -> Array:
    """What a scan without faults saw of each wall, `(m, 2, 2)` metres."""
    ends = transform(pose, exact.points())
    own = point_distance(ends[:, None], walls).argmin(axis=1)
    hit = [k for k in range(len(walls)) if (own == k).sum() >= SEEN_BEAMS]
    segments = [extreme_projections(ends[own == k], walls[k, 0], angle(walls[k])) for k in hit]
    seen = np.reshape(segments, (-1, 2, 2))
    return seen[length(seen) > SEEN_METRES]


def near_metres(segments: Array, others: Array) -> float:
    """How many metres of some segments lie within 3 cm of others."""
    if not len(segments) or not len(others):
        return 0.0
    share = ((np.arange(40) + 0.5) / 40)[:, None]
    places = segments[:, None, 0] * (1 - share) + segments[:, None, 1] * share
    near = point_distance(places[:, :, None], others).min(axis=-1) < FOUND_WITHIN_M
    return float((near.mean(axis=1) * length(segments)).sum())


def precision_and_recall(finder: Finder, views: tuple[View, ...], **options: float) -> Array:
    """Share of the metres found that are wall, and share of the metres seen that are found, (2,).

    Examples
    --------
    >>> views = office_views(LINE_SENSORS[0], offices=1)
    >>> precision_and_recall(LINE_FINDERS["split and merge"], views).round(1)
    array([1., 1.])
    """
    sums = np.zeros(4)
    for scan, pose, walls, visible in views:
        lines = transform(pose, finder(scan.points(), **options))
        right, seen = near_metres(lines, walls), near_metres(visible, lines)
        sums += right, length(lines).sum(), seen, length(visible).sum()
    return np.array([sums[0] / (sums[1] or 1.0), sums[2] / (sums[3] or 1.0)])
