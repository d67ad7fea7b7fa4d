"""Uncertain parameters (A 2.7.8; Amigoni, Fontana, Garigiola 2006): lines with deviations."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean
from typing import Literal, NamedTuple

import numpy as np

from ...arrays import Array, Metres, Segments, checked
from ...compiled import compiled
from ...kernels import apart, boxes_apart, gap_along, turn_between
from ...segments import point_distance
from .._points import points_behind
from .._runner import Indices, Reduction, Rows, Steps, Turn, run_online
from .lines import (
    SAME,
    Segment,
    axial_difference,
    line_angle,
    parents_of,
    seen_from,
    segment_length,
    spanning,
)

#: The uncertainty of a fused line across itself is at least this, metres.
LEAST_RHO_M = 0.001
#: The uncertainty of the angle of a fused line is at least this, radians.
LEAST_THETA_RAD = 1e-4


@checked
def uncertain_parameters(
    map: Segments,
    *,
    distance: Metres = 0.05,
    angle: Turn = np.pi / 18,
    eps: Metres = 0.01,
    origin: Literal["map", "pair"] = "pair",
) -> Reduction:
    """Fuse each new segment with all of the map that it may be a look at (A 2.7.8).

    A segment of length l whose points lie within eps of it has a line with the standard deviations
    `max(eps, 1 mm)` across and `asin(2 eps / l)` in direction. A new segment takes in every segment
    of the map whose direction is within `angle`, from which it is less than `distance` away, and
    with which it overlaps along the bisector. The fused line has the means of rho and theta,
    weighted by `length / sigma^2`, and spans all end points; its deviations are those of a sum of
    independent looks, at least 1 mm and 1e-4 radians. A new segment without a match joins the map.

    Old walls get so certain that no later look can move them, and a bend within `angle` and
    `distance` is ironed out. Segments of one wall that touch and do not overlap never meet.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Scans come in ascending order.
    distance
        Segments farther apart are two walls (A's T_D, without a value). At 0.05 m the faces of a
        wall of 0.10 m stay two in 16 of 18 simulated drives (poses within 2 cm), at 0.10 m in none,
        and 3.1 % of the true walls of `walls.csv` are missed instead of 0.6 %.
    angle
        A's T_theta: segments that differ more in direction are two walls.
    eps
        For a map without points. With points it is the largest distance of one from its segment.
    origin
        A takes rho about the origin of the map. Theta and rho have different weights, so 50 m away
        the fused line can miss both walls by 0.2 m. "pair" takes it about the mean of the middles,
        weighted by length.

    Returns
    -------
    Reduction
        In the order in which segments joined; with seconds and segments in the map for each scan.

    References
    ----------
    Amigoni, Fontana, Garigiola, "A method for building small-size segment-based maps", DARS 2006.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (4, 0)], [(3, 0.02), (4, 0.04)], [(4.2, 0), (5, 0)]])
    >>> reduction = uncertain_parameters(wall)
    >>> reduction, reduction.parents
    (Reduction(uncertain_parameters: 3 -> 2 segments), array([0, 0, 1]))
    """

    def steps(rows: Rows) -> Steps:
        s, off = rows.segments, np.full(len(rows.segments), float(eps))
        points, first, _, has_points = points_behind(map, rows, None)
        if has_points and len(s):
            beside = point_distance(points, np.repeat(s, np.diff(first), axis=0))
            off = np.maximum.reduceat(beside, first[:-1]).clip(LEAST_RHO_M)
        walls, ends = list[UncertainWall](), np.empty_like(s)
        for begin, stop in rows.scans():
            for i in range(begin, stop):
                new = uncertain(s[i].tolist(), float(off[i]), i)
                same = looks_at_it(s[i], ends[: len(walls)], distance, angle)
                if len(same):
                    walls[same[0]] = fused([*(walls[k] for k in same), new], origin)
                    ends[same[0]] = walls[same[0]].ends
                    for k in same[:0:-1]:
                        ends[k : len(walls) - 1] = ends[k + 1 : len(walls)]
                        del walls[k]
                else:
                    ends[len(walls)] = s[i]
                    walls.append(new)
            yield len(walls)
        return ends[: len(walls)], parents_of((wall.members for wall in walls), len(s))

    return run_online("uncertain_parameters", map, steps)


@compiled
def looks_at_it(s: Array, walls: Array, distance: float, angle: float) -> Indices:
    """Which walls of the map, `(n, 2, 2)`, a segment may be a look at, ascending."""
    hits, count, one = np.empty(len(walls), np.int64), 0, s.reshape(1, 2, 2)
    at = np.arctan2(s[1, 1] - s[0, 1], s[1, 0] - s[0, 0])
    for k in range(len(walls)):
        if boxes_apart(one, 0, walls, k) > distance:
            continue
        wall = walls[k]
        turn = turn_between(at, np.arctan2(wall[1, 1] - wall[0, 1], wall[1, 0] - wall[0, 0]))
        if abs(turn) < angle - SAME and apart(s, wall) < distance - SAME:
            bisector = at + turn / 2
            if gap_along(s, wall, np.cos(bisector), np.sin(bisector)) <= SAME:
                hits[count] = k
                count += 1
    return hits[:count]


class UncertainWall(NamedTuple):
    """A segment of the map, the standard deviations of its line, and the inputs it stands for."""

    ends: Segment
    sigma_rho: float
    sigma_theta: float
    members: list[int]


def uncertain(s: Segment, eps: float, i: int) -> UncertainWall:
    """A 2.37: a segment whose points lie within eps, metres, of it."""
    theta = math.asin(min(1.0, 2 * eps / segment_length(s)))
    return UncertainWall(s, max(eps, LEAST_RHO_M), theta, [i])


def mean_line(walls: Sequence[UncertainWall], origin: str) -> tuple[float, float, float]:
    """A point and the angle of the line with the mean theta, and the mean rho from one place."""
    sizes = [segment_length(wall.ends) for wall in walls]
    start = line_angle(next(w.ends for w in walls if segment_length(w.ends) >= max(sizes) - SAME))
    turns = [axial_difference(line_angle(wall.ends), start) for wall in walls]
    middles = [[(p + q) / 2 for p, q in zip(*wall.ends, strict=True)] for wall in walls]
    x, y = (fmean(values, sizes) for values in zip(*middles, strict=True))
    x, y = (0.0, 0.0) if origin == "map" else (x, y)
    lines = [(x, y, math.cos(start + turn), math.sin(start + turn)) for turn in turns]
    rhos = [seen_from(line, at)[1] for line, at in zip(lines, middles, strict=True)]
    rho = fmean(rhos, [segment_length(w.ends) / w.sigma_rho**2 for w in walls])
    turn = fmean(turns, [segment_length(w.ends) / w.sigma_theta**2 for w in walls])
    return x - rho * math.sin(start + turn), y + rho * math.cos(start + turn), start + turn


def fused(walls: Sequence[UncertainWall], origin: str) -> UncertainWall:
    """One wall for all, on their mean line; its deviations are those of independent looks."""
    ends = spanning(*mean_line(walls, origin), [p for wall in walls for p in wall.ends])
    rho = sum(wall.sigma_rho**-2 for wall in walls) ** -0.5
    theta = sum(wall.sigma_theta**-2 for wall in walls) ** -0.5
    members = [i for wall in walls for i in wall.members]
    return UncertainWall(ends, max(rho, LEAST_RHO_M), max(theta, LEAST_THETA_RAD), members)
