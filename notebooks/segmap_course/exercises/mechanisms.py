"""Exercises on one step each of methods that have no other: costs, means, noise, equations."""

from __future__ import annotations

from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.metrics import segment_distance
from segmap.segments import angle, length

from ..literal.alignment.global_segments import least_squares
from ..literal.alignment.segment_icp import segment_cost
from ..literal.floor_plan import axis_of
from ..literal.reduction.one_per_wall import spread
from ._answers import Cases, close, same_segment
from ._exercise import Exercise, Rng, edited


# -------------------------------------------------------------- segment ICP
def _scans_beside(rng: Rng) -> Cases:
    """Walls of a map, those of a scan beside them, and which are partners; some have none."""
    cases: dict[str, tuple[Any, ...]] = {}
    for words, count in (("each has a partner", 3), ("one has none", 4), ("most have none", 5)):
        x, size = rng.uniform(0, 2, (2, 4, 1))
        walls = np.stack([np.concatenate([x, x * 0 + 1], 1)] * 2, 1)
        walls[:, 1] += np.concatenate([size + 0.5, rng.uniform(-0.1, 0.1, (4, 1))], 1)
        current = np.concatenate([walls, walls])[:count] + rng.uniform(0.01, 0.2, (count, 2, 2))
        current[:, 1, 0] += rng.uniform(0, 3, count)
        near = rng.random((count, 4)) < 0.6
        near[:, 0] = True
        near[count - {3: 0, 4: 1, 5: 3}[count] :] = False
        near[0, 1] = True
        cases[words] = walls, current, near, 0.3
    return cases


def _pose_cost(reference: Array, current: Array, near: Array, penalty: float) -> float:
    """A 2.1 with the penalty inside its bracket, where each current segment has its length."""
    weights, sizes = near * length(reference), length(current)
    away = (weights * segment_distance(current[:, None], reference)).sum(axis=1)
    total = weights.sum(axis=1)
    costs = np.where(total > 0, away / np.maximum(total, 1e-9), penalty)
    return float((sizes * costs).sum() / sizes.sum())


_MEAN = "(sizes * costs).sum() / sizes.sum()"

check_pose_cost = Exercise(
    "pose_cost(reference, current, near, penalty) -> metres: segment_cost of the chapter, in which "
    "each of the current segments (m, 2, 2) counts by its length; near (m, n) says which of the "
    "reference segments (n, 2, 2) are its partners",
    _pose_cost,
    _scans_beside,
    {
        "this is segment_cost of the chapter: a short wall of the scan counts as much as a long "
        "one": segment_cost,
        "a segment without a partner costs the penalty, not nothing": edited(
            _pose_cost, ("1e-9), penalty)", "1e-9), 0.0)")
        ),
        "a long wall without a partner counts for more than a short one, too": edited(
            _pose_cost, (_MEAN, "(np.where(total > 0, sizes, 1.0) * costs).sum() / sizes.sum()")
        ),
        "the cost is a mean: divide by the sum of the lengths": edited(
            _pose_cost, (_MEAN, "(sizes * costs).sum()")
        ),
        "divide by the lengths of all segments, not by their number": edited(
            _pose_cost, (_MEAN, "(sizes * costs).mean()")
        ),
        "partners still count by their own lengths": edited(
            _pose_cost, ("near * length(reference)", "near * 1.0")
        ),
    },
    close,
)


# -------------------------------------------------------------- one per wall
def _looks_apart(rng: Rng) -> Cases:
    """All pairs of scans, one of which was pushed; and some pairs that are looks at two walls."""
    noise, k = rng.uniform(0.01, 0.02), int(rng.integers(2, 12))
    off = rng.normal(0, noise, 14)
    off[k] = rng.uniform(4, 6) * noise
    scans = np.argwhere(np.tri(14, k=-1))
    apart = off[scans[:, 0]] - off[scans[:, 1]]
    two = rng.choice(len(apart), 6, replace=False)
    walls = apart.copy()
    walls[two] += 20 * noise
    return {
        "a scan that was pushed": (apart, scans, k, float(noise)),
        "the same, and some pairs at two walls": (walls, scans, k, float(noise)),
        "a scan that was not pushed": (apart, scans, k - 1, 0.3 * float(noise)),
        "a scan better than all others": (apart / 9, scans, k - 1, float(noise)),
    }


