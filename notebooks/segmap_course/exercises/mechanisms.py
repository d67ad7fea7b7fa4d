"""Exercises on one step each of methods that have no other: costs, means, noise, equations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmap.arrays import Array

from ._answers import Cases, close, same_poses, same_segment
from ._exercise import Exercise, Rng, edited


# -------------------------------------------------------------- segment ICP
def _scans_beside(rng: Rng) -> Cases:
    """Distances of three to five segments from four of the map, which correspond or not."""
    cases: dict[str, tuple[Any, ...]] = {}
    for words, count in (("each has a partner", 3), ("one has none", 4), ("most have none", 5)):
        beside = rng.random((count, 4)) < 0.6
        beside[:, 0] = True
        beside[count - {3: 0, 4: 1, 5: 3}[count] :] = False
        beside[0, 1] = True
        cases[words] = rng.uniform(0.01, 0.2, (count, 4)), beside, rng.uniform(0.5, 4, 4), 0.3
    return cases


def _pose_cost(distances: Array, beside: Array, lengths: Array, penalty: float) -> float:
    """A 2.1 with the penalty inside its bracket."""
    total = 0.0
    for row, partners in zip(distances, np.asarray(beside, bool), strict=True):
        weights = np.where(partners, lengths, 0.0)
        total += (weights * row).sum() / weights.sum() if partners.any() else penalty
    return float(total / len(distances))


check_pose_cost = Exercise(
    "pose_cost(distances, beside, lengths, penalty) -> metres: of m segments of a scan, whose "
    "distances (m, n) from n segments of the map are known, the mean of what each costs: the mean "
    "distance from those that it lies beside, (m, n) true or false, weighted with their lengths "
    "(n,), or the penalty where there is none",
    _pose_cost,
    _scans_beside,
    {
        "a segment without a partner costs the penalty, not nothing": edited(
            _pose_cost, ("else penalty", "else 0.0")
        ),
        "long walls of the map count for more: weight with their lengths": edited(
            _pose_cost, ("np.where(partners, lengths, 0.0)", "partners * 1.0")
        ),
        "the cost is a mean over the segments, not their sum": edited(
            _pose_cost, ("total / len(distances)", "total")
        ),
        "only those that it lies beside count": edited(
            _pose_cost, ("np.where(partners, lengths, 0.0)", "lengths")
        ),
        "the mean of all its partners, not the nearest of them": edited(
            _pose_cost, ("(weights * row).sum() / weights.sum()", "row[partners].min()")
        ),
    },
    close,
)


# -------------------------------------------------------------- segment similarity
def _two_lines(rng: Rng) -> Cases:
    """Two segments that are nearly parallel, also where the numbers of their angles jump."""
    cases: dict[str, tuple[Any, ...]] = {}
    for words, at in (("two slanted walls", rng.uniform(0.3, 1.2)), ("two level walls", 0.0)):
        ends = []
        for turn in rng.uniform(0.02, 0.12, 2) * (1, -1):
            along = np.array([np.cos(at + turn), np.sin(at + turn)])
            middle, half = rng.uniform(-3, 3, 2), rng.uniform(0.5, 2)
            ends.append(np.stack([middle - half * along, middle + half * along]))
        ends[1] = ends[1][::-1]
        cases[words] = *ends, float(rng.integers(2, 5)), 1.0
    return cases


def _mean_line(u: Array, v: Array, weight_u: float, weight_v: float) -> Array:
    """The weighted mean of the middles, and of the directions as those of undirected lines."""
    share = weight_v / (weight_u + weight_v)
    at_u, at_v = (float(np.arctan2(*(s[1] - s[0])[::-1])) for s in (u, v))
    turn = (at_v - at_u + np.pi / 2) % np.pi - np.pi / 2
    middle = (1 - share) * u.mean(axis=0) + share * v.mean(axis=0)
    return np.array([*middle, at_u + share * turn])


check_mean_line = Exercise(
    "mean_line(u, v, weight_u, weight_v) -> (3,): x, y and direction, metres and radians, of the "
    "mean line of two segments (2, 2): through the weighted mean of their middles, in the weighted "
    "mean of their directions, which differ by less than a quarter of a turn",
    _mean_line,
    _two_lines,
    {
        "a line has no direction: the second may be told the other way round": edited(
            _mean_line, ("(at_v - at_u + np.pi / 2) % np.pi - np.pi / 2", "at_v - at_u")
        ),
        "a segment that stands for three looks counts three times": edited(
            _mean_line, ("weight_v / (weight_u + weight_v)", "0.5")
        ),
        "the heavy one decides: the weights are exchanged": edited(
            _mean_line, ("weight_v / (weight_u", "weight_u / (weight_u")
        ),
        "the direction is a mean too": edited(_mean_line, ("at_u + share * turn", "at_u")),
        "the middle of each segment counts, not where it begins": edited(
            _mean_line, ("u.mean(axis=0)", "u[0]"), ("v.mean(axis=0)", "v[0]")
        ),
    },
    same_poses,
)


# -------------------------------------------------------------- one per wall
def _looks_apart(rng: Rng) -> Cases:
    """Pairs that differ by noise, and some that are looks at two walls."""
    noise = rng.uniform(0.01, 0.03)
    one = rng.normal(0, noise, 60)
    return {
        "pairs of looks": (one,),
        "pairs of looks, some at two walls": (np.append(one, rng.uniform(0.15, 0.25, 6)),),
    }


def _look_noise(apart: Array) -> float:
    """Deviation of one look: of what two are apart, outliers cut at 2.5 deviations."""
    off = np.abs(apart)
    found = 1.4826 * np.median(off)
    for _ in range(10):
        kept = off[off <= 2.5 * found]
        found = np.sqrt((kept**2).mean() / 0.9113)
    return float(found / np.sqrt(2))


check_look_noise = Exercise(
    "look_noise(apart) -> metres: the standard deviation of one look, from what the looks of each "
    "pair are apart, (n,): begin with 1.4826 times the median of their sizes; ten times, take the "
    "root mean square of those within 2.5 of it, with the mean square divided by 0.9113 for what "
    "was cut; two looks err, so divide by the root of 2",
    _look_noise,
    _looks_apart,
    {
        "both looks of a pair err: divide by the root of 2": edited(
            _look_noise, ("found / np.sqrt(2)", "found")
        ),
        "looks at two walls are no noise: cut what is far off": edited(
            _look_noise, ("off[off <= 2.5 * found]", "off")
        ),
        "what was cut is missing in the mean square: divide it by 0.9113": edited(
            _look_noise, (" / 0.9113", "")
        ),
        "looks that are right are 0 apart in the mean: the root mean square about 0": edited(
            _look_noise, ("kept = off[", "kept = apart["), ("(kept**2).mean()", "kept.var()")
        ),
        "0.9113 divides the mean square, inside the root": edited(
            _look_noise, ("mean() / 0.9113)", "mean()) / 0.9113")
        ),
        "cut ten times, each time at the new deviation": edited(
            _look_noise, ("range(10)", "range(1)")
        ),
        "to either side: take the sizes before the median": edited(
            _look_noise, ("np.median(off)", "abs(np.median(apart))")
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
def _graphs(rng: Rng) -> Cases:
    """A loop of four places, and one with a pair that was measured twice."""
    loop = np.array([(0, 1), (1, 2), (2, 3), (3, 0)])
    twice = np.concatenate([loop, [(1, 0), (2, 0)]])
    return {
        "a loop": (4, loop, rng.uniform(0.5, 3, 4)),
        "a pair that was measured twice": (4, twice, rng.uniform(0.5, 3, 6)),
    }


def _laplacian(count: int, edges: Array, weights: Array) -> Array:
    """B of 2.4 and 2.5."""
    b = np.zeros((count, count))
    for (i, j), w in zip(edges, weights, strict=True):
        b[i, i] += w
        b[j, j] += w
        b[i, j] -= w
        b[j, i] -= w
    return b


check_laplacian = Exercise(
    "laplacian(count, edges, weights) -> (count, count): the matrix B of the normal equations of "
    "edges (k, 2), from place to place, with their weights (k,): on the diagonal the sum of the "
    "weights at a place, beside it minus the sum of those between two",
    _laplacian,
    _graphs,
    {
        "between two places the weight stands with a minus": edited(
            _laplacian, ("b[i, j] -= w", "b[i, j] += w"), ("b[j, i] -= w", "b[j, i] += w")
        ),
        "B is symmetric: both places see the edge": edited(
            _laplacian, ("        b[j, i] -= w\n", "")
        ),
        "the diagonal counts the edges that end at a place, too": edited(
            _laplacian, ("        b[j, j] += w\n", "")
        ),
        "a pair that was measured twice counts twice: add, do not replace": edited(
            _laplacian, ("b[i, j] -= w", "b[i, j] = -w"), ("b[j, i] -= w", "b[j, i] = -w")
        ),
        "the weights count, not the number of edges": edited(
            _laplacian, ("zip(edges, weights", "zip(edges, np.ones(len(edges))")
        ),
    },
    close,
)


# ------------------------------------------------------------------ rooms and doorways
def _doorways(rng: Rng) -> Cases:
    """Rooms wide and narrow in a chain that is closed, and a doorway across it."""
    cases: dict[str, tuple[Any, ...]] = {}
    for count in (4, 5, 6, 7):
        widths = rng.permutation([3.0, *rng.uniform(0.6, 2.0, count - 1)]).round(1)
        pairs = [(k, (k + 1) % count) for k in range(count)] + [(0, count // 2)]
        doors = np.column_stack([pairs, rng.permutation(np.linspace(0.6, 1.6, len(pairs)))])
        cases[f"{count} rooms"] = widths, doors.round(2), 1.25
    return cases


def _rooms_left(widths: Array, doors: Array, kappa: float) -> NDArray[np.int64]:
    """The rule of circles: `plan.floor_plan` measures the circle of the two rooms anew instead."""
    room, wide = np.arange(len(widths)), np.array(widths, float)
    for _ in widths:
        i, j = np.sort(room[np.asarray(doors[:, :2], int)], axis=1).T
        ratio = np.where(i == j, np.inf, np.minimum(wide[i], wide[j]) / doors[:, 2])
        k = ratio.argmin()
        if ratio[k] >= kappa:
            break
        wide[i[k]] = np.maximum(wide[i[k]], wide[j[k]])
        room[room == j[k]] = i[k]
    return room


check_rooms_left = Exercise(
    "rooms_left(widths, doors, kappa) -> (n,) whole numbers: the lowest number of the rooms with "
    "which each room ends as one. The rooms hold circles of widths (n,), metres; a row of doors "
    "(m, 3) is the numbers of two rooms and the width of the doorway between. While some smaller "
    "circle is below kappa times the width, the doorway with the least ratio of both is taken out: "
    "its two rooms are one, with the wider circle, and all is tested anew",
    _rooms_left,
    _doorways,
    {
        "both sides must be wider: the smaller circle decides, not the larger": (
            edited(_rooms_left, ("np.minimum(wide[i], wide[j])", "np.maximum(wide[i], wide[j])"))
        ),
        "the least ratio goes first: which room a niche belongs to depends on it": (
            edited(_rooms_left, ("ratio.argmin()", "(ratio < kappa).argmax()"))
        ),
        "the new room holds the wider circle of both": (
            edited(_rooms_left, ("np.maximum(wide[i[k]]", "np.minimum(wide[i[k]]"))
        ),
        "circles do not add up: the wider of both": (
            edited(_rooms_left, ("np.maximum(wide[i[k]], wide[j[k]])", "wide[i[k]] + wide[j[k]]"))
        ),
        "rooms that have become one take the lowest number of theirs": (
            edited(
                _rooms_left,
                ("room[room == j[k]] = i[k]", "room[room == i[k]] = j[k]"),
                ("wide[i[k]] =", "wide[j[k]] ="),
            )
        ),
        "a circle as wide as the doorway is not enough: kappa times": (
            edited(_rooms_left, (">= kappa", ">= 1"))
        ),
        "test anew after each doorway: rooms that were too narrow may be wide enough now": (
            edited(_rooms_left, ("wide[i[k]] =", "_ ="))
        ),
        "all rooms that have become one get its number, not the last one alone": (
            edited(_rooms_left, ("room[room == j[k]]", "room[j[k]]"))
        ),
        "the ratio is the circle over the doorway, not the doorway over the circle": (
            edited(
                _rooms_left,
                ("np.minimum(wide[i], wide[j]) / doors[:, 2]", "doors[:, 2] / wide[i]"),
            )
        ),
    },
)
