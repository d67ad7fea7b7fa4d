"""Lines of a backbone (A 3.3.2): which segment lies on which, and how a scan moves onto them.

Everything here is plain geometry of arrays; `_backbone.py` is the method.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ... import arrays
from ...angles import axial_difference, axial_mean, axial_mean_of_two
from ...arrays import Array, Share
from ...poses.motions import transform, wrap
from ...scans.causes import Unmatched
from ...segments import angle, extreme_projections, length, midpoint

Indices = NDArray[np.int64]


class Lines(NamedTuple):
    """Infinite lines: a point of each, `(n, 2)`, metres, and axial directions, `(n,)`, radians."""

    through: Array
    angle: Array

    @property
    def normal(self) -> Array:
        """Unit normals, `(n, 2)` array, at the axial directions plus pi/2 radians."""
        return np.stack([-np.sin(self.angle), np.cos(self.angle)], -1)

    def offsets(self, points: Array) -> Array:
        """Signed distances of points, (..., 2) array, from each line, (..., n) array, metres."""
        return ((points[..., None, :] - self.through) * self.normal).sum(-1)

    def __repr__(self) -> str:
        return f"Lines({len(self.angle)} in {len(np.unique(self.angle))} directions)"


class Walls(NamedTuple):
    """The significant segments of the map so far, `(n, 2, 2)`, metres.

    The weight of each, `(n,)`, is the total length of the segments merged into it, metres.
    """

    segments: Array
    weight: Array


class BackboneStep(NamedTuple):
    """What `backbone` did with one scan.

    Parameters
    ----------
    guess, pose : (3,) array, metres and radians
        By odometry from the last pose, and as laid.
    segments : (m, 2, 2) array, metres
        The segments longer than `min_length`, in the robot's frame.
    partner : (m,) int array
        Line that each was laid on; -1 for none.
    lines, known
        The backbone at that time, and its directions so far, (d,) array, radians.
    skipped, rebuilt
        Whether the scan was left out, and whether the backbone was built anew for it.
    unmatched, reason
        Why the scan was not used, as a kind and in words; empty where it was.
    """

    guess: Array
    pose: Array
    segments: Array
    partner: Indices
    lines: Lines
    known: Array
    skipped: bool
    rebuilt: bool
    unmatched: Unmatched
    reason: str

    @property
    def rotation(self) -> float:
        """By how much the guess was turned, radians."""
        return float(wrap(self.pose[2] - self.guess[2]))


NO_LINES = Lines(np.empty((0, 2)), np.empty(0))
NO_WALLS = Walls(np.empty((0, 2, 2)), np.empty(0))


def partners(segments: Array, lines: Lines, distance: float, turn: float) -> Indices:
    """Index of the line on which each segment lies, `(m,)`; -1 for none (A 3.3.2, step 5).

    Both ends are nearer than `distance` (metres) and the directions differ by less than `turn`
    (radians); of several lines the one that passes nearest.
    """
    off = np.abs(lines.offsets(segments)).max(1, initial=0.0)
    return _cheapest(np.where((off < distance) & (_angles(segments, lines) < turn), off, np.inf))


def parallels(segments: Array, lines: Lines, turn: float) -> Indices:
    """Index of the line that is most nearly parallel to each segment, wherever it lies, `(m,)`.

    Segments `(m, 2, 2)`, metres; -1 where none is within `turn`, radians.
    """
    apart = _angles(segments, lines)
    return _cheapest(np.where(apart < turn, apart, np.inf))


def _angles(segments: Array, lines: Lines) -> Array:
    """Angles between m segments and n lines, `(m, n)`, radians."""
    return np.abs(axial_difference(lines.angle, angle(segments)[:, None]))


def _cheapest(cost: Array) -> Indices:
    """Column of the least cost in each row; -1 where all are infinite."""
    if not cost.shape[1]:
        return np.full(len(cost), -1)
    return np.where(np.isfinite(cost).any(1), cost.argmin(1), -1)


def mean_rotation(differences: Array, weights: Array) -> float:
    """Mean of axial differences `(m,)`, in `(-pi/2, pi/2]`, radians (A 3.3.2, step 6).

    They are turns that would bring each segment onto its line; a half turn more or less is the
    same. Weights are not negative, and not all zero.

    Examples
    --------
    >>> float(np.degrees(mean_rotation(np.radians([3.0, -179.0]), np.ones(2))).round(9))
    2.0
    """
    doubled = 2 * arrays.row(differences, "differences")
    each = _checked_weights(weights, len(doubled))
    return float(np.arctan2(each @ np.sin(doubled), each @ np.cos(doubled)) / 2)


@arrays.checked
def least_translation(
    normals: Array, offsets: Array, weights: Array, *, parallel: Share = 0.3
) -> Array:
    """Shift that brings points onto lines, by weighted least squares (A 3.3.2, step 7).

    Where all lines are parallel it is the shortest of the best ones: a corridor does not fix the
    motion along it, and nothing is claimed there.

    Parameters
    ----------
    normals : (m, 2) array
        Unit normals of the lines.
    offsets : (m,) array, metres
        How far each point lies from its line, positive on the side of the normal.
    weights : (m,) array
        What each point counts, not negative.
    parallel
        Lines count as parallel where they hold one direction less than this share of the other
        (singular values): two of equal weight within 33 degrees of each other, or an end wall of a
        tenth of the weight. At 0.1 a match of 0.2 m could move the robot by a metre along them.

    Examples
    --------
    >>> corridor = np.array([(0.0, 1.0), (0.0, 1.0)])
    >>> least_translation(corridor, np.array([0.1, 0.3]), np.ones(2)).round(9) + 0.0
    array([ 0. , -0.2])
    """
    lines = arrays.table(normals, "normals", 2)
    root = np.sqrt(_checked_weights(weights, len(lines)))
    away = -root * arrays.row(offsets, "offsets", len(lines))
    return np.asarray(np.linalg.lstsq(root[:, None] * lines, away, parallel)[0], float)


def _checked_weights(weights: Array, count: int) -> Array:
    """Weights of `count` things, `(count,)`, not negative."""
    array = arrays.row(weights, "weights", count)
    if (array < 0).any():
        raise ValueError(f"weights must not be negative, got {array.min():g}")
    return array


def turn_pose(pose: Array, seen: Array, lines: Lines, partner: Indices, parallel: float) -> Array:
    """A pose, (3,) array, turned about the robot towards the partners (A 3.3.2, step 6).

    Segments seen `(m, 2, 2)`, metres, robot frame. One weighs the cube of its length: the variance
    of its direction is as the inverse. Those that differ from the mean by `parallel`, radians, are
    left out: a chord across a niche, eight degrees off, must not pull at the walls beside it.
    """
    on = partner >= 0
    if not on.any():
        return pose
    differences = axial_difference(lines.angle[partner[on]], angle(transform(pose, seen[on])))
    weights = length(seen[on]) ** 3
    turn = mean_rotation(differences, weights)
    agree = np.abs(axial_difference(differences, turn)) < parallel
    turn = mean_rotation(differences[agree], weights[agree]) if agree.any() else turn
    return np.array([pose[0], pose[1], float(wrap(pose[2] + turn))])


def shifted_onto_lines(pose: Array, seen: Array, lines: Lines, partner: Indices) -> Array:
    """A pose, (3,) array, moved by the ends of the segments as turned (step 7; A: not turned)."""
    on = partner >= 0
    ends, normal = transform(pose, seen[on]), lines.normal[partner[on]]
    offsets = ((ends - lines.through[partner[on]][:, None]) * normal[:, None]).sum(-1)
    weight = np.repeat(length(seen[on]), 2)
    shift = least_translation(np.repeat(normal, 2, axis=0), offsets.ravel(), weight)
    return pose + np.append(shift, 0.0)


def merged_into_walls(walls: Walls, segments: Array, distance: float, parallel: float) -> Walls:
    """The significant segments with those of another scan merged in (A 3.3.2, step 8).

    Segments `(m, 2, 2)`, metres, in the frame of the walls. One is a piece of a wall where both its
    ends lie nearer than `distance` (metres) to the wall's line, the directions differ by less than
    `parallel` (radians), and no gap of `distance` lies between.
    """
    for segment in segments:
        lines = Lines(midpoint(walls.segments), angle(walls.segments))
        across = np.abs(lines.offsets(segment)).max(0)
        upright = Lines(lines.through, lines.angle - np.pi / 2)  # its normals run along the walls
        u = np.sort(upright.offsets(segment), axis=0)
        gap = np.maximum(u[0], -u[1]) - length(walls.segments) / 2
        same = (across < distance) & (gap < distance)
        same &= _angles(segment[None], lines)[0] < parallel
        if not same.any():
            more = np.concatenate([walls.segments, segment[None]])
            walls = Walls(more, np.append(walls.weight, length(segment)))
            continue
        # Mean direction through the mean middle
        nearest = int(np.where(same, across, np.inf).argmin())
        old, new = walls.weight[nearest], float(length(segment))
        both = np.stack([walls.segments[nearest], segment])
        direction = axial_mean_of_two(angle(both[0]), angle(both[1]), old, new)
        middle = np.average(midpoint(both), axis=0, weights=[old, new])
        merged, weight = walls.segments.copy(), walls.weight.copy()
        merged[nearest] = extreme_projections(both.reshape(4, 2), middle, direction)
        weight[nearest] += new
        walls = Walls(merged, weight)
    return walls


def support_lines(
    walls: Walls, directions: Array, distance: float, parallel: float, least: float = 0.0
) -> tuple[Lines, Array]:
    """The backbone of the significant segments, and all its directions (A 3.3.2, step 4).

    Walls come heaviest first. One that differs from a known direction, (d,) array, radians, or from
    its normal, by less than `parallel` takes it. A new direction is the mean of all walls nearly
    parallel to it, and needs `least` metres of them, unless it is the first. A wall whose middle
    lies nearer than `distance` (metres) to a line of its direction adds none.
    """
    lines, angles = NO_LINES, angle(walls.segments)
    for i in np.argsort(-walls.weight, kind="stable"):
        square = np.concatenate([directions, (directions + np.pi / 2) % np.pi])
        apart: Array = np.abs(axial_difference(square, angles[i]))
        if apart.min(initial=np.inf) < parallel:
            direction = square[apart.argmin()]
        else:
            family = np.abs(axial_difference(angles, angles[i])) < parallel
            if len(directions) and walls.weight[family].sum() < least:
                continue
            direction = float(axial_mean(angles[family], walls.weight[family]))
            directions = np.append(directions, direction)
        middle = midpoint(walls.segments[i])
        near = np.abs(lines.offsets(middle)) < distance
        if not (near & (lines.angle == direction)).any():
            through = np.concatenate([lines.through, middle[None]])
            lines = Lines(through, np.append(lines.angle, direction))
    return lines, directions


def spread_left(steps: Sequence[BackboneStep]) -> float:
    """Median over scans of the weighted root mean square angle left between walls and lines."""
    spreads = []
    for s in steps:
        on = s.partner >= 0
        if s.unmatched is Unmatched.NONE and on.sum() > 1:
            weight, laid = length(s.segments[on]) ** 3, transform(s.pose, s.segments[on])
            off = axial_difference(s.lines.angle[s.partner[on]], angle(laid))
            off = axial_difference(off, mean_rotation(off, weight))
            spreads.append(float(np.sqrt(weight @ off**2 / weight.sum())))
    return float(np.median(spreads)) if spreads else 0.0