def _scan_noise(apart: Array, scans: Array, k: int, noise: float) -> float:
    """Deviation of one scan, where the other look of each of its pairs errs by the noise."""
    own = spread(apart[(scans == k).any(axis=1)])
    return float(max(own**2 - noise**2, 0.0) ** 0.5)


check_scan_noise = Exercise(
    "scan_noise(apart, scans, k, noise) -> metres: the deviation of the looks of scan k, from what "
    "the looks of each pair are apart, (n,), and the scans of both, (n, 2); the other look of a "
    "pair has the noise of all looks, and the squares of both deviations add up; 0 where none is "
    "left",
    _scan_noise,
    _looks_apart,
    {
        "this is the noise of the chapter, of all looks: take the pairs of scan k alone": (
            lambda apart, scans, k, noise: spread(apart) / np.sqrt(2)
        ),
        "take the pairs of scan k alone, in which either look may be its": edited(
            _scan_noise, ("apart[(scans == k).any(axis=1)]", "apart")
        ),
        "a scan may be the second of a pair, too": edited(
            _scan_noise, ("(scans == k).any(axis=1)", "scans[:, 0] == k")
        ),
        "both looks of a pair err: subtract the square of the noise": edited(
            _scan_noise, ("own**2 - noise**2", "own**2")
        ),
        "the looks of a pair do not err alike here: no root of 2": edited(
            _scan_noise, ("max(own**2 - noise**2, 0.0) ** 0.5", "own / np.sqrt(2)")
        ),
        "deviations do not add up, their squares do": edited(
            _scan_noise, ("max(own**2 - noise**2, 0.0) ** 0.5", "max(own - noise, 0.0)")
        ),
        "looks at two walls are no noise: spread cuts what is far off": edited(
            _scan_noise, ("spread(", "np.std(")
        ),
    },
    close,
)


# -------------------------------------------------------------- fuzzy set
def _two_axes(rng: Rng) -> Cases:
    """Walls along the two directions of a turned building, and one that is slanted."""
    axis = rng.uniform(0.2, 1.3)
    along = axis + rng.integers(0, 4, 8) * np.pi / 2 + rng.normal(0, 0.02, 8)
    slanted, sizes = axis + rng.uniform(0.5, 0.7), rng.uniform(1, 6, 9)
    return {
        "walls along two axes": (along, sizes[:8]),
        "and a short slanted one": (np.append(along, slanted), np.append(sizes[:8], 0.5)),
    }


def _building_axis(angles: Array, lengths: Array) -> float:
    """The mean of four times the angle, weighted by length, over four."""
    s, c = (lengths * np.sin(4 * angles)).sum(), (lengths * np.cos(4 * angles)).sum()
    return float(np.arctan2(s, c) / 4 % (np.pi / 2))


check_building_axis = Exercise(
    "building_axis(angles, lengths) -> radians, in [0, pi/2): the axis of a building from the "
    "angles (n,) of its walls and their lengths (n,): the angle of the sum of the unit vectors at "
    "four times each angle, each times its length, over four",
    _building_axis,
    _two_axes,
    {
        "two directions at right angles are one at four times the angle, not at twice": edited(
            _building_axis,
            ("np.sin(4 * angles)", "np.sin(2 * angles)"),
            ("np.cos(4 * angles)", "np.cos(2 * angles)"),
            ("/ 4 %", "/ 2 %"),
        ),
        "a long wall says more than a short one: weight by length": edited(
            _building_axis, ("lengths * np.sin", "np.sin"), ("lengths * np.cos", "np.cos")
        ),
        "the angle of the sum is four times the axis": edited(_building_axis, ("/ 4 %", "%")),
        "arctan2 takes the sine first": edited(_building_axis, ("arctan2(s, c)", "arctan2(c, s)")),
        "between 0 and a quarter of a turn": edited(_building_axis, (" % (np.pi / 2)", "")),
    },
    close,
)


