"""The arithmetic of `poses`, for arrays that are known to be good: nothing is checked here.

Loops that chain a hundred thousand single poses would spend most of their time on checks.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import compiled

Indices = NDArray[np.int64]
FULL_TURN_RAD = 2 * math.pi


def wrap(angle: Array) -> Array:
    """Headings in `[-pi, pi)`, (...) array, radians."""
    return (angle + math.pi) % FULL_TURN_RAD - math.pi


def compose(a_from_b: Array, b_from_c: Array) -> Array:
    """The pose of c in a; `(..., 3)` arrays, metres and radians, that broadcast."""
    a, b = a_from_b, b_from_c
    if a.ndim == b.ndim == 1:
        return np.array(_compose_one(*a.tolist(), *b.tolist()))
    c, s = np.cos(a[..., 2]), np.sin(a[..., 2])
    x = a[..., 0] + c * b[..., 0] - s * b[..., 1]
    y = a[..., 1] + s * b[..., 0] + c * b[..., 1]
    return np.stack([x, y, wrap(a[..., 2] + b[..., 2])], -1)


def inverse(a_from_b: Array) -> Array:
    """The pose of a in b; `(..., 3)` array, metres and radians."""
    p = a_from_b
    if p.ndim == 1:
        return np.array(_inverse_of_one(*p.tolist()))
    c, s = np.cos(p[..., 2]), np.sin(p[..., 2])
    x = -c * p[..., 0] - s * p[..., 1]
    y = s * p[..., 0] - c * p[..., 1]
    return np.stack([x, y, wrap(-p[..., 2])], -1)


def between(a: Array, b: Array) -> Array:
    """Pose of b in the frame of a; `(..., 3)` arrays, metres and radians, that broadcast."""
    if a.ndim == b.ndim == 1:
        return np.array(_compose_one(*_inverse_of_one(*a.tolist()), *b.tolist()))
    return compose(inverse(a), b)


def transform(a_from_b: Array, points: Array) -> Array:
    """Points `(..., 2)`, metres, given in b, carried into a by one pose or by k, as in `poses`."""
    pose = a_from_b if a_from_b.ndim == 1 else a_from_b[..., None, :]
    c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    x, y = points[..., 0], points[..., 1]
    return np.stack([pose[..., 0] + c * x - s * y, pose[..., 1] + s * x + c * y], -1)


def arc(twist: Array) -> Array:
    """Where a steady twist `(..., 3)` leads: x and y in metres and radians, `(..., 3)` too."""
    half, chord = twist[..., 2] / 2, np.sinc(twist[..., 2] / FULL_TURN_RAD)
    c, s = chord * np.cos(half), chord * np.sin(half)
    x, y = twist[..., 0], twist[..., 1]
    return np.stack([c * x - s * y, s * x + c * y, wrap(twist[..., 2])], -1)


def twist(motion: Array) -> Array:
    """The steady twist `(..., 3)` that leads to a motion `(..., 3)` by an arc: the way back."""
    half, chord = motion[..., 2] / 2, np.sinc(motion[..., 2] / FULL_TURN_RAD)
    c, s = np.cos(half) / chord, np.sin(half) / chord
    x, y = motion[..., 0], motion[..., 1]
    return np.stack([c * x + s * y, c * y - s * x, motion[..., 2]], -1)


def best_distinct(poses: Array, worth: Array, most: int, near: tuple[float, float]) -> Indices:
    """Indices of at most so many of the best poses `(n, 3)`, best first, each unlike all before it.

    Poses are alike within a distance and a turn, metres and radians.
    """
    chosen = np.empty(most, np.int64)
    order = np.argsort(-worth, kind="stable")
    return chosen[: _choose_distinct(poses, order, *near, chosen)]


@compiled
def _choose_distinct(
    poses: Array, order: Indices, place: float, turn: float, chosen: Indices
) -> int:
    """Write the indices of poses unlike all before them in an order; return how many.

    Two poses are alike within `place` metres and `turn` radians; no more than `chosen` holds.
    """
    count = 0
    for k in order:
        new = True
        for n in range(count):
            c = chosen[n]
            dx, dy = poses[k, 0] - poses[c, 0], poses[k, 1] - poses[c, 1]
            around = abs((poses[k, 2] - poses[c, 2] + np.pi) % (2 * np.pi) - np.pi)
            new = new and (dx * dx + dy * dy > place * place or around > turn)
        if new:
            chosen[count] = k
            count += 1
        if count == len(chosen):
            break
    return count


def _compose_one(
    x: float, y: float, heading: float, ahead: float, aside: float, turn: float
) -> tuple[float, float, float]:
    """One pose after the other: a number costs a twentieth of an array of one."""
    c, s = math.cos(heading), math.sin(heading)
    wrapped = (heading + turn + math.pi) % FULL_TURN_RAD - math.pi
    return x + c * ahead - s * aside, y + s * ahead + c * aside, wrapped


def _inverse_of_one(x: float, y: float, heading: float) -> tuple[float, float, float]:
    """The motion back."""
    c, s = math.cos(heading), math.sin(heading)
    return -c * x - s * y, s * x - c * y, (math.pi - heading) % FULL_TURN_RAD - math.pi
