"""Exercises on quality, on comparing methods, on the viewing sector, and on two maps."""

from __future__ import annotations

import numpy as np

from segmap import metrics
from segmap.arrays import Array
from segmap.experiments import equal_quality, front, pareto, reduction_at
from segmap.metrics import reduction_rate
from segmap.segments import point_distance

from .. import literal
from .._storage import wall_errors
from ._exercise import Exercise
from .draws import maps as draws_maps

# -------------------------------------------------------------- reduction and quality
check_reduction_rate = Exercise(
    "reduction_rate(before, after) -> float: share of the segments (n, 2, 2) that are gone",
    reduction_rate,
    {
        f"{n} segments before and {m} after": (np.zeros((n, 2, 2)), np.zeros((m, 2, 2)))
        for n, m in ((4, 1), (10, 7), (3, 3), (0, 0))
    },
    {
        "this is the share that is left, wanted is what is gone": (
            lambda before, after: len(after) / len(before) if len(before) else 0.0
        ),
        "a share lies between 0 and 1: no per cent": (
            lambda before, after: 100 * reduction_rate(before, after)
        ),
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
    draw=draws_maps.reduction_rate,
    own=(reduction_rate,),
)


def _quality(mean_error: float, scale: float = 0.050) -> float:
    return float(np.exp(-mean_error / scale))


_MATRIX = np.array([(0.010, 0.200, 0.350), (0.500, 0.030, 0.400)])

check_quality = Exercise(
    "quality(distances) -> float: exp(-mean error / 0.050 m), from distances (n, m) in metres "
    "between n segments before and m after",
    lambda distances: _quality(distances.min(axis=1).mean()),
    {
        "2 segments before, 3 after": (_MATRIX,),
        "3 segments before, 2 after": (_MATRIX.T,),
        "a perfect map": (np.array([(0.0, 1.0), (1.0, 0.0)]),),
        "one segment for three": (np.array([(0.01,), (0.02,), (0.06,)]),),
    },
    {
        "every segment of the map *before* looks for its nearest: the minimum runs along a row": (
            lambda distances: _quality(distances.min(axis=0).mean())
        ),
        "only the nearest segment after counts, not the mean distance from all": (
            lambda distances: _quality(distances.mean())
        ),
        "the mean of the errors counts, not the largest": (
            lambda distances: _quality(distances.min(axis=1).max())
        ),
        "the mean of the errors counts, not their sum: else large maps are always bad": (
            lambda distances: _quality(distances.min(axis=1).sum())
        ),
        "quality lies between 0 and 1: no per cent": (
            lambda distances: 100 * _quality(distances.min(axis=1).mean())
        ),
        "distances are metres: the scale is 0.050 m, not 50": (
            lambda distances: _quality(distances.min(axis=1).mean(), 50.0)
        ),
        "take the mean of the errors first, then exp: the mean of the exponentials is larger": (
            lambda distances: np.exp(-distances.min(axis=1) / 0.050).mean()
        ),
        "the mean of the errors counts, not their median": (
            lambda distances: _quality(np.median(distances.min(axis=1)))
        ),
        "divide the mean error by 0.050 m before you take exp": (
            lambda distances: _quality(distances.min(axis=1).mean(), 1.0)
        ),
        "a worse map has a lower quality: exp of minus the error": (
            lambda distances: 1 / _quality(distances.min(axis=1).mean())
        ),
        "the mean of the errors counts, not the root of the mean of their squares": (
            lambda distances: _quality(np.sqrt((distances.min(axis=1) ** 2).mean()))
        ),
    },
    draw=draws_maps.quality,
    own=(metrics.quality, literal.quality),
)


# -------------------------------------------------------------- the curve of a method
def _through_all(points: Array, quality: float) -> float:
    """On lines through every run, in the order of quality."""
    q, r = points[np.argsort(points[:, 0], kind="stable")].T
    return float(np.interp(quality, q, r, right=np.nan))


def _step(points: Array, quality: float) -> float:
    reached = points[points[:, 0] >= quality, 1]
    return float(reached.max()) if len(reached) else np.nan


def _none_below(points: Array, quality: float) -> float:
    q, r = front(points).T
    return float(np.interp(quality, q, r, left=np.nan, right=np.nan))


#: Quality and reduction of seven runs, two of them beaten, in no order.
_RUNS = np.array(
    [(0.94, 0.30), (0.70, 0.66), (0.88, 0.42), (0.86, 0.35), (0.80, 0.60), (0.55, 0.72), (0.6, 0.5)]
)

check_reduction_at = Exercise(
    "reduction_at(points, quality) -> float: the reduction that a method reaches at a quality, on "
    "straight lines between those of its runs (n, 2), quality and reduction, that no other beats",
    reduction_at,
    {
        "seven runs at quality 0.84": (_RUNS, 0.84),
        "seven runs at the quality of a run, 0.70": (_RUNS, 0.70),
        "seven runs at quality 0.62, next to a bad run": (_RUNS, 0.62),
        "seven runs at quality 0.95, better than all": (_RUNS, 0.95),
        "seven runs at quality 0.50, worse than all": (_RUNS, 0.50),
    },
    {
        "a run that another one beats in both quality and reduction is not on the curve": (
            _through_all
        ),
        "take the place between two runs, not the nearest run": (
            lambda points, quality: float(points[np.argmin(np.abs(points[:, 0] - quality)), 1])
        ),
        "between two runs the curve is a straight line, not a step": _step,
        "above the best quality of all runs nothing has been reached: nan": (
            lambda points, quality: float(np.interp(quality, *front(points).T))
        ),
        "a map that is better than asked for will do: below all runs, the largest reduction": (
            _none_below
        ),
        "quality is the first column of points, reduction the second": (
            lambda points, quality: reduction_at(points[:, ::-1], quality)
        ),
        "leave out the runs that another one beats, then interpolate; and above the best quality "
        "nothing has been reached: nan": (
            lambda points, quality: float(
                np.interp(quality, *points[np.argsort(points[:, 0], kind="stable")].T)
            )
        ),
        "np.interp wants qualities that rise: sort the runs first": (
            lambda points, quality: float(np.interp(quality, *points.T))
        ),
    },
    draw=draws_maps.reduction_at,
    own=(reduction_at, front, equal_quality, pareto),
)


# -------------------------------------------------------------- the best of some runs
def _best_run(points: Array, quality: float, border: float = 1e-12) -> int:
    good = np.flatnonzero(points[:, 0] >= quality - border)
    return int(good[points[good, 1].argmax()]) if len(good) else -1


check_best_run = Exercise(
    "best_run(points, quality) -> int: the row of the run, of points (n, 2) quality and reduction, "
    "that removes most among those of at least that quality; -1 where there is none",
    _best_run,
    {f"seven runs, quality {least}": (_RUNS, least) for least in (0.84, 0.50, 0.70, 0.95)},
    {
        "the run with the largest reduction of all need not have the quality": (
            lambda points, quality: int(points[:, 1].argmax())
        ),
        "among runs that are good enough the one that removes most counts, not the best one": (
            lambda points, quality: int(
                points[:, 0].argmax() if points[:, 0].max() >= quality else -1
            )
        ),
        "the answer is a row of points: that of the good ones alone counts others": (
            lambda points, quality: int(
                points[points[:, 0] >= quality, 1].argmax() if points[:, 0].max() >= quality else -1
            )
        ),
        "at least that quality: a run that just has it counts": (
            lambda points, quality: _best_run(points, quality, border=-1e-12)
        ),
        "where no run is good enough the answer is -1": (
            lambda points, quality: max(0, _best_run(points, quality))
        ),
        "the row of the run is asked for, not its reduction": (
            lambda points, quality: (
                points[_best_run(points, quality), 1] if points[:, 0].max() >= quality else -1
            )
        ),
        "not the run whose quality is nearest: of all that are good enough the one that removes "
        "most": lambda points, quality: int(np.abs(points[:, 0] - quality).argmin()),
        "where no run is good enough argmax has nothing to choose from: answer -1 before": (
            lambda points, quality: (
                _best_run(points, quality) if points[:, 0].max() >= quality else np.argmax([])
            )
        ),
    },
    draw=draws_maps.best_run,
)


# -------------------------------------------------------------------- errors of walls
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
    "mean_wall_error(points, walls) -> float: mean distance of points (n, 2) from the nearest of "
    "the walls (m, 2, 2)",
    lambda points, walls: float(_to_walls(points, walls).min(1).mean()),
    {
        f"{n} points, {m} walls": (_POINTS[:n], _WALLS[:m])
        for n, m in ((6, 3), (1, 3), (3, 1), (6, 2), (2, 2))
    },
    {
        "a wall ends: beyond its ends the distance is that from the end point": (
            lambda points, walls: _to_lines(points, walls).min(1).mean()
        ),
        "beside a wall the distance is that from the foot on it, not from its ends": (
            lambda points, walls: _to_ends(points, walls).min(1).mean()
        ),
        "only the nearest wall counts for each point": (
            lambda points, walls: _to_walls(points, walls).mean()
        ),
        "every point looks for its wall: the minimum runs over the walls": (
            lambda points, walls: _to_walls(points, walls).min(0).mean()
        ),
        "the mean of the errors counts, not the largest": (
            lambda points, walls: _to_walls(points, walls).min(1).max()
        ),
        "the mean of the errors counts, not their sum": (
            lambda points, walls: _to_walls(points, walls).min(1).sum()
        ),
        "the mean of the distances, not of their squares": (
            lambda points, walls: (_to_walls(points, walls).min(1) ** 2).mean()
        ),
        "the mean of the distances, not the root of the mean of their squares": (
            lambda points, walls: np.sqrt((_to_walls(points, walls).min(1) ** 2).mean())
        ),
    },
    draw=draws_maps.mean_wall_error,
    own=(wall_errors,),
)