# -------------------------------------------------------------- polylines
def _chains(rng: Rng) -> Cases:
    """Three members of a chain, of which the longest need not have the farthest ends."""
    ends = rng.uniform(-2, 2, (3, 2, 2))
    far = np.array([[(0.0, 0.0), (1, 0)], [(0.9, 0.1), (3, 0.2)], [(2.5, 0.3), (4, 0.9)]])
    return {
        "three members": (ends,),
        "a chain in a row": (far + rng.uniform(-0.1, 0.1, (3, 2, 2)),),
    }


def _far_ends(members: Array) -> Array:
    """The two end points that are farthest apart."""
    points = members.reshape(-1, 2)
    apart = np.hypot(*np.moveaxis(points[:, None] - points, -1, 0))
    return np.asarray(points[list(np.unravel_index(apart.argmax(), apart.shape))])


def _of_the_longest(members: Array) -> Array:
    return np.asarray(members[np.hypot(*(members[:, 1] - members[:, 0]).T).argmax()])


check_far_ends = Exercise(
    "far_ends(members) -> (2, 2): of all end points of segments (n, 2, 2), the two that are "
    "farthest apart, in any order",
    _far_ends,
    _chains,
    {
        "ends of different members may be farther apart than those of the longest": _of_the_longest,
        "the first and the last need not be the farthest": lambda m: np.stack([m[0, 0], m[-1, 1]]),
        "end points, not middles": lambda m: _far_ends(np.repeat(m.mean(axis=1), 2, 0)[None]),
        "farthest in the plane, not along x": (
            lambda m: m.reshape(-1, 2)[[m[..., 0].argmin(), m[..., 0].argmax()]]
        ),
    },
    same_segment,
)


# -------------------------------------------------------------- all scans at once
#: Two places, how far the second lies beyond the first where that was measured, and the weight.
Rows = list[tuple[int, int, float, float]]


def _between(rng: Rng) -> Cases:
    """Places of which some are known, and none of them is 0."""

    def some(known: list[float], *pairs: tuple[int, int]) -> tuple[Rows, Array]:
        steps = [(i, j, j - i + rng.uniform(-0.3, 0.3), rng.uniform(0.5, 3)) for i, j in pairs]
        return steps, np.array(known) + rng.uniform(0.1, 0.5)

    nan = np.nan
    return {
        "both ends known": some([0, nan, nan, 3], (0, 1), (1, 2), (2, 3), (0, 2)),
        "one in the middle known": some([nan, 1, nan, nan], (1, 0), (1, 2), (2, 3), (1, 3)),
    }


def _places_between(rows: Rows, known: Array) -> Array:
    """As `literal.least_squares`, with the known places held."""
    b, a = np.zeros((len(known), len(known))), np.zeros(len(known))
    for i, j, c, w in rows:
        b[i, i], b[j, j] = b[i, i] + w, b[j, j] + w
        b[i, j], b[j, i] = b[i, j] - w, b[j, i] - w
        a[i], a[j] = a[i] - w * c, a[j] + w * c
    free, x = np.isnan(known), known.copy()
    right = a[free] - b[np.ix_(free, ~free)] @ known[~free]
    x[free] = np.linalg.solve(b[np.ix_(free, free)], right)
    return x


check_places_between = Exercise(
    "places_between(rows, known) -> (n,): the places x with the least sum of w (x_i - x_j + c)^2 "
    "over all rows (i, j, c, w), where those that are known stay; known (n,) is NaN where a place "
    "is not",
    _places_between,
    _between,
    {
        "the chapter's least_squares takes a count, and holds the first place alone": least_squares,
        "hold what is known, where it is known; the chapter holds the first at 0": (
            lambda rows, known: np.array(least_squares(rows, len(known)))
        ),
        "a known place pulls at its neighbours: B times what is known goes to the right side": (
            edited(_places_between, (" - b[np.ix_(free, ~free)] @ known[~free]", ""))
        ),
        "with its minus sign: what is known goes to the other side": edited(
            _places_between, (" - b[np.ix_(free, ~free)]", " + b[np.ix_(free, ~free)]")
        ),
        "each row counts by its weight": lambda rows, known: _places_between(
            [(i, j, c, 1.0) for i, j, c, _ in rows], known
        ),
        "x_j lies c beyond x_i: look at the signs of A": lambda rows, known: _places_between(
            [(i, j, -c, w) for i, j, c, w in rows], known
        ),
    },
    close,
)


