"""Exercises of the chapters on scores, matchers, and two maps of one building."""

from collections.abc import Callable

import numpy as np

from ..arrays import Array
from ..segments import point_distance
from ._exercise import Case, Exercise, Mistake

Value = Callable[[Array], float]


# ------------------------------------------------------------------------------ score
def _placed(points: Array, pose: Array, turn: float = 1.0) -> Array:
    c, s = np.cos(turn * pose[2]), np.sin(turn * pose[2])
    return points @ np.array([(c, s), (-s, c)]) + pose[:2]


def _distances(points: Array, pose: Array, centres: Array, turn: float = 1.0) -> Array:
    away = _placed(points, pose, turn)[:, None] - centres
    return np.linalg.norm(away, axis=-1)


def scan_score(points: Array, pose: Array, centres: Array) -> float:
    """Minus the sum of the distances from the ends to the nearest occupied cell's centre (B 4.3).

    Parameters
    ----------
    points : (n, 2) array, metres, in the robot's frame
    pose : (3,) array, metres and radians
    centres : (m, 2) array, metres

    Returns
    -------
    float, metres

    Examples
    --------
    >>> round(scan_score(np.array([(1.0, 0.0)]), np.zeros(3), np.array([(1.0, 0.2), (3, 0)])), 6)
    -0.2
    """
    return -float(_distances(points, pose, centres).min(1).sum())


_SCAN = np.array([(1.0, 0.0), (1.0, 1.0), (0.0, 2.0), (-1.0, 0.5)])
_CENTRES = np.array([(1.05, 0.05), (1.0, 1.2), (0.3, 2.0), (-1.2, 0.4), (3.0, 3.0)])

check_scan_score = Exercise(
    "scan_score",
    "scan_score(points, pose, centres) -> float: minus the sum of the distances of the ends "
    "(n, 2), carried by the pose, to the nearest centre (m, 2)",
    scan_score,
    tuple(
        Case(f"pose {tuple(pose)} and {k} beams", (_SCAN[:k], np.array(pose), _CENTRES))
        for pose, k in (
            ((0.0, 0.0, 0.0), 4),
            ((0.3, -0.2, 0.0), 4),
            ((0.0, 0.0, 0.5), 3),
            ((0.5, 0.1, -2.0), 4),
            ((0.0, 0.0, 0.0), 1),
        )
    ),
    (
        Mistake(
            "sign",
            lambda points, pose, centres: -scan_score(points, pose, centres),
            "the higher the better: distances count as a loss, so the score is never above 0",
        ),
        Mistake(
            "wrong axis",
            lambda points, pose, centres: -float(_distances(points, pose, centres).min(0).sum()),
            "every end looks for its nearest cell, not every cell for an end: a map holds many "
            "cells that this scan does not see",
        ),
        Mistake(
            "mean of all",
            lambda points, pose, centres: -float(_distances(points, pose, centres).mean(1).sum()),
            "only the nearest cell counts for each end",
        ),
        Mistake(
            "mean",
            lambda points, pose, centres: -float(_distances(points, pose, centres).min(1).mean()),
            "the sum over the beams, not their mean",
        ),
        Mistake(
            "turned backwards",
            lambda p, pose, centres: -float(_distances(p, pose, centres, -1.0).min(1).sum()),
            "the heading turns counter-clockwise: x' = x cos h - y sin h, y' = x sin h + y cos h",
        ),
        Mistake(
            "pose forgotten",
            lambda points, pose, centres: scan_score(points, np.zeros(3), centres),
            "the points are in the robot's frame: carry them by the pose first",
        ),
        Mistake(
            "degrees",
            lambda points, pose, centres: scan_score(points, pose * (1, 1, np.pi / 180), centres),
            "the heading is in radians already",
        ),
        Mistake(
            "squares",
            lambda points, pose, centres: (
                -float((_distances(points, pose, centres).min(1) ** 2).sum())
            ),
            "distances, not their squares: one beam through a door would count for all others",
        ),
    ),
)


# ------------------------------------------------------------------------------- climb
_MOVES = np.array([(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1)], float)


def climb_step(value: Value, pose: Array, move: float, turn: float) -> Array:
    """The best of six small moves, or the pose itself where none improves (B 4.3.1).

    Parameters
    ----------
    value : callable
        From a pose `(3,)` to its score.
    pose : (3,) array, metres and radians
    move, turn : float, metres and radians

    Returns
    -------
    (3,) array

    Examples
    --------
    >>> climb_step(lambda pose: -abs(pose[0] - 1), np.zeros(3), 0.1, 0.1)
    array([0.1, 0. , 0. ])
    """
    return _step(value, pose, move, turn, _MOVES)


def _step(value: Value, pose: Array, move: float, turn: float, moves: Array) -> Array:
    tried = pose + moves * (move, move, turn)
    values = np.array([value(p) for p in tried])
    return tried[int(values.argmax())] if values.max() > value(pose) else pose.copy()


def _even_if_equal(value: Value, pose: Array, move: float, turn: float) -> Array:
    tried = pose + _MOVES * (move, move, turn)
    values = np.array([value(p) for p in tried])
    return tried[int(values.argmax())] if values.max() >= value(pose) else pose.copy()


def _first_improvement(value: Value, pose: Array, move: float, turn: float) -> Array:
    for tried in pose + _MOVES * (move, move, turn):
        if value(tried) > value(pose):
            return tried
    return pose.copy()


