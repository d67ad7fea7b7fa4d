"""The loops of extraction: cut at gaps, split, merge, fit. Plain Python, compiled when called.

`p` are points `(n, 2)` in metres, a run of them is `p[start:stop]`; a line is (x, y, dx, dy): a
point of it and its unit direction. `ease`, (n,), is the tolerance over a point's own: 1, or less
where the sensor is noisier; a point counts by its square, as one counts by its variance (A 2.19).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import compiled
from ..kernels import Line
from ..segments import MIN_LENGTH
from ._lines import farthest, fit_algebraic, fit_total, off, write_chord

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
#: What the tolerance of a point is more near the sensor, and with each metre; and the usual one.
Noise = tuple[float, float, float]

#: Distances that are so near to each other are equal, metres, and errors from sums computed anew:
#: rounding of sums is a thousand times smaller.
SUM_ROUNDING_M = 1e-9
#: Beams of a noisy sensor that meet a wall at a smaller angle say little about it, radians.
GRAZING_RAD = float(np.radians(10))

#: The points of a piece spread along it at least as five do evenly: their summed squares from its
#: middle, in squares of its least length.
LEAST_SPREAD = 0.4


class Beams(NamedTuple):
    """Points `(n, 2)` of scans, metres, those of scan i from `first[i]` to `first[i + 1]`.

    And of each scan whether it looks all round, and the place of its sensor, `(s, 2)`.
    """

    points: Array
    first: Indices
    closed: Flags
    places: Array


class Runs(NamedTuple):
    """Segments `(k, 2, 2)`; first point and stop of each, `(2, k)`; how many each scan has."""

    segments: Array
    ends: Indices
    counts: Indices


@compiled
def _is_cut(p: Array, gaps: Array, i: int, k: int) -> bool:
    """Whether a point and the next belong to different clusters: at least a gap apart (A 3.2)."""
    dx, dy = p[k, 0] - p[i, 0], p[k, 1] - p[i, 1]
    return dx * dx + dy * dy >= gaps[i] * gaps[i]


@compiled
def _set_tolerances(
    p: Array, place: Array, noise: Noise, gap: float, ease: Array, gaps: Array
) -> None:
    """Ease of each point, and the gap behind it, metres; `place`, (2,), is that of the sensor.

    Where the sensor is noisy, neighbours of a wall that the beams meet at 10 degrees or more are
    not farther apart than in that wall, and by their tolerance (Borges and Aldon 2004).
    """
    (spread, spread_share, tolerance), n, x, y = noise, len(p), place[0], place[1]
    for i in range(n):
        ease[i], gaps[i] = 1.0, gap
    if max(spread, spread_share) <= 0.0:
        return
    for i in range(n):
        more = spread + spread_share * np.hypot(p[i, 0] - x, p[i, 1] - y)
        ease[i] = tolerance / (tolerance + max(more, 0.0))
    for i in range(n):
        k = (i + 1) % n
        least = min(ease[i], ease[k])
        if least < 1.0:
            ax, ay, bx, by = p[i, 0] - x, p[i, 1] - y, p[k, 0] - x, p[k, 1] - y
            turn = abs(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))
            if turn < GRAZING_RAD:
                far = min(np.hypot(ax, ay), np.hypot(bx, by))
                most = far * np.sin(turn) / np.sin(GRAZING_RAD - turn) + tolerance / least
                gaps[i] = min(gap, most)


@compiled
def _start_of_round(p: Array, gaps: Array) -> int:
    """Where a scan all round begins: behind its first gap, else at the point farthest out."""
    n, x, y, far, most = len(p), 0.0, 0.0, 0, -1.0
    for i in range(n):
        if _is_cut(p, gaps, (i - 1) % n, i):
            return i
        x += p[i, 0]
        y += p[i, 1]
    x, y = x / n, y / n
    for i in range(n):
        d = (p[i, 0] - x) * (p[i, 0] - x) + (p[i, 1] - y) * (p[i, 1] - y)
        if d > most:
            far, most = i, d
    return far


@compiled
def _end_of_cluster(p: Array, gaps: Array, start: int) -> int:
    """First point behind the cluster that begins at a point."""
    stop = start + 1
    while stop < len(p) and not _is_cut(p, gaps, stop - 1, stop):
        stop += 1
    return stop


@compiled
def _begin_round(p: Array, gaps: Array) -> None:
    """Turn the points of a scan all round to where a round best begins."""
    start = _start_of_round(p, gaps) if len(p) > 2 else 0
    before = p.copy()
    for k in range(len(p)):
        point = before[(start + k) % len(p)]
        p[k, 0], p[k, 1] = point[0], point[1]  # a slice would cost 4 s of compiling


@compiled
def _chord_of(p: Array, ease: Array, start: int, last: int) -> Line:
    """Line from a point to the last of a run, metres; across the run where these coincide."""
    dx, dy = p[last, 0] - p[start, 0], p[last, 1] - p[start, 1]
    norm = np.hypot(dx, dy)
    if norm >= MIN_LENGTH:
        return p[start, 0], p[start, 1], dx / norm, dy / norm
    _, _, dx, dy = fit_total(p, ease, start, last + 1)
    return p[start, 0], p[start, 1], -dy, dx


@compiled
def _split_cluster(
    p: Array,
    ease: Array,
    start: int,
    stop: int,
    tolerance: float,
    ends: Indices,
    todo: Indices,
) -> int:
    """Cut a cluster at the farthest point until each chord is within tolerance, metres.

    Fills `ends` with the last index of each piece, in order; returns their number. A piece begins
    with the last point of the one before. `todo` is room to work.
    """
    todo[0], top, count = stop - 1, 1, 0
    while top:
        last = todo[top - 1]
        far, most = farthest(p, ease, start, last + 1, _chord_of(p, ease, start, last))
        if most > tolerance and start < far < last:
            todo[top] = far
            top += 1
        else:
            ends[count] = start = last
            count, top = count + 1, top - 1
    return count


@compiled
def _joint_error(
    p: Array, ease: Array, start: int, ends: Indices, k: int, tolerance: float
) -> float:
    """Largest distance from one line through the pieces k and k + 1 of a cluster, metres.

    Infinite where it is above the tolerance. Three points are within it of one line only where the
    least height of their triangle is at most twice as much.
    """
    begin, corner, end = ends[k - 1] if k else start, ends[k], ends[k + 1]
    ax, ay = p[corner, 0] - p[begin, 0], p[corner, 1] - p[begin, 1]
    bx, by = p[end, 0] - p[corner, 0], p[end, 1] - p[corner, 1]
    cx, cy = ax + bx, ay + by
    twice_area = ax * by - ay * bx
    longest = max(ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy)
    own = tolerance / min(ease[begin], ease[corner], ease[end])
    if twice_area * twice_area > 4.0001 * own * own * longest:
        return np.inf
    error = farthest(p, ease, begin, end + 1, fit_total(p, ease, begin, end + 1))[1]
    return error if error <= tolerance else np.inf


@compiled
def _merge_runs(
    p: Array, ease: Array, start: int, tolerance: float, ends: Indices, count: int, errors: Array
) -> int:
    """Join the two neighbours that one line fits best, while it fits within tolerance, metres.

    Of a cluster cut into `count` pieces: the last point of each changes in place. `errors` is room
    to work.
    """
    for k in range(count - 1):
        errors[k] = _joint_error(p, ease, start, ends, k, tolerance)
    while count > 1:
        best = 0
        for k in range(1, count - 1):
            best = k if errors[k] < errors[best] else best
        if errors[best] == np.inf:
            break
        count -= 1
        for k in range(best, count):
            ends[k], errors[k] = ends[k + 1], errors[k + 1]
        for k in range(max(best - 1, 0), min(best + 1, count - 1)):
            errors[k] = _joint_error(p, ease, start, ends, k, tolerance)
    return count


@compiled
def _is_nearer(p: Array, k: int, line: Line, other: Line) -> bool:
    """Whether a point is nearer to a line than to the other, by more than rounding."""
    return off(p, k, line) < off(p, k, other) - SUM_ROUNDING_M


@compiled
def _border(p: Array, ease: Array, first: int, corner: int, last: int) -> int:
    """First point of the second of two pieces, which share their corner.

    The corner belongs to the nearer of the lines through the other points, and so do the points
    behind it, up to the middle of their piece: a wall ends at the last beam that met it. Beside a
    piece that is too short for a line it belongs to the longer one.
    """
    if min(corner - first, last - corner) < 3:
        return corner + (last - corner < corner - first)
    before = fit_total(p, ease, first, corner)
    after = fit_total(p, ease, corner + 1, last + 1)
    if _is_nearer(p, corner, before, after):
        border = corner + 1
        while 2 * border < corner + last and _is_nearer(p, border, before, after):
            border += 1
        return border
    border = corner
    while 2 * (border - 1) > first + corner and not _is_nearer(p, border - 1, before, after):
        border -= 1
    return border


@compiled
def _spread_along(p: Array, ease: Array, start: int, stop: int, line: Line) -> float:
    """Summed squares, square metres, of the points of a piece along its line, from its middle."""
    spread = 0.0
    for i in range(start, stop):
        u = (p[i, 0] - line[0]) * line[2] + (p[i, 1] - line[1]) * line[3]
        spread += (u * ease[i]) ** 2
    return spread


@compiled
def polylines(
    scans: Beams,
    noise: Noise,
    gap: float,
    min_points: int,
    min_length: float,
    total: bool,
    runs: Runs,
) -> None:
    """Write the segments of all clusters (A 3.2) of each scan, split and merged.

    The points of one that looks all round are turned to where a round best begins. Lines are of
    `total` least squares, or A's.
    """
    p, row, tolerance, least = scans.points, 0, noise[2], LEAST_SPREAD * min_length * min_length
    most, (ease, gaps) = 0, np.empty((2, len(p)))
    for scan in range(len(runs.counts)):
        most = max(most, scans.first[scan + 1] - scans.first[scan])
    (ends, todo), errors = np.empty((2, most), np.int64), np.empty(most)
    for scan in range(len(runs.counts)):
        begin, last, before = scans.first[scan], scans.first[scan + 1], row
        own, place = p[begin:last], scans.places[scan]
        _set_tolerances(own, place, noise, gap, ease[begin:last], gaps[begin:last])
        if scans.closed[scan]:
            _begin_round(own, gaps[begin:last])
            _set_tolerances(own, place, noise, gap, ease[begin:last], gaps[begin:last])
        while begin < last:
            stop = _end_of_cluster(p[:last], gaps, begin)
            count = _split_cluster(p, ease, begin, stop, tolerance, ends, todo)
            count = _merge_runs(p, ease, begin, tolerance, ends, count, errors)
            start = corner = begin
            for k in range(count):
                end = ends[k] + 1
                if k + 1 < count:
                    end = _border(p, ease, corner, ends[k], ends[k + 1])
                    corner = ends[k]
                if end - start >= min_points:
                    runs.ends[0, row], runs.ends[1, row] = start, end
                    line = fit_total(p, ease, start, end) if total else fit_algebraic(p, start, end)
                    size = write_chord(p, start, end, line, runs.segments, row)
                    spread = _spread_along(p, ease, start, end, line)
                    row += size >= min_length and spread >= least
                start = end
            begin = stop
        runs.counts[scan] = row - before