# ------------------------------------------------------------------ axes of a building
#: Walls that are turned by no more belong to an axis, degrees; fewer metres have none.
AXIS_DEG, LEAST_AXIS_M = 8, 2.0


def _walls_along(rng: Rng, axis: float, sizes: Array) -> Array:
    """Walls of these metres along or across an axis, degrees, two degrees askew."""
    turn = np.radians(axis + 90 * rng.integers(4, size=len(sizes)) + rng.uniform(-2, 2, len(sizes)))
    start = rng.uniform(0, 9, (len(sizes), 2))
    way = np.column_stack([np.cos(turn), np.sin(turn)])
    return np.stack([start, start + sizes[:, None] * way], axis=1)


def _wings(rng: Rng) -> Cases:
    """A hall and wings askew: long and short walls, an axis near 0, a few pieces with none."""
    cases: dict[str, tuple[Any, ...]] = {}
    for words, first in (("a wing", 30.0), ("a hall along x", 0.0), ("two wings", 50.0)):
        axis = first + rng.uniform(-1, 1)
        parts = [_walls_along(rng, axis, rng.uniform(3, 6, 6))]
        parts += [_walls_along(rng, axis + 25 + rng.uniform(-2, 2), rng.uniform(0.4, 0.9, 22))]
        parts += [_walls_along(rng, axis - 25, rng.uniform(1, 2, 4))] * (words == "two wings")
        parts += [_walls_along(rng, axis + 45, rng.uniform(0.5, 0.9, 2))] * (words == "a wing")
        cases[words] = (rng.permutation(np.concatenate(parts)),)
    return cases


def _axes_of(walls: Array) -> Array:
    """All axes: `axis_of` of chapter 28, then again without the walls of each."""
    axes, places = list[float](), np.arange(0, 90, 0.25)
    while length(walls).sum() >= LEAST_AXIS_M:
        turn = np.degrees(angle(walls))
        apart = abs((places[:, None] - turn + 45) % 90 - 45)
        best = (np.clip(1 - apart / 6, 0, None) @ length(walls)).argmax()
        axes.append(places[best])
        walls = walls[apart[best] > AXIS_DEG]
    return np.array(axes)


check_axes_of = Exercise(
    "axes_of(walls) -> (k,) degrees in [0, 90), steps of 0.25: the axes of walls (n, 2, 2), the "
    "strongest first. An axis takes the walls that are turned from it, or from across it, by at "
    "most 8 degrees; those left over are searched again, while they have at least two metres",
    _axes_of,
    _wings,
    {
        "this is the one axis of the chapter: the walls left over have an axis of their own": (
            axis_of
        ),
        "one axis is not all: search again among the walls left over": (
            lambda walls: [axis_of(walls)]
        ),
        "each wall votes with its metres: many short pieces are no strong axis": edited(
            _axes_of, ("None) @ length(walls))", "None).sum(1))")
        ),
        "89.9 and 0.1 degrees are nearly one direction: differences are modulo 90, too": edited(
            _axes_of, ("(places[:, None] - turn + 45) % 90 - 45", "places[:, None] - turn % 90")
        ),
        "along and across are one axis: directions are modulo 90, not 180": edited(
            _axes_of, ("90, 0.25", "180, 0.25"), ("turn + 45) % 90 - 45", "turn + 90) % 180 - 90")
        ),
        "an axis takes its walls out before the next is searched; else it is found again beside": (
            edited(_axes_of, ("[apart[best] > AXIS_DEG]", "[apart[best] > 0.25]"))
        ),
        "fewer than two metres left over have no axis": edited(
            _axes_of, (">= LEAST_AXIS_M", "> 0")
        ),
        "the strongest first: in the order in which they are found, not by their degrees": edited(
            _axes_of, ("return np.array(axes)", "return np.sort(axes)")
        ),
    },
    close,
)
