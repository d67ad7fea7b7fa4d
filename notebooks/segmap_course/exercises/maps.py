"""Exercises on the worth of maps: reduction, quality, the curve of a method, errors of walls."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from segmap.arrays import Array
from segmap.metrics import reduction_rate, segment_distance
from segmap.segments import length, point_distance

from ..literal import comparing
from ..literal.metrics import covered
from ._answers import Cases, near
from ._exercise import Exercise, Rng, edited


# -------------------------------------------------------------- reduction and quality
def _counts(rng: Rng) -> Cases:
    n = int(rng.integers(5, 30))
    m = int(rng.integers(1, n - 1))
    return {
        f"{a} segments before and {b} after": (np.zeros((a, 2, 2)), np.zeros((b, 2, 2)))
        for a, b in ((n, m), (n, n), (n + 3, 0), (0, 0))
    }


check_reduction_rate = Exercise(
    "reduction_rate(before, after) -> float: share of the segments (n, 2, 2) that are gone",
    reduction_rate,
    _counts,
    {
        "this is the share that is left, wanted is what is gone": (
            lambda before, after: len(after) / len(before) if len(before) else 0.0
        ),
        "a share lies between 0 and 1: no per cent": lambda *maps: 100 * reduction_rate(*maps),
        "a map without segments has lost nothing: its rate is 0, and no division by zero": (
            lambda before, after: (len(before) - len(after)) / len(before)
        ),
        "the share is one of the map before: divide by its number": (
            lambda before, after: (len(before) - len(after)) / max(len(after), 1)
        ),
        "the share of the segments is asked for, not their number": (
            lambda before, after: len(before) - len(after)
        ),
        "// cuts the share to a whole number: divide by /": (
            lambda before, after: (len(before) - len(after)) // max(len(before), 1)
        ),
        "a map without segments has lost nothing: its rate is 0, not 1": (
            lambda before, after: 1 - len(after) / max(len(before), 1)
        ),
    },
)


def _walls(rng: Rng) -> Cases:
    """Maps before and after: parallel walls some centimetres apart, of very different lengths."""

    def rows(count: int, first: float = 0.0) -> Array:
        y = first + 0.12 * np.arange(count) + rng.uniform(0, 0.04, count)
        lengths = np.append(rng.uniform(0.3, 0.8, count - 1), rng.uniform(4, 6))
        return np.stack([np.stack([0 * y, y], 1), np.stack([lengths, y], 1)], axis=1)

    walls, more = rows(4), rows(3, 0.6)
    moved = walls + rng.uniform(0.02, 0.08, (4, 1, 2))
    return {
        "the longest of four walls is lost": (walls, moved[:3]),
        "the shortest walls are lost": (walls, moved[2:]),
        "walls are invented": (walls, np.concatenate([moved, more])),
        "nothing has changed": (walls, walls),
    }


def _quality(before: Array, after: Array, *, by_metres: bool = True) -> tuple[float, float]:
    """Quality of `after` for `before`, and the other way round."""

    def one_way(walls: Array, others: Array) -> float:
        errors = segment_distance(walls[:, None], others[None]).min(axis=1)
        weights = length(walls) if by_metres else None
        return float(np.exp(-np.average(errors, weights=weights) / 0.050))

    return one_way(before, after), one_way(after, before)


def _summed(before: Array, after: Array) -> float:
    errors = segment_distance(before[:, None], after[None])
    back = (length(after) * errors.min(axis=0)).sum()
    return float(np.exp(-max((length(before) * errors.min(axis=1)).sum(), back) / 0.050))


check_quality = Exercise(
    "quality(before, after) -> float: the smaller of the qualities of `after` for `before` and of "
    "`before` for `after`, maps (n, 2, 2) and (m, 2, 2) in metres; in each mean error a wall "
    "counts by its length, and the scale is 0.050 m",
    lambda before, after: min(_quality(before, after)),
    _walls,
    {
        "this is the quality of the chapter: let a wall count by its length, and ask both maps": (
            lambda before, after: _quality(before, after, by_metres=False)[0]
        ),
        "a wall that is invented still costs nothing: let the walls after look for theirs before, "
        "too": lambda before, after: _quality(before, after)[0],
        "a wall that is lost costs nothing now: let the walls before look for theirs after, too": (
            lambda before, after: _quality(before, after)[1]
        ),
        "both maps are asked; now let each wall count by its length": (
            lambda before, after: min(_quality(before, after, by_metres=False))
        ),
        "the smaller of both qualities counts, not the larger": (
            lambda before, after: max(_quality(before, after))
        ),
        "the smaller of both qualities counts, not their mean": (
            lambda before, after: sum(_quality(before, after)) / 2
        ),
        "the smaller of both qualities counts, not their product": (
            lambda before, after: float(np.prod(_quality(before, after)))
        ),
        "divide by the sum of the lengths: else large maps are always bad": _summed,
        "quality lies between 0 and 1: no per cent": (
            lambda before, after: 100 * min(_quality(before, after))
        ),
    },
)


# -------------------------------------------------------------- the curve of a method
def _runs(rng: Rng) -> Cases:
    """Quality and reduction of eight runs, in no order, every other one beaten; and a quality."""
    q = np.cumsum(rng.uniform(0.04, 0.09, 4)) + 0.5
    r = 0.8 - np.cumsum(rng.uniform(0.06, 0.12, 4))
    beaten = np.stack([q - rng.uniform(0.01, 0.03, 4), r - rng.uniform(0.02, 0.05, 4)], 1)
    points = rng.permutation(np.concatenate([np.stack([q, r], 1), beaten]))
    q = np.sort(points[:, 0])
    middle = float((q[3] + q[4]) / 2)
    taken = int(np.where(points[:, 0] >= middle, points[:, 1], 0).argmax())
    return {
        "eight runs, the first of them counts": (np.roll(points, -taken, axis=0), middle),
        "eight runs, the last of them counts": (np.roll(points, -taken - 1, axis=0), middle),
    } | {
        f"eight runs, {words}": (points, float(least))
        for words, least in (
            ("a quality between two of them", (q[3] + q[4]) / 2 + rng.uniform(0, 0.005)),
            ("the quality of one of them", points[int(rng.integers(8)), 0]),
            ("the best quality of all", q[-1]),
            ("a quality between the two best on the curve", (q[6] + q[7]) / 2),
            ("a quality next to a bad one", q[4] + 0.001),
            ("a quality better than all", q[-1] + rng.uniform(0.01, 0.1)),
            ("a quality worse than all", q[0] - rng.uniform(0.01, 0.1)),
        )
    }


def _runs_of_three(rng: Rng) -> Cases:
    """Runs with quality, reduction and invented metres, in no order: twins, and beaten ones."""
    q, r, m = 0.5 + np.sort(rng.random((3, 4)), axis=1) / 3
    good = np.stack([q, r[::-1], rng.permutation(20 * m)], axis=1)
    alone = good[:2] - (0.02, 0.02, rng.uniform(5, 9))
    worse = good[1:] - (*rng.uniform(0.005, 0.01, 2), -rng.uniform(0.1, 1))
    more = good[2:] + (0, 0, rng.uniform(0.5, 2))
    return {
        "as good in two, and more invented": (rng.permutation([*good, *more]),),
        "worse, and less invented": (rng.permutation([*good, *alone]),),
        "worse in all three, and twins": (rng.permutation([*good, *worse, *good[:2]]),),
        "one run": (good[:1],),
    }


def _front(runs: Array, sign: int = -1) -> list[tuple[float, ...]]:
    front = []
    for run in runs * (1, 1, sign):
        others = runs * (1, 1, sign)
        beaten = (others >= run).all(axis=1) & (others > run).any(axis=1)
        front += [] if beaten.any() else [tuple(map(float, run * (1, 1, sign)))]
    return sorted(set(front))


check_front = Exercise(
    "front(runs) -> rows of runs (n, 3), sorted, each once: those that no other one beats. A row "
    "is quality, reduction, and metres invented, of which fewer are better",
    _front,
    _runs_of_three,
    {
        "this is the front of the chapter, for runs of two numbers: let invented metres count, "
        "too": comparing.front,
        "quality and reduction alone decide here: let invented metres count, too": edited(
            _front, (">= run)", ">= run)[:, :2]"), ("> run)", "> run)[:, :2]")
        ),
        "fewer invented metres are better, not more": lambda runs: _front(runs, 1),
        "a run is beaten where another is at least as good in all three and better in one, not "
        "only where it is better in all": edited(
            _front, ("(others > run).any", "(others > run).all")
        ),
        "a run is beaten by one that is at least as good in all three, not in one of them": (
            edited(_front, ("(others >= run).all", "(others >= run).any"))
        ),
        "each run once: equal ones are one row of the answer": (
            edited(_front, ("sorted(set(front))", "sorted(front)"))
        ),
        "equal runs do not beat each other": (
            edited(
                _front,
                ("& (others > run).any(axis=1)", "& (np.arange(len(runs)) != k)"),
                ("for run in", "for k, run in enumerate("),
                ("* (1, 1, sign):", "* (1, 1, sign)):"),
            )
        ),
        "sort the rows": edited(_front, ("sorted(set(front))", "list(dict.fromkeys(front))")),
    },
)


def _best_run(points: Array, quality: float) -> int:
    good = np.flatnonzero(points[:, 0] >= quality - 1e-12)
    return int(good[points[good, 1].argmax()]) if len(good) else -1


check_best_run = Exercise(
    "best_run(points, quality) -> int: the row of the run, of points (n, 2) quality and reduction, "
    "that removes most among those of at least that quality; -1 where there is none",
    _best_run,
    _runs,
    {
        "the run with the largest reduction of all need not have the quality": (
            lambda points, quality: int(points[:, 1].argmax())
        ),
        "among runs that are good enough the one that removes most counts, not the best one": (
            edited(_best_run, ("points[good, 1]", "points[good, 0]"))
        ),
        "the answer is a row of points: that of the good ones alone counts others": (
            edited(_best_run, ("good[points[good, 1].argmax()]", "points[good, 1].argmax()"))
        ),
        "at least that quality: a run that just has it counts": edited(_best_run, ("- 1e", "+ 1e")),
        "where no run is good enough the answer is -1": (
            lambda points, quality: max(0, _best_run(points, quality))
        ),
        "the row of the run is asked for, not its reduction": (
            edited(_best_run, ("int(good[points[good, 1].argmax()])", "points[good, 1].max()"))
        ),
        "not the run whose quality is nearest: of all that are good enough the one that removes "
        "most": lambda points, quality: int(np.abs(points[:, 0] - quality).argmin()),
        "where no run is good enough argmax has nothing to choose from: answer -1 before": (
            edited(_best_run, (" if len(good) else -1", ""))
        ),
    },
)


# -------------------------------------------------------------------- errors of walls
def _walls_and_points(rng: Rng) -> Cases:
    """Points beside walls and beyond their ends; more points than walls, and fewer."""
    walls = rng.uniform(-4, 4, (4, 2, 2))
    points = np.concatenate([walls.mean(1), 1.5 * walls[:, 1] - 0.5 * walls[:, 0]])
    points += rng.uniform(-0.3, 0.3, points.shape)
    return {
        f"{n} points, {m} walls": (rng.permutation(points)[:n], walls[:m])
        for n, m in ((8, 4), (1, 4), (5, 1), (3, 3))
    }


def _mean_error(points: Array, walls: Array) -> float:
    away = point_distance(points[:, None], walls[None])
    return float(away.min(axis=1).mean())


def _to_lines(points: Array, walls: Array) -> Array:
    along = walls[:, 1] - walls[:, 0]
    away = points[:, None] - walls[:, 0]
    cross = along[:, 0] * away[..., 1] - along[:, 1] * away[..., 0]
    return np.abs(cross) / np.hypot(along[:, 0], along[:, 1])


def _to_ends(points: Array, walls: Array) -> Array:
    return np.linalg.norm(points[:, None, None] - walls[None], axis=-1).min(-1)


check_mean_wall_error = Exercise(
    "mean_wall_error(points, walls) -> float: mean distance of points (n, 2) from the nearest of "
    "the walls (m, 2, 2)",
    _mean_error,
    _walls_and_points,
    {
        "a wall ends: beyond its ends the distance is that from the end point": (
            lambda points, walls: _to_lines(points, walls).min(1).mean()
        ),
        "beside a wall the distance is that from the foot on it, not from its ends": (
            lambda points, walls: _to_ends(points, walls).min(1).mean()
        ),
        "only the nearest wall counts for each point": edited(_mean_error, (".min(axis=1)", "")),
        "every point looks for its wall: the minimum runs over the walls": (
            edited(_mean_error, ("axis=1", "axis=0"))
        ),
        "the mean of the errors counts, not the largest": edited(_mean_error, (".mean", ".max")),
        "the mean of the errors counts, not their sum": edited(_mean_error, (".mean", ".sum")),
        "the mean of the distances, not of their squares": (
            edited(_mean_error, ("away.min(axis=1)", "(away.min(axis=1) ** 2)"))
        ),
        "the mean of the distances, not the root of the mean of their squares": (
            edited(
                _mean_error, ("away.min(axis=1).mean()", "(away.min(axis=1) ** 2).mean() ** 0.5")
            )
        ),
    },
    near,
)


# ----------------------------------------------------------------- one wall, by intervals
def _looks_at_a_wall(rng: Rng) -> Cases:
    """What was seen of a wall and what a map has of it, out of order, overlapping, with gaps."""
    a = np.cumsum(rng.uniform(0.4, 0.9, 12))
    seen = np.array([(a[4], a[7]), (a[1], a[5]), (a[9], a[11])])
    return {
        "a map that runs on where nobody looked": (seen, np.array([(a[6], a[8]), (a[0], a[3])])),
        "a map with two segments on one place": (seen, np.array([(a[4], a[6]), (a[5], a[7])])),
        "a map without anything here": (seen, np.empty((0, 2))),
        "a map with all of it": (seen, np.array([(a[0], a[11])])),
    }


def _joined(spans: Array) -> float:
    return float(covered(spans.tolist()))


def _missed(seen: Array, kept: Array) -> float:
    return _joined(np.concatenate([seen, kept])) - _joined(kept)


def _hull(spans: Array) -> float:
    return float(np.ptp(spans)) if len(spans) else 0.0


def _sum(spans: Array) -> float:
    return float(np.diff(spans).sum())


def _unsorted(spans: Array) -> float:
    """`covered` in the order in which the spans are given."""
    metres, reached = 0.0, -np.inf
    for low, high in spans:
        metres += max(0.0, high - max(low, reached))
        reached = max(reached, high)
    return float(metres)


def _missed_by(measure: Callable[[Array], float]) -> Callable[[Array, Array], float]:
    """The same sums over another measure of spans."""
    return lambda seen, kept: measure(np.concatenate([seen, kept])) - measure(kept)


check_missed_metres = Exercise(
    "missed_metres(seen, kept) -> float: metres of one wall that were seen and are not in the map, "
    "from spans (n, 2) and (m, 2), low and high along the wall in metres, in any order; they may "
    "overlap, and m may be 0",
    _missed,
    _looks_at_a_wall,
    {
        "spans that overlap count once: join them before you measure": _missed_by(_sum),
        "no difference of two sums: spans overlap, and the map may have what was not seen": (
            lambda seen, kept: _sum(seen) - _sum(kept)
        ),
        "what the map has beyond what was seen does not make good for what it lacks": (
            lambda seen, kept: _joined(seen) - _joined(kept)
        ),
        "a gap between two looks was not seen: measure the spans, not from first to last": (
            _missed_by(_hull)
        ),
        "spans come in any order: sort them before you join them": _missed_by(_unsorted),
        "metres that were seen and not kept are asked for; you give those kept and not seen": (
            lambda seen, kept: _missed(kept, seen)
        ),
        "this is what is kept of the wall; wanted is what is missed": (
            lambda seen, kept: _joined(seen) - _missed(seen, kept)
        ),
        "metres, not a share of what was seen": (
            lambda seen, kept: _missed(seen, kept) / _joined(seen)
        ),
        "a map may have nothing of this wall: then all that was seen is missed": (
            lambda seen, kept: _missed(seen, kept) if len(kept) else 0.0
        ),
    },
)
