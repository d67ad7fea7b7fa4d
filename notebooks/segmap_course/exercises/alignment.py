"""Exercises on alignment: value of a match, shift of a backbone, step of ICP and what it fixes."""

from __future__ import annotations

import numpy as np

from segmap.alignment import least_translation, match_values
from segmap.arrays import Array
from segmap.poses import transform
from segmap.segments import length

from ..literal.alignment.angle_correspondence import match_value
from ..literal.alignment.backbone import translation_of
from ..literal.alignment.point_to_line import point_to_line_step, residuals, weights
from ._answers import Cases, near
from ._exercise import Exercise, Rng, anywhere, changed, edited


# --------------------------------------------------------------- angle correspondence
def _pairs(rng: Rng) -> Cases:
    """Pairs that cover each other wholly, in part and not at all, placed anywhere."""
    off, more = rng.uniform(0.02, 0.04, 2)
    size, part = rng.uniform(2, 4), rng.uniform(0.2, 0.4)
    place, distance = anywhere(rng), float(rng.uniform(0.03, 0.08))
    long = [(0, 0), (size, 0)]
    short = [(part * size, off), (2 * part * size, off + more)]
    later = [(part * size, off), ((1 + part) * size, off)]
    slanting = [(part, 0.03), (part + 0.25, 0.08)]
    return {
        words: (transform(place, u), transform(place, v), distance)
        for words, u, v in (
            ("two parallel walls", long, [(0, off), (size, off)]),
            ("a short wall beside a long one", long, short),
            ("walls of which each has an end that the other has not", long, later),
            ("the same, leaning", long, [later[0], ((1 + part) * size, off + more)]),
            ("a short wall that slants, of which each measures another D", slanting, long),
            ("walls one behind the other", long, [(size + 0.2, off), (size + 2, off)]),
        )
    }


def _match_value(u: Array, v: Array, distance: float) -> float:
    """What the library finds for one pair."""
    return float(match_values(u[None], v[None], distance=distance)[0, 0])


def _value(u: Array, v: Array, distance: float) -> float:
    """The same for one pair, of which the mistakes change a part."""
    lengths, aparts = [], []
    for a, b in ((u, v), (v, u)):
        way = (a[1] - a[0]) / length(a)
        low, high = np.sort((b - a[0]) @ way)
        lengths.append(max(0.0, min(high, length(a)) - max(low, 0.0)))
        aparts.append(abs((b - a[0]) @ (-way[1], way[0])).max())
    return float(sum(lengths) / 2 * 0.95 ** (min(aparts) / distance))


check_match_value = Exercise(
    "match_value(u, v, distance) -> float, metres: the match value of the chapter of two segments "
    "(2, 2) that do not cross, but with a D that only asks how far apart the parts are that both "
    "cover of each other: the farthest point of the part of v beside u from u, the same of u from "
    "v, and of both the smaller",
    _match_value,
    _pairs,
    {
        "this is the match value of the chapter, for which an end that only one scan has seen is "
        "far away: cut each segment where the other one ends": lambda u, v, distance: match_value(
            u.tolist(), v.tolist(), distance
        ),
        "this is the length of u that v covers; take the mean of it and of the length of v that "
        "u covers": edited(_value, ("sum(lengths) / 2", "lengths[0]")),
        "the mean of both lengths is wanted, not their sum": edited(_value, (" / 2 *", " *")),
        "the length is right; multiply it by 0.95 ** (D / distance)": (
            edited(_value, (" * 0.95 ** (min(aparts) / distance)", ""))
        ),
        "D is measured in units of `distance`: divide by that": edited(_value, ("/ distance", "")),
        "D asks for the farthest point, not for the nearest": (
            edited(_value, (".max()", ".min()"))
        ),
        "D is how far the walls are apart, not their middles": (
            edited(_value, ("min(aparts)", "np.hypot(*(u.mean(axis=0) - v.mean(axis=0)))"))
        ),
        "two walls one behind the other cover nothing: no length is less than 0": (
            edited(
                _value,
                (
                    "max(0.0, min(high, length(a)) - max(low, 0.0))",
                    "min(high, length(a)) - max(low, 0.0)",
                ),
            )
        ),
    },
    # From the line of u, or from what v covers of it: the same but for the lean of the walls.
    lambda found, expected: bool(np.shape(found) == () and abs(found - expected) < 1e-4),
)