def _last_of_equals(value: Value, pose: Array, move: float, turn: float) -> Array:
    return _step(value, pose, move, turn, _MOVES[::-1])


def _along_the_robot(value: Value, pose: Array, move: float, turn: float) -> Array:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turned = _MOVES @ np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])
    return _step(value, pose, move, turn, turned)


def _always(value: Value, pose: Array, move: float, turn: float) -> Array:
    tried = pose + _MOVES * (move, move, turn)
    return tried[int(np.argmax([value(p) for p in tried]))]


def _down(value: Value, pose: Array, move: float, turn: float) -> Array:
    return _step(lambda p: -value(p), pose, move, turn, _MOVES)


def _hill(pose: Array) -> float:
    return -abs(pose[0] - 0.3) - 2 * abs(pose[1] + 0.2) - abs(pose[2] - 0.4)


def _slope(pose: Array) -> float:
    return 2 * pose[0] + pose[1]


def _flat(pose: Array) -> float:
    return 1.0


def _valley(pose: Array) -> float:
    return abs(pose[1])


check_climb_step = Exercise(
    "climb_step",
    "climb_step(value, pose, move, turn) -> (3,): the best of the moves -x, +x, -y, +y, -heading, "
    "+heading, where it improves value(pose)",
    climb_step,
    (
        Case("a hill to the right", (_hill, np.zeros(3), 0.1, 0.1)),
        Case("a hill, nearly there", (_hill, np.array([0.3, -0.1, 0.4]), 0.1, 0.1)),
        Case("on the top", (_hill, np.array([0.3, -0.2, 0.4]), 0.1, 0.1)),
        Case("a plain", (_flat, np.array([1.0, 2.0, 0.5]), 0.1, 0.1)),
        Case("a valley, both ways up", (_valley, np.array([0.5, 0.0, 0.0]), 0.1, 0.1)),
        Case("a slope, the robot turned", (_slope, np.array([0.0, 0.0, 2.0]), 0.1, 0.1)),
        Case("a coarse turn", (_hill, np.array([0.3, -0.2, 0.0]), 0.001, 1.0)),
    ),
    (
        Mistake(
            "as good is enough",
            _even_if_equal,
            "an equal score is no improvement: on a plain the robot would walk for ever",
        ),
        Mistake(
            "first improvement",
            _first_improvement,
            "look at all six before you move: the best counts, not the first that improves",
        ),
        Mistake("last of equals", _last_of_equals, "of equal moves the first in the order counts"),
        Mistake(
            "along the robot",
            _along_the_robot,
            "the moves go along the axes of the map, not along those of the robot",
        ),
        Mistake("always moves", _always, "stay where none of the six improves the score"),
        Mistake("down the hill", _down, "the higher the better: you climb down"),
    ),
)


# ------------------------------------------------------------------------ wall errors
def _to_walls(points: Array, walls: Array) -> Array:
    return point_distance(points[:, None], walls[None])


def _to_lines(points: Array, walls: Array) -> Array:
    along = walls[:, 1] - walls[:, 0]
    away = points[:, None] - walls[:, 0]
    cross = along[:, 0] * away[..., 1] - along[:, 1] * away[..., 0]
    return np.abs(cross) / np.hypot(along[:, 0], along[:, 1])


def _to_ends(points: Array, walls: Array) -> Array:
    return np.linalg.norm(points[:, None, None] - walls[None], axis=-1).min(-1)


_WALLS = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(1, 2), (2, 3)]], float)
_POINTS = np.array([(1.0, 0.1), (2.0, 1.0), (5.0, 1.0), (5.0, -1.0), (0.5, 2.5), (-1.0, 0.0)])

check_mean_wall_error = Exercise(
    "mean_wall_error",
    "mean_wall_error(points, walls) -> float: mean distance of points (n, 2) from the nearest of "
    "the walls (m, 2, 2)",
    lambda points, walls: float(_to_walls(points, walls).min(1).mean()),
    tuple(
        Case(f"{n} points, {m} walls", (_POINTS[:n], _WALLS[:m]))
        for n, m in ((6, 3), (1, 3), (3, 1), (6, 2), (2, 2))
    ),
    (
        Mistake(
            "lines without end",
            lambda points, walls: float(_to_lines(points, walls).min(1).mean()),
            "a wall ends: beyond its ends the distance is that from the end point",
        ),
        Mistake(
            "end points only",
            lambda points, walls: float(_to_ends(points, walls).min(1).mean()),
            "beside a wall the distance is that from the foot on it, not from its ends",
        ),
        Mistake(
            "mean over walls",
            lambda points, walls: float(_to_walls(points, walls).mean()),
            "only the nearest wall counts for each point",
        ),
        Mistake(
            "wrong axis",
            lambda points, walls: float(_to_walls(points, walls).min(0).mean()),
            "every point looks for its wall: the minimum runs over the walls",
        ),
        Mistake(
            "largest",
            lambda points, walls: float(_to_walls(points, walls).min(1).max()),
            "the mean of the errors counts, not the largest",
        ),
        Mistake(
            "sum",
            lambda points, walls: float(_to_walls(points, walls).min(1).sum()),
            "the mean of the errors counts, not their sum",
        ),
    ),
)
