"""Exercises of the chapters on point ICP, pose graphs, scores and matchers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..literal import MOVES, climb_step, distance_score, point_to_line_step
from ..poses import between, compose, transform
from ._exercise import Exercise


# ---------------------------------------------------------------------------------- ICP
def _rows(points: Array, normals: Array) -> Array:
    """How the offset of each point grows with x, y and the turn, `(n, 3)`."""
    lever = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    return np.column_stack([normals, lever])


def _least(rows: Array, offsets: Array) -> Array:
    return np.asarray(np.linalg.lstsq(rows, offsets, rcond=1e-9)[0], float)


def _solved(points: Array, feet: Array, normals: Array) -> Array:
    """By the normal equations, which a corridor makes singular."""
    rows, offsets = _rows(points, normals), ((points - feet) * normals).sum(1)
    return -np.linalg.solve(rows.T @ rows, rows.T @ offsets)


def _to_points(points: Array, feet: Array, _: Array) -> Array:
    """Both coordinates of each point count, not only the one across the wall."""
    x, y = np.repeat(np.eye(2)[:, None], len(points), 1)
    rows = np.concatenate([_rows(points, x), _rows(points, y)])
    return -_least(rows, (points - feet).T.ravel())


def _without_turn(points: Array, feet: Array, normals: Array) -> Array:
    return np.append(-_least(normals, ((points - feet) * normals).sum(1)), 0.0)


def _room(dx: float, dy: float, degrees: float) -> tuple[Array, Array, Array]:
    """Points moved off three walls of a room: the fourth is out of sight."""
    s = np.linspace(-1, 1, 5)
    feet = np.concatenate(
        [np.stack([3 + 0 * s, 2 * s], 1), np.stack([2 * s, 2 + 0 * s], 1), -np.stack([s, s**0], 1)]
    )
    normals = np.repeat([(1.0, 0.0), (0, 1), (0, -1)], 5, axis=0)
    return transform((dx, dy, np.radians(degrees)), feet), feet, normals


def _corridor(dx: float, dy: float) -> tuple[Array, Array, Array]:
    """Points between two walls along x."""
    s = np.linspace(0, 4, 5)
    feet = np.concatenate([np.stack([s, 0 * s + 1], 1), np.stack([s, 0 * s - 1], 1)])
    return feet + (dx, dy), feet, np.repeat([(0.0, 1.0), (0, -1)], 5, axis=0)


check_move_onto_walls = Exercise(
    "move_onto_walls(points, feet, normals) -> (3,): the small x, y in metres and turn in radians "
    "about the origin that minimise the squared offsets of points (n, 2) across walls through feet "
    "(n, 2) with unit normals (n, 2)",
    point_to_line_step,
    {
        "a room seen 0.2 m too far right and 0.1 m too low": _room(0.2, -0.1, 0),
        "a room seen turned by 3 degrees": _room(0, 0, 3),
        "a room moved and turned": _room(-0.1, 0.3, -4),
        "a corridor, which does not fix the motion along it": _corridor(0.3, 0.1),
    },
    {
        "the sign: the motion takes the offsets away, it does not add them again": (
            lambda p, f, n: -np.array(point_to_line_step(p, f, n))
        ),
        "points may slide along their walls: only the part of the offset along the normal counts": (
            _to_points
        ),
        "a turn moves points too: the third column is x n_y - y n_x": _without_turn,
        "angles count counter-clockwise: a small turn moves (x, y) by (-y, x), not by (y, -x)": (
            lambda p, f, n: point_to_line_step(p, f, n) * np.array((1, 1, -1))
        ),
        "the turn is in radians: for those a small turn moves a point by turn times distance": (
            lambda p, f, n: point_to_line_step(p, f, n) * np.array((1, 1, 180 / np.pi))
        ),
        "in a corridor the equations are singular: np.linalg.lstsq takes the smallest motion": (
            _solved
        ),
    },
)


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


def _hill(pose: Pose) -> float:
    return -abs(pose[0] - 0.3) - 2 * abs(pose[1] + 0.2) - abs(pose[2] - 0.4)


check_climb_step = Exercise(
    "climb_step(value, pose, move, turn) -> (3,): the best of the moves -x, +x, -y, +y, -heading, "
    "+heading, where it improves value(pose)",
    climb_step,
    {
        words: (value, np.array(pose, float), move, turn)
        for words, value, pose, move, turn in (
            ("a hill to the right", _hill, (0, 0, 0), 0.1, 0.1),
            ("a hill, nearly there", _hill, (0.3, -0.1, 0.4), 0.1, 0.1),
            ("on the top", _hill, (0.3, -0.2, 0.4), 0.1, 0.1),
            ("a plain", lambda pose: 1.0, (1, 2, 0.5), 0.1, 0.1),
            ("a valley, both ways up", lambda pose: abs(pose[1]), (0.5, 0, 0), 0.1, 0.1),
            ("a slope, the robot turned", lambda pose: 2 * pose[0] + pose[1], (0, 0, 2), 0.1, 0.1),
            ("a coarse turn", _hill, (0.3, -0.2, 0.0), 0.001, 1.0),
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
    },
)