# --------------------------------------------------------------------------- backbone
def _lines_off(rng: Rng) -> Cases:
    """Unit normals of lines, how far points lie off them, and weights; also of corridors."""

    def lines(*degrees: float) -> tuple[Array, Array, Array]:
        turn, count = np.radians(degrees), len(degrees)
        normals = np.stack([-np.sin(turn), np.cos(turn)], -1)
        return normals, rng.uniform(-0.1, 0.1, count), rng.uniform(1, 3, count)

    def askew() -> tuple[Array, Array, Array]:
        """A corridor that rounding leaves a little width across: no number is divided by that."""
        while True:
            corridor = normals, _, weights = lines(*[rng.uniform(10, 80)] * 3)
            if np.linalg.eigvalsh(normals.T @ (normals * weights[:, None]))[0] > 0:
                return corridor

    turn = rng.uniform(10, 80)
    return {
        "a corner": lines(turn, turn + 90, turn + rng.uniform(20, 70)),
        "two walls at a slant": lines(turn, turn + rng.uniform(60, 120)),
        "a corridor": lines(0, 0, 0),
        "a corridor that runs askew": lines(turn, turn),
        "a corridor of three walls, askew": askew(),
        "another corridor, askew": askew(),
        "a corridor with walls that noise turns": lines(turn, turn + rng.uniform(0.1, 1)),
        "walls of many directions": lines(*(turn + np.arange(0, 180, 36))),
    }


check_least_translation = Exercise(
    "least_translation(normals, offsets, weights) -> (2,) metres: the shortest of the shifts that "
    "minimise the weighted squares of the distances from lines, given their normals (m, 2) and how "
    "far the points now lie from them, (m,) metres; a direction that the lines hold by less than "
    "0.3 of the other (rcond) counts as not held",
    least_translation,
    _lines_off,
    {
        "this doubles the distances: a point above its line must come down, so mind the sign": (
            changed(least_translation, np.negative)
        ),
        "points move across the lines, along the normals: a shift along a line changes nothing": (
            lambda normals, *rest: least_translation(normals[:, ::-1] * (1, -1), *rest)
        ),
        "each row counts by its weight: a long wall says more than a short one": (
            lambda normals, offsets, weights: least_translation(normals, offsets, weights**0)
        ),
        "least squares squares its rows: multiply them by the root of the weight": (
            lambda normals, offsets, weights: least_translation(normals, offsets, weights**2)
        ),
        "in a corridor the matrix is singular: take the shortest solution (numpy.linalg.lstsq)": (
            translation_of
        ),
        "noise turns the walls of a corridor: give numpy.linalg.lstsq the chapter's rcond": (
            lambda *given: least_translation(*given, parallel=1e-9)
        ),
        "a mean of the single corrections goes only part of the way where lines differ in "
        "direction: solve for the shift": lambda normals, offsets, weights: (
            -(normals * (weights * offsets)[:, None]).sum(0) / weights.sum()
        ),
        "weigh the rows and what they shall become alike: both by the root of the weight": (
            lambda normals, offsets, weights: least_translation(
                normals, offsets / np.sqrt(weights), weights
            )
        ),
    },
    near,
)


# ---------------------------------------------------------------------------------- ICP
def _rooms(rng: Rng) -> Cases:
    """Points off three walls of a room, or off the two of a corridor: all of them askew."""
    s = np.linspace(-1, 1, 5)
    room = np.concatenate(
        [np.stack([3 + 0 * s, 2 * s], 1), np.stack([2 * s, 2 + 0 * s], 1), -np.stack([s, s**0], 1)]
    )
    corridor = np.concatenate([np.stack([2 + 2 * s, 0 * s + side], 1) for side in (1, -1)])
    turn = (0, 0, rng.uniform(-np.pi, np.pi))

    def seen(
        walls: Array, ways: list[tuple[int, int]], *off: float, wrong: float = 0.0
    ) -> tuple[Array, Array, Array]:
        feet = transform(turn, walls)
        feet[::6] += wrong
        return transform(off, feet), feet, transform(turn, np.repeat(ways, 5, axis=0))

    dx, dy, away = rng.uniform(0.1, 0.3, 3)
    degrees, ways = np.radians(rng.uniform(2, 5)), [(1, 0), (0, 1), (0, -1)]
    return {
        "a room that is shifted": seen(room, ways, dx, -dy, 0),
        "a room that is turned": seen(room, ways, 0, 0, degrees),
        "a room that is shifted and turned": seen(room, ways, -dx, dy, -degrees),
        "a room where some partners are wrong": seen(room, ways, dx, -dy, 0, wrong=2.0),
        "a corridor, which does not fix the motion along it": seen(corridor, ways[1:], dx, away, 0),
    }


def _in_arrays(points: Array, feet: Array, normals: Array) -> Array:
    """The same in arrays, of which the mistakes change a part."""
    lever = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    rows, offsets = np.column_stack([normals, lever]), residuals(points, feet, normals)
    root = np.sqrt(weights(offsets))
    return -np.asarray(np.linalg.lstsq(root[:, None] * rows, root * offsets, rcond=1e-9)[0], float)


