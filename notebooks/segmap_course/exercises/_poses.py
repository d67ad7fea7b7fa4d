"""Exercises of the chapters on point ICP, pose graphs, scores and matchers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from segmap.alignment.graph import residuals
from segmap.arrays import Array
from segmap.poses import between, compose, transform

from ..literal import MOVES, climb_step, distance_score, edge_residual
from ..literal.quadtrees import matching
from ._exercise import Exercise
from .draws import grids as draws_grids
from .draws import scans as draws_scans


# ----------------------------------------------------------------------------- pose graph
def _edge_error(first: Array, second: Array, relative: Array) -> Array:
    return between(relative, between(first, second))


def _not_wrapped(first: Array, second: Array, relative: Array) -> Array:
    error = _edge_error(first, second, relative)
    return np.append(error[:2], second[2] - first[2] - relative[2])


def _edge(*poses: ArrayLike) -> tuple[Array, ...]:
    return tuple(np.array(pose, float) for pose in poses)


check_edge_error = Exercise(
    "edge_error(first, second, relative) -> (3,): pose of the second (x, y, heading) in the frame "
    "of where the measured motion `relative`, in the frame of the first, would put it",
    _edge_error,
    {
        "two poses along x, one metre measured": _edge((0, 0, 0), (1.2, 0, 0), (1, 0, 0)),
        "a robot that looks along y": _edge((2, 1, np.pi / 2), (2, 3, np.pi / 2), (1.9, 0.1, 0)),
        "a turn on the way": _edge((1, 2, 0.7), (2.5, 3, 1.9), (1.7, 0.2, 1.1)),
        "a turn over half a turn": _edge((0, 0, 3.0), (-1, 0.2, -3.0), (1.0, -0.1, 0.2)),
    },
    {
        "poses are not numbers: where the second lies depends on where the first one looks; "
        "take segmap.poses.between(first, second)": lambda a, b, z: b - a - z,
        "the difference of two motions is again one: seen from where the measurement ends, which "
        "looks elsewhere; compose its inverse in front, do not subtract": (
            lambda a, b, z: between(a, b) - z
        ),
        "the wrong way round: the measured place seen from the second pose is the inverse of what "
        "is asked": lambda a, b, z: between(between(a, b), z),
        "relative is the pose of the second in the frame of the first: between(first, second)": (
            lambda a, b, z: between(z, between(b, a))
        ),
        "headings 3.0 and -3.0 are 0.28 apart, not 6: wrap the difference": _not_wrapped,
        "all three parts are asked for, not only how far the place is off": (
            lambda a, b, z: np.hypot(*_edge_error(a, b, z)[:2])
        ),
    },
    draw=draws_scans.edge_error,
    own=(edge_residual, residuals),
)


def _carried(before: Array, after: Array, pose: Array) -> Array:
    return compose(after, between(before, pose))


def _carried_unwrapped(before: Array, after: Array, pose: Array) -> Array:
    return np.append(_carried(before, after, pose)[:2], pose[2] + after[2] - before[2])


check_carried = Exercise(
    "carried(before, after, pose) -> (3,): where a scan lies (x, y, heading) that lay at `pose`, "
    "once a loop has moved its key frame from `before` to `after`",
    _carried,
    {
        "a key frame that is shifted": _edge((1, 1, 0), (1.5, 0.8, 0), (1.3, 1, 0)),
        "one that turns by a right angle": _edge((2, 1, 0), (2, 1, np.pi / 2), (2.4, 1, 0)),
        "one that looks along y": _edge((0, 5, np.pi / 2), (0.5, 4, 1.7), (0.1, 5.4, 1.5)),
        "a turn over half a turn": _edge((0, 0, 2.9), (0.2, 0.1, 3.1), (-0.3, 0, 3.1)),
    },
    {
        "poses are not numbers: where the key frame turns, its scans turn about it; take the pose "
        "in the key frame, segmap.poses.between(before, pose)": lambda b, a, p: p + a - b,
        "the key frame comes first: compose(after, ...), not compose(..., after)": (
            lambda b, a, p: compose(between(b, p), a)
        ),
        "the wrong way round: the scan lay beside `before`, and goes to `after`": (
            lambda b, a, p: compose(b, between(a, p))
        ),
        "the scan turns with its key frame: its heading changes too": (
            lambda b, a, p: np.append(_carried(b, a, p)[:2], p[2])
        ),
        "headings end at half a turn: wrap the sum, as compose does": _carried_unwrapped,
        "the scan keeps its place beside the key frame; it does not go onto it": lambda b, a, p: a,
    },
    draw=draws_scans.carried,
)


# --------------------------------------------------------------------------------- scores
def _distances(points: Array, pose: Array, centres: Array) -> Array:
    return np.linalg.norm(transform(pose, points)[:, None] - centres, axis=-1)


_SCAN = np.array([(1.0, 0.0), (1.0, 1.0), (0.0, 2.0), (-1.0, 0.5)])
_CENTRES = np.array([(1.05, 0.05), (1.0, 1.2), (0.3, 2.0), (-1.2, 0.4), (3.0, 3.0)])

check_scan_score = Exercise(
    "scan_score(points, pose, centres) -> float: minus the sum of the distances of the ends "
    "(n, 2), carried by the pose, to the nearest centre (m, 2)",
    distance_score,
    {
        f"pose {pose} and {k} beams": (_SCAN[:k], np.array(pose), _CENTRES)
        for pose, k in (
            *(((0.0, 0.0, 0.0), 4), ((0.3, -0.2, 0.0), 4), ((0.0, 0.0, 0.5), 3)),
            *(((0.5, 0.1, -2.0), 4), ((0.0, 0.0, 0.0), 1)),
        )
    },
    {
        "the higher the better: distances count as a loss, so the score is never above 0": (
            lambda points, pose, centres: -distance_score(points, pose, centres)
        ),
        "every end looks for its nearest cell, not every cell for an end: a map holds many cells "
        "that this scan does not see": lambda *given: -_distances(*given).min(0).sum(),
        "only the nearest cell counts for each end": (
            lambda points, pose, centres: -_distances(points, pose, centres).mean(1).sum()
        ),
        "the sum over the beams, not their mean": (
            lambda points, pose, centres: -_distances(points, pose, centres).min(1).mean()
        ),
        "the heading turns counter-clockwise: x' = x cos h - y sin h, y' = x sin h + y cos h": (
            lambda points, pose, centres: distance_score(points, pose * (1, 1, -1), centres)
        ),
        "the points are in the robot's frame: carry them by the pose first": (
            lambda points, pose, centres: distance_score(points, (0, 0, 0), centres)
        ),
        "the heading is in radians already": (
            lambda points, pose, centres: distance_score(
                points, pose * (1, 1, np.pi / 180), centres
            )
        ),
        "distances, not their squares: one beam through a door would count for all others": (
            lambda points, pose, centres: -(_distances(points, pose, centres).min(1) ** 2).sum()
        ),
    },
    draw=draws_grids.scan_score,
    own=(distance_score,),
)


# ------------------------------------------------------------------------------ hill climb
#: A pose is an array or a tuple: three numbers.
Pose = Any
Value = Callable[[Pose], float]


def _tried(value: Value, pose: Pose, move: float, turn: float) -> tuple[Array, list[float]]:
    """Poses after each of the six moves, and their values."""
    tried = pose + np.array(MOVES) * (move, move, turn)
    return tried, [value(p) for p in tried]


def _if_as_good(value: Value, pose: Pose, move: float, turn: float) -> Pose:
    tried, values = _tried(value, pose, move, turn)
    return tried[int(np.argmax(values))] if max(values) >= value(pose) else pose


def _first_improvement(value: Value, pose: Pose, move: float, turn: float) -> Pose:
    tried, values = _tried(value, pose, move, turn)
    here = value(pose)
    return next((p for p, at in zip(tried, values, strict=True) if at > here), pose)


def _always(*given: Any) -> Pose:
    tried, values = _tried(*given)
    return tried[int(np.argmax(values))]


def _along_the_robot(value: Value, pose: Pose, move: float, turn: float) -> Pose:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turned = np.array(MOVES) @ [(c, s, 0), (-s, c, 0), (0, 0, 1)]
    return climb_step(value, pose, move, turn, turned)


_HILL = draws_grids.Hill(0.3, -0.2, 0.4)


def _walking_on(value: Value, pose: Pose, move: float, turn: float) -> Pose:
    """Takes each move that improves, and tries the next one from there."""
    for step in np.array(MOVES) * (move, move, turn):
        pose = pose + step if value(pose + step) > value(pose) else pose
    return pose


check_climb_step = Exercise(
    "climb_step(value, pose, move, turn) -> (3,): the best of the moves -x, +x, -y, +y, -heading, "
    "+heading, where it improves value(pose)",
    climb_step,
    {
        words: (value, np.array(pose, float), move, turn)
        for words, value, pose, move, turn in (
            ("a hill to the right", _HILL, (0, 0, 0), 0.1, 0.1),
            ("a hill, nearly there", _HILL, (0.3, -0.1, 0.4), 0.1, 0.1),
            ("on the top", _HILL, (0.3, -0.2, 0.4), 0.1, 0.1),
            ("a plain", draws_grids.Plane(0, 0), (1, 2, 0.5), 0.1, 0.1),
            ("a valley, both ways up", draws_grids.Plane(0, 1, folded=True), (0.5, 0, 0), 0.1, 0.1),
            ("a slope, the robot turned", draws_grids.Plane(2, 1), (0, 0, 2), 0.1, 0.1),
            ("a coarse turn", _HILL, (0.3, -0.2, 0.0), 0.001, 1.0),
        )
    },
    {
        "an equal score is no improvement: on a plain the robot would walk for ever": _if_as_good,
        "look at all six before you move: the best counts, not the first that improves": (
            _first_improvement
        ),
        "of equal moves the first in the order counts": (
            lambda value, at, move, turn: climb_step(value, at, move, turn, MOVES[::-1])
        ),
        "the moves go along the axes of the map, not along those of the robot": _along_the_robot,
        "stay where none of the six improves the score": _always,
        "the higher the better: you climb down": (
            lambda value, *rest: climb_step(lambda p: -value(p), *rest)
        ),
        "try all six moves from where the pose is: do not walk on from each that improves": (
            _walking_on
        ),
        "the pose after the move is asked for, not its value": (
            lambda value, at, move, turn: value(climb_step(value, at, move, turn))
        ),
        "the heading moves by `turn`, x and y by `move`": (
            lambda value, at, move, turn: climb_step(value, at, turn, move)
        ),
    },
    draw=draws_grids.climb_step,
    own=(matching,),
)
