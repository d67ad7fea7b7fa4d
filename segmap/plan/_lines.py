"""The axes of a building and the lines on which its walls lie."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..angles import axial_difference
from ..arrays import Array
from ..poses import transform
from ..segments import angle, length, midpoint

Indices = NDArray[np.int64]

#: Half the width of the kernel that finds the densest direction, radians.
AXIS_KERNEL_RAD = np.radians(6)
#: The mean of the directions so near to it is the axis, radians.
AXIS_MEAN_RAD = np.radians(5)
#: An axis takes the segments that are turned from it by at most so much, radians.
AXIS_BAND_RAD = np.radians(8)
#: An axis takes this share of the squares of all lengths: clutter beside an axis, or in all
#: directions, is as long in sum as a wall, but of short pieces.
LEAST_AXIS_SHARE = 0.12
#: Pairs of axes, at most.
MOST_AXES = 4
#: Steps in which the densest direction is looked for, radians.
AXIS_STEP_RAD = np.radians(0.25)
#: A line needs so much of segments in all, metres.
LEAST_LINE_M = 0.5
QUARTER = np.pi / 2


class Line(NamedTuple):
    """A line of the building: all points with `normal @ point == offset`.

    `rows` are the segments on it, `spans`, `(k, 2)`, what they cover along `way`, metres.
    """

    axis: int
    way: Array
    normal: Array
    offset: float
    rows: Indices
    spans: Array


def building_axes(segments: Array) -> Array:
    """Directions along or across which walls run, radians in [0, pi/2), the strongest first."""
    turn, weight, axes = angle(segments) % QUARTER, length(segments), list[float]()
    places, least = np.arange(0, QUARTER, AXIS_STEP_RAD), LEAST_AXIS_SHARE * (weight**2).sum()
    while (weight**2).sum() > least and len(axes) < MOST_AXES:
        apart = abs(quarter_turn(places[:, None] - turn))
        best = float(places[(np.clip(1 - apart / AXIS_KERNEL_RAD, 0, None) @ weight).argmax()])
        for _ in range(5):
            off = quarter_turn(turn - best)
            near = abs(off) <= AXIS_MEAN_RAD
            best += float(np.average(off[near], weights=weight[near]))
        others = abs(quarter_turn(turn - best)) > AXIS_BAND_RAD
        axes += [best % QUARTER] if (weight[~others] ** 2).sum() >= least else []
        turn, weight = turn[others], weight[others]
    return np.array(axes)


def wall_lines(segments: Array, axes: Array, band: float) -> list[Line]:
    """Lines of each axis and across it, each the mean of the densest offsets within a band.

    What is as near to it as half the band is on it too: so lines are apart by more, and squares
    lie between any two.
    """
    lines, sizes, middles = list[Line](), length(segments), midpoint(segments)
    apart = abs(quarter_turn(angle(segments)[:, None] - axes))
    nearest = np.column_stack([apart, np.full(len(apart), np.inf)]).argmin(1)
    for axis, turn in enumerate(np.concatenate([axes, axes + QUARTER])):
        way, normal = transform((0, 0, turn), np.eye(2))
        along = abs(axial_difference(angle(segments), turn)) <= AXIS_BAND_RAD
        rows = np.flatnonzero(along & (nearest == axis % len(axes)))
        rows = rows[np.argsort(middles[rows] @ normal, kind="stable")]
        while sizes[rows].sum() >= LEAST_LINE_M:
            offsets = middles[rows] @ normal
            total = np.append(0, np.cumsum(sizes[rows]))
            last = np.searchsorted(offsets, offsets + band, "right")
            first = int((total[last] - total[:-1]).argmax())
            densest = np.s_[first : last[first]]
            if sizes[rows[densest]].sum() < LEAST_LINE_M:
                break
            offset = float(np.average(offsets[densest], weights=sizes[rows[densest]]))
            is_near = abs(offsets - offset) <= band / 2
            is_near[densest] = True
            spans = np.sort(segments[rows[is_near]] @ way, axis=1)
            lines.append(Line(axis, way, normal, offset, rows[is_near], merged_spans(spans)))
            rows = rows[~is_near]
    return lines


def merged_spans(spans: Array, gap: float = 0.0) -> Array:
    """Intervals `(k, 2)` with those that overlap, or leave at most a gap, made one."""
    low, high = spans[np.argsort(spans[:, 0], kind="stable")].T
    reach = np.maximum.accumulate(high)
    begins = np.append(True, low[1:] > reach[:-1] + gap)[: len(low)]
    return np.stack([low[begins], np.append(reach[:-1][begins[1:]], reach[-1:])], -1)


def quarter_turn(difference: Array) -> Array:
    """Differences of directions to the nearest quarter turn, in [-pi/4, pi/4), radians."""
    return (difference + QUARTER / 2) % QUARTER - QUARTER / 2
