"""One per wall, a method of our own: scans move to where they agree, then each wall is drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import SMALLEST_THRESHOLD_M, Array, Positive, Segments, checked
from ...progress import each, parts
from ...scans.noise import robust_sigma
from ...segments import SegmentMap, length, midpoint
from .._index import empty_index
from .._runner import (
    Found,
    Indices,
    Reduction,
    Rows,
    ordered_by_first_input,
    resolve_merges,
    run_offline,
)
from ._pair_kernels import PAIR_OFFSET_M, Looks, find_pairs, offsets, pull
from ._wall_kernels import ABSORBED_TOLERANCES, Walls, absorb_weaker, enter_looks, grow

#: Standard deviation of the ends of a look about its wall, metres, where poses are true: polylines
#: are extracted to 0.03 m. From 0.010 to 0.017, 55 to 58 of the benchmark's 60 maps are good.
LOOK_SIGMA_M = 0.0115
#: Fewer pairs tell nothing about the noise.
LEAST_NOISE_PAIRS = 8
#: Rounds in which scans move, each with the noise that the last one left.
NOISE_ROUNDS = 10
#: Steps in each round.
ALIGNING_STEPS = 6
#: Of what its pairs ask for a scan moves this share in a step: two scans must not change places.
STEP_SHARE = 0.8


@checked
def one_per_wall(map: Segments, *, factor: Positive = 1.0) -> Reduction:
    """Estimate the noise of the poses, take it out, and draw one segment for each wall; ours.

    Two looks at one stretch of a wall, from two scans, differ by the noise of both poses. So pairs
    of looks tell its size; of many looks at one wall each is paired with a few dozen. Then each
    scan moves, as a whole, to where its looks agree best with those of the others. What is left is
    a tenth of the noise, and walls that lie as near as 0.10 m come apart. The longest look gathers
    those that lie on its line; gaps up to 0.3 m are bridged, and up to 1 m where something that
    stood before it hid the wall and no beam passed. Its line is fitted anew until nothing changes.
    At last a weak wall that lies beside a stronger one goes into it.

    The result lies where most scans say that the building is, not where each drew it: by quality,
    which asks how near the result is to the map with its noise, `least_cost` is better.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Best with scans and the places of the sensor: `build_map(log, poses, keep_points=True)`.
    factor
        The tolerance about a wall is so many times three standard deviations of a look.

    Returns
    -------
    Reduction
        In the order of the first segment of each wall. `noise` is the deviation of looks before
        scans moved; NaN for less than eight pairs. `doubt` says what the map did not tell.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1, 0.01), (3, 0.01)], [(0, 1), (2, 1)]]
    >>> reduction = one_per_wall(wall)
    >>> reduction.parents
    array([0, 0, 1])
    """
    noise = float(np.nan)
    scan = map.scan if isinstance(map, SegmentMap) else np.zeros(0, np.int64)
    places = map.sensors if isinstance(map, SegmentMap) else None
    several = len(np.unique(scan)) > 1

    def reduce(rows: Rows) -> Found:
        nonlocal noise
        s, n = rows.segments, len(rows.source_row)
        of = scan[rows.source_row] if several else np.arange(n)
        sensors = np.full((n, 2), np.nan) if places is None else places[scan[rows.source_row]]
        unit, sigma = float(max(length(s).mean() if n else 0.0, 2 * PAIR_OFFSET_M)), 0.0
        looks = Looks(s, of, sensors, empty_index(n, unit), np.empty(n + 1, np.int64))
        words = "one per wall: pairing segment"
        some = [find_pairs(looks, part) for part in parts(np.arange(n), words)]
        pairs = np.concatenate([np.empty((0, 2), np.int64), *some])
        if len(pairs) >= LEAST_NOISE_PAIRS:
            noise = sigma = robust_sigma(offsets(s, pairs)) / np.sqrt(2)
            if several and noise > 0:
                s, sensors, sigma = _align_scans(s, sensors, of, pairs, noise)
        tolerance = 3 * factor * float(np.hypot(sigma, LOOK_SIGMA_M))
        if tolerance < SMALLEST_THRESHOLD_M:  # no wall is drawn so finely
            raise ValueError(
                f"factor must make {SMALLEST_THRESHOLD_M:.0e} m of the noise at least, got {factor}"
            )
        return _draw_walls(rows, s, sensors, tolerance)

    reduction = run_offline("one_per_wall", map, reduce)
    lost = [] if several else ["which scan saw what, so that none was moved"]
    lost += [] if places is not None else ["where its sensor was, so that no hidden gap is bridged"]
    doubt = f"the map does not tell {', or '.join(lost)}" if lost else ""
    return replace(reduction, noise=noise, doubt=doubt)


def _align_scans(
    s: Array, sensors: Array, scan: Indices, pairs: Indices, noise: float
) -> tuple[Array, Array, float]:
    """Segments and sensors where the scans agree best, and the noise that is left.

    Each step moves all scans by a share of what their pairs and their first places ask for.
    """
    scans, of = np.unique(scan, return_inverse=True)
    count = np.bincount(of)
    centre = np.stack([np.bincount(of, xy) / count for xy in midpoint(s).T], axis=-1)
    lever = ((midpoint(s) - centre[of]) ** 2).sum(axis=1)
    first = np.ones((len(scans), 3)) / noise**2  # a turn moves the looks by this noise too
    first[:, 2] *= np.bincount(of, lever) / count
    moved, sigma = np.zeros((len(scans), 3)), noise
    for _ in each(range(NOISE_ROUNDS), "one per wall: moving scans, round"):
        for _ in range(ALIGNING_STEPS):
            normal, right = first[:, :, None] * np.eye(3), -first * moved
            pull(s, pairs, of, centre, max(sigma, noise / 10), normal, right)
            normal[:, 2, 2] += first[:, 0] * 1e-9  # a scan of one look turns about its middle
            step = np.linalg.solve(normal, right[..., None])[..., 0] * STEP_SHARE
            moved += step
            c, d = np.cos(step[of, 2]), np.sin(step[of, 2])
            turn = np.stack([c, -d, d, c], axis=-1).reshape(-1, 2, 2)
            to = centre[of] + step[of, :2]
            s = np.einsum("nij,nkj->nki", turn, s - centre[of, None]) + to[:, None]
            sensors = np.einsum("nij,nj->ni", turn, sensors - centre[of]) + to
            centre = centre + step[:, :2]
        sigma = robust_sigma(offsets(s, pairs)) / np.sqrt(2)
    return s, sensors, sigma


def _draw_walls(rows: Rows, s: Array, sensors: Array, tolerance: float) -> Found:
    """One segment for each wall, and the wall of each look."""
    n, sizes = len(s), length(s)
    unit = float(max(sizes.mean() if n else 0.0, 1.0))
    places, fans = empty_index(n, unit), empty_index(n, unit)
    drawn, spans, grown = np.empty((n, 2, 2)), np.empty((n, 2)), np.empty((2, 2))
    (label, mark), (near, seen, who, order) = np.full((2, n), -1), np.empty((4, n + 1), np.int64)
    walls = Walls(
        s, sensors, places, fans, drawn, label, mark, near, seen, who, order, spans, grown
    )
    longest = np.argsort(-length(rows.segments).round(9), kind="stable")
    count = 0
    enter_looks(walls)
    for part in parts(longest, "one per wall: growing a wall from segment"):
        count = grow(walls, part, count, tolerance)
    drawn = walls.drawn[:count]
    metres = np.bincount(walls.label, length(rows.segments), count).astype(float)
    weakest = np.argsort(metres.round(9), kind="stable")
    places, into = empty_index(count, unit), np.arange(count)
    absorb_weaker(drawn, metres, weakest, places, ABSORBED_TOLERANCES * tolerance, into)
    stays, ends = resolve_merges(into)
    drawn = drawn[stays]
    order, parents = ordered_by_first_input(ends[walls.label], rows.source_row, len(drawn))
    return drawn[order], parents
