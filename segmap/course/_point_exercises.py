"""Exercises of the chapters on ground truth and on point ICP."""

import numpy as np

from ..angles import wrap
from ..arrays import Array
from ._exercise import Case, Exercise, Mistake


def heading_between(before: float, after: float, share: float) -> float:
    """Heading at a share of the way between two others, by the shorter way round (A 3.3.3).

    Parameters
    ----------
    before, after : float, radians
    share : float
        0 at the first, 1 at the second.

    Returns
    -------
    float, radians, in `[-pi, pi)`

    Examples
    --------
    >>> round(float(np.degrees(heading_between(np.radians(170), np.radians(-170), 0.25))), 6)
    175.0
    """
    return float(wrap(before + share * wrap(after - before)))


def move_onto_walls(points: Array, feet: Array, normals: Array) -> Array:
    """One step of point-to-line ICP: the motion that brings points nearest to their walls.

    Parameters
    ----------
    points : (n, 2) array, metres
    feet : (n, 2) array, metres
        A place on the wall of each.
    normals : (n, 2) array
        Unit vectors across the walls.

    Returns
    -------
    (3,) array, metres and radians
        Shift in x and y and turn about the origin, as for a small turn; least squares, and of
        equally good ones the smallest.

    Examples
    --------
    >>> wall = np.array([(0.0, 0.0), (1, 0), (2, 0)])
    >>> move_onto_walls(wall + (0, 0.5), wall, np.array([(0, 1.0)] * 3)).round(6) + 0.0
    array([ 0. , -0.5,  0. ])
    """
    return -_least(_rows(points, normals), ((points - feet) * normals).sum(1))


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


def _turned_back(points: Array, feet: Array, normals: Array) -> Array:
    return move_onto_walls(points, feet, normals) * (1, 1, -1)


def _headings(words: str, before: float, after: float, share: float) -> Case:
    return Case(words, (np.radians(before), np.radians(after), share))


check_heading_between = Exercise(
    "heading_between",
    "heading_between(before, after, share) -> heading at that share of the way from before to "
    "after, by the shorter way round; radians, in [-pi, pi)",
    heading_between,
    (
        _headings("a quarter of the way from 10 to 50 degrees", 10, 50, 0.25),
        _headings("half the way from 170 to -160 degrees", 170, -160, 0.5),
        _headings("a quarter of the way from -170 to 150 degrees", -170, 150, 0.25),
        _headings("nine tenths of the way from 170 to -160 degrees", 170, -160, 0.9),
        _headings("from 100 to 20 degrees", 100, 20, 0.3),
    ),
    (
        Mistake(
            "plain numbers",
            lambda a, b, t: a + t * (b - a),
            "from 170 to -170 degrees is a turn of 20, not of -340: wrap the difference first",
        ),
        Mistake(
            "result not wrapped",
            lambda a, b, t: a + t * float(wrap(b - a)),
            "the heading runs over half a turn: bring the result back with segmap.angles.wrap",
        ),
        Mistake(
            "always to the left",
            lambda a, b, t: float(wrap(a + t * ((b - a) % (2 * np.pi)))),
            "the shorter way may be clockwise: a turn lies between minus and plus half a turn",
        ),
        Mistake(
            "from the wrong end",
            lambda a, b, t: heading_between(b, a, t),
            "a share of 0 is the heading before, of 1 the heading after",
        ),
        Mistake(
            "degrees",
            lambda a, b, t: np.degrees(heading_between(a, b, t)),
            "headings are in radians: hand the answer back as it came",
        ),
    ),
)


def _room(dx: float, dy: float, degrees: float) -> tuple[Array, Array, Array]:
    """Points moved off three walls of a room: the fourth is out of sight."""
    s = np.linspace(-1, 1, 5)
    feet = np.concatenate(
        [np.stack([3 + 0 * s, 2 * s], 1), np.stack([2 * s, 2 + 0 * s], 1), -np.stack([s, s**0], 1)]
    )
    normals = np.repeat([(1.0, 0.0), (0, 1), (0, -1)], 5, axis=0)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return feet @ np.array([(c, s), (-s, c)]) + (dx, dy), feet, normals


def _corridor(dx: float, dy: float) -> tuple[Array, Array, Array]:
    """Points between two walls along x."""
    s = np.linspace(0, 4, 5)
    feet = np.concatenate([np.stack([s, 0 * s + 1], 1), np.stack([s, 0 * s - 1], 1)])
    return feet + (dx, dy), feet, np.repeat([(0.0, 1.0), (0, -1)], 5, axis=0)


check_move_onto_walls = Exercise(
    "move_onto_walls",
    "move_onto_walls(points, feet, normals) -> (3,): the small x, y in metres and turn in radians "
    "about the origin that minimise the squared offsets of points (n, 2) across walls through feet "
    "(n, 2) with unit normals (n, 2)",
    move_onto_walls,
    (
        Case("a room seen 0.2 m too far right and 0.1 m too low", _room(0.2, -0.1, 0)),
        Case("a room seen turned by 3 degrees", _room(0, 0, 3)),
        Case("a room moved and turned", _room(-0.1, 0.3, -4)),
        Case("a corridor, which does not fix the motion along it", _corridor(0.3, 0.1)),
    ),
    (
        Mistake(
            "the other way",
            lambda p, f, n: -move_onto_walls(p, f, n),
            "the sign: the motion takes the offsets away, it does not add them again",
        ),
        Mistake(
            "point to point",
            _to_points,
            "points may slide along their walls: only the part of the offset along the normal "
            "counts",
        ),
        Mistake(
            "no turn",
            _without_turn,
            "a turn moves points too: the third column is x n_y - y n_x",
        ),
        Mistake(
            "turned the wrong way",
            _turned_back,
            "angles count counter-clockwise: a small turn moves (x, y) by (-y, x), not by (y, -x)",
        ),
        Mistake(
            "degrees",
            lambda p, f, n: move_onto_walls(p, f, n) * (1, 1, 180 / np.pi),
            "the turn is in radians: for those a small turn moves a point by turn times distance",
        ),
        Mistake(
            "normal equations",
            _solved,
            "in a corridor the equations are singular: np.linalg.lstsq takes the smallest motion",
        ),
    ),
)