def smallest_move(points: Array, feet: Array, normals: Array) -> Array:
    """The step of the chapter, and of equally good ones the smallest."""
    counted = weights(residuals(points, feet, normals))
    parts = points.tolist(), feet.tolist(), normals.tolist(), counted.tolist()
    return np.array(point_to_line_step(*parts))


def _to_points(points: Array, feet: Array, _: Array) -> Array:
    """Both coordinates of each point count, not only the one across the wall."""
    axes = np.repeat(np.eye(2), len(points), axis=0)
    return _in_arrays(np.tile(points, (2, 1)), np.tile(feet, (2, 1)), axes)


check_move_onto_walls = Exercise(
    "move_onto_walls(points, feet, normals) -> (3,): the small x, y in metres and turn in radians "
    "about the origin that minimise the weighted squares of the residuals of points (n, 2) from "
    "walls through feet (n, 2) with unit normals (n, 2), weighted as in the chapter; of equally "
    "good moves the smallest",
    smallest_move,
    _rooms,
    {
        "the sign: the motion takes the offsets away, it does not add them again": (
            changed(smallest_move, np.negative)
        ),
        "points may slide along their walls: only the part of the offset along the normal counts": (
            _to_points
        ),
        "a turn moves points too: the third column is x n_y - y n_x": (
            edited(_in_arrays, ("[normals, lever]", "[normals, 0 * lever]"))
        ),
        "angles count counter-clockwise: a small turn moves (x, y) by (-y, x), not by (y, -x)": (
            lambda p, f, n: smallest_move(p, f, n) * np.array((1, 1, -1))
        ),
        "the turn is in radians: for those a small turn moves a point by turn times distance": (
            lambda p, f, n: smallest_move(p, f, n) * np.array((1, 1, 180 / np.pi))
        ),
        "a residual that is large beside the others counts less: its weight is below 1": (
            edited(_in_arrays, ("np.sqrt(weights(offsets))", "np.ones(len(offsets))"))
        ),
        "in a corridor the equations are singular: np.linalg.lstsq takes the smallest motion": (
            edited(
                _in_arrays,
                (
                    "lstsq(root[:, None] * rows, root * offsets, rcond=1e-9)[0]",
                    "solve(rows.T @ (root[:, None] ** 2 * rows), rows.T @ (root**2 * offsets))",
                ),
            )
        ),
        "the turn is one about the origin: with the third column taken about the middle of the "
        "points x and y come out differently": (
            lambda p, f, n: smallest_move(p - p.mean(0), f - p.mean(0), n)
        ),
    },
    near,
)


# ----------------------------------------------------------- what the walls of a scan fix
def _wall_normals(rng: Rng) -> Cases:
    """Unit normals of points on walls, and weights: rooms, corridors and what lies between."""

    def walls(*degrees: float) -> tuple[Array, Array]:
        turn = np.radians(rng.uniform(0, 90) + np.repeat(degrees, 6))
        return np.stack([np.cos(turn), np.sin(turn)], -1), rng.uniform(0.2, 1, len(turn))

    return {
        "a room": walls(0, 90),
        "a room with one long side": walls(0, 0, 0, 90),
        "a corridor": walls(0, 180),
        "a corridor with an oblique end": walls(0, 180, rng.uniform(20, 60)),
        "a round tower": walls(*range(0, 360, 30)),
    }


def _flatness(normals: Array, weights: Array) -> float:
    """Smaller eigenvalue over larger of the weighted sum of n n^T."""
    low, high = np.linalg.eigvalsh((weights[:, None] * normals).T @ normals)
    return float(max(low, 0) / high)


check_flatness = Exercise(
    "flatness(normals, weights) -> float, 0 to 1: given the unit normals (n, 2) of the walls below "
    "the points of a scan, and weights (n,), the smaller eigenvalue over the larger of the (2, 2) "
    "part of H that belongs to x and y; the library calls a direction free where it is below 0.01",
    _flatness,
    _wall_normals,
    {
        "each point counts by its weight": lambda n, w: _flatness(n, w**0),
        "the weight stands once in H: w n n^T": lambda n, w: _flatness(n, w**2),
        "the smaller over the larger, not the larger over the smaller": (
            edited(_flatness, ("max(low, 0) / high", "high / max(low, 1e-9)"))
        ),
        "singular values of the rows are roots of the eigenvalues of H: square them": (
            edited(_flatness, ("max(low, 0) / high", "np.sqrt(max(low, 0) / high)"))
        ),
        "this is the smaller one alone: divide by the larger": (
            edited(_flatness, ("max(low, 0) / high", "max(low, 0)"))
        ),
        "the diagonal of H holds no eigenvalues where walls run askew": lambda n, w: float(
            np.divide(*np.sort((w[:, None] * n**2).sum(axis=0)))
        ),
    },
    near,
)
