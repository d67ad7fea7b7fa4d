"""A map against the walls of its building, where these are known: what is kept, missed, invented.

Quality asks how near a reduced map is to the noisy map before. Here the judge is the building.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Metres, Radians, Segments, at_least, at_most, checked
from ..segments import MIN_LENGTH, length

#: Walls whose ends lie this far off one line, and touch, are one wall; metres.
ONE_LINE = 1e-3
#: Owners whose squared offsets differ by less are alike, metres^2: rounding must not choose.
ALIKE_OFFSETS_M2 = 1e-12


@dataclass(frozen=True, eq=False)
class AgainstWalls:
    """How a map and the walls of its building agree.

    Parameters
    ----------
    walls : (w, 2, 2) array, metres
        The walls, those that continue each other joined.
    seen, kept, doubled : (w,) arrays, metres
        Of each wall: what could be known, what of that the map has, what it has more than once.
    invented
        Metres of the map beside no wall.
    per_wall
        Segments of the map for each wall that counts: 1 is a perfect reduction. Below 1 walls are
        swallowed: look at `found`.
    found
        Share of the walls that count which own the largest part of some segment.
    offset, angle
        Root mean square over the metres of the map that lie beside a wall.
    pieces : (p, 2, 2) array, metres
        The map, cut where its owner changes.
    owner : (p,) int array
        Wall of each piece, -1 where it is invented.
    lost, twice : (m, 2, 2) arrays, metres
        The stretches of the walls that are missed, and those that the map has more than once.
    """

    walls: Array
    seen: Array
    kept: Array
    doubled: Array
    invented: float
    per_wall: float
    found: float
    offset: float
    angle: float
    pieces: Array
    owner: NDArray[np.int64]
    lost: Array
    twice: Array

    @property
    def missed(self) -> float:
        """Metres of wall that could be known and are not in the map."""
        return float((self.seen - self.kept).sum())

    def __repr__(self) -> str:
        whole = self.seen.sum() or np.nan
        return (
            f"AgainstWalls({self.per_wall:.2f} segments a wall, {self.found:.0%} of the walls "
            f"found, {self.missed / whole:.1%} missed, {self.invented / whole:.1%} invented, "
            f"{self.doubled.sum() / whole:.1%} double, {1000 * self.offset:.0f} mm off)"
        )


@checked
def against_walls(
    walls: Segments,
    map: Segments,
    *,
    seen: Segments | None = None,
    distance: Metres = 0.10,
    angle: Annotated[Radians, at_most(np.pi / 2)] = np.radians(5),
    least: Annotated[Metres, at_least(0)] = 0.10,
) -> AgainstWalls:
    """Judge a map by the true walls: what it keeps, misses, invents and has twice.

    A piece of a segment lies beside a wall where it is at most `distance` off its line, within its
    ends, and turned by at most `angle` (a short segment by as much as half of `distance` turns it,
    at most 30 degrees). Of several walls the one with the least squared offset owns the piece.

    Parameters
    ----------
    walls : SegmentMap or (w, 2, 2) array
        Walls that continue each other count as one. A thin wall is two: one for each side.
    map : SegmentMap, Reduction or (n, 2, 2) array
        What is judged, in the frame of `walls`.
    seen
        A map of what could be known: that of the same scans at their true poses, or the map before
        its reduction where these are not known. None takes the walls whole.
    distance
        0.10 m is three times the noise of a good log; half the thickness of a wall is the limit.
    least
        A wall counts where so much of it, or all of it, was seen.

    Raises
    ------
    ValueError
        For walls without any length: there is nothing to judge by.

    Examples
    --------
    >>> room = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]])
    >>> against_walls(room, [[(0, 0.02), (3, 0.02)], [(2, 0), (4.5, 0)], [(4, 0), (4, 3)]])
    AgainstWalls(0.75 segments a wall, 50% of the walls found, 50.0% missed, 3.6% invented, \
7.1% double, 12 mm off)
    """
    whole = joined_walls(arrays.segments(walls, "walls"))
    if not len(whole):
        raise ValueError("walls must hold a segment that has a length, got none")
    segments = arrays.segments(map, "map")
    segments = segments[length(segments) >= MIN_LENGTH]
    size = length(whole)
    limits = distance, float(np.sin(angle))
    spans = [[(0.0, end)] for end in size]
    if seen is not None:
        looks = arrays.segments(seen, "seen")
        spans = _assign_owners(whole, looks[length(looks) >= MIN_LENGTH], *limits).spans(len(whole))
    mine = _assign_owners(whole, segments, *limits)
    could, mapped, doubled = np.zeros((3, len(whole)))
    lost: list[Array] = []
    twice: list[Array] = []
    for k, (theirs, own) in enumerate(zip(spans, mine.spans(len(whole)), strict=True)):
        at = np.unique([0.0, *np.ravel(theirs), *np.ravel(own)])
        seen_there, times, step = _cover(at, theirs) > 0, _cover(at, own), np.diff(at)
        could[k] = step[seen_there].sum()
        mapped[k] = step[seen_there & (times > 0)].sum()
        doubled[k] = (step * np.maximum(times - 1, 0)).sum()
        for which, pieces in ((seen_there & (times == 0), lost), (times > 1, twice)):
            ends = at[np.diff(which.astype(int), prepend=0, append=0) != 0] / size[k]
            pieces.append(whole[k, 0] + np.outer(ends, whole[k, 1] - whole[k, 0]).reshape(-1, 2, 2))
    counts = could >= np.minimum(least, size) - MIN_LENGTH
    metres = np.zeros((len(segments), len(whole) + 1))  # the last column: beside no wall
    np.add.at(metres, (mine.of, mine.owner), mine.metres)
    most = metres[:, :-1].argmax(axis=1)[metres[:, :-1].any(axis=1)]
    beside = mine.owner >= 0
    weight = mine.metres[beside].sum() or np.nan
    walls_left = np.count_nonzero(counts)
    return AgainstWalls(
        walls=whole,
        seen=could,
        kept=mapped,
        doubled=doubled,
        invented=float(metres[:, -1].sum()),
        per_wall=len(segments) / walls_left if walls_left else np.nan,
        found=len(set(most[counts[most]])) / walls_left if walls_left else np.nan,
        offset=float(np.sqrt((mine.squares * mine.metres)[beside].sum() / weight)),
        angle=float(np.sqrt((mine.turns * mine.metres)[beside].sum() / weight)),
        pieces=mine.pieces,
        owner=mine.owner,
        lost=np.concatenate(lost),
        twice=np.concatenate(twice),
    )


def joined_walls(walls: Array) -> Array:
    """Walls with those that lie on one line and touch made one, longest first; others stay."""
    remaining = walls[np.argsort(-length(walls), kind="stable")]
    remaining = remaining[length(remaining) >= MIN_LENGTH]
    joined = []
    while len(remaining):
        wall, remaining = remaining[0], remaining[1:]
        while True:
            size = float(length(wall))
            way = (wall[1] - wall[0]) / size
            along = (remaining - wall[0]) @ way
            off = abs((remaining - wall[0]) @ (-way[1], way[0])).max(axis=1)
            touches = (along.min(axis=1) <= size + ONE_LINE) & (along.max(axis=1) >= -ONE_LINE)
            grows = np.flatnonzero(touches & (off <= ONE_LINE))
            if not len(grows):
                break
            ends = min(0.0, along[grows[0]].min()), max(size, along[grows[0]].max())
            wall = wall[0] + np.outer(ends, way)
            remaining = np.delete(remaining, grows[0], axis=0)
        joined.append(wall)
    return np.reshape(joined, (-1, 2, 2))


class _Pieces(NamedTuple):
    """Segments cut where their owner changes, `(p,)` each; lengths in metres."""

    pieces: Array  # (p, 2, 2)
    of: NDArray[np.int64]  # the segment that it is a piece of
    owner: NDArray[np.int64]  # its wall, -1 for none
    metres: Array
    squares: Array  # mean squared offset from its wall, metres^2
    turns: Array  # square of its angle to its wall, radians^2
    low: Array  # where it begins on its wall, and where it ends
    high: Array

    def spans(self, walls: int) -> list[list[tuple[float, float]]]:
        """Where on each wall its pieces lie."""
        spans: list[list[tuple[float, float]]] = [[] for _ in range(walls)]
        for k, low, high in zip(self.owner, self.low, self.high, strict=True):
            if k >= 0:
                spans[k].append((low, high))
        return spans


def _assign_owners(walls: Array, segments: Array, distance: float, sine: float) -> _Pieces:
    """Cut each segment at the ends of what lies beside a wall, and give each piece its owner."""
    size, step = length(walls), segments[:, 1] - segments[:, 0]
    way = (walls[:, 1] - walls[:, 0]) / size[:, None]
    metres = length(segments)
    # along and across each wall, at the start of each segment and to its end: (n, w)
    to = segments[:, None, 0] - walls[:, 0]
    along = np.einsum("nwk,wk->nw", to, way)
    off = to[..., 1] * way[:, 0] - to[..., 0] * way[:, 1]
    run, rise = step @ way.T, step[:, 1:] * way[:, 0] - step[:, :1] * way[:, 1]
    start, end = np.zeros_like(run), np.ones_like(run)
    for at, by, low, high in ((along, run, 0.0, size), (off, rise, -distance, distance)):
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (low - at) / by, (high - at) / by
        within = (at >= low) & (at <= high)
        one = np.where(by == 0, np.where(within, -np.inf, np.inf), one)
        other = np.where(by == 0, np.inf, other)
        start = np.maximum(start, np.minimum(one, other))
        end = np.minimum(end, np.maximum(one, other))
    turn = np.minimum(abs(rise) / metres[:, None], 1.0)
    may = np.maximum(sine, np.minimum(0.5, distance / 2 / metres))
    start[turn > may[:, None]] = np.inf
    # what lies beside a wall, in the order of segments and walls
    pair, wall = np.nonzero((end - start) * metres[:, None] > MIN_LENGTH)
    start, end, along, run, off, rise, turn = (
        each[pair, wall] for each in (start, end, along, run, off, rise, turn)
    )
    whole = np.arange(len(segments))
    of = np.concatenate([whole, whole, pair, pair])
    cuts = np.concatenate([np.zeros(len(whole)), np.ones(len(whole)), start, end])
    order = np.lexsort([cuts, of])
    of, cuts = of[order], cuts[order]
    apart = (np.diff(of, prepend=-1) > 0) | (np.diff(cuts, prepend=0.0) * metres[of] > MIN_LENGTH)
    of, cuts = of[apart], cuts[apart]
    last = np.diff(of, append=len(segments)) > 0
    cuts[last] = 1.0
    a, b, of = cuts[~last], cuts[1:][~last[:-1]], of[~last]
    # every piece with every pair of its segment
    first = np.searchsorted(pair, of)
    many = np.searchsorted(pair, of, "right") - first
    piece = np.repeat(np.arange(len(of)), many)
    near = np.arange(len(piece)) + np.repeat(first - np.cumsum(many) + many, many)
    middle = (a + b)[piece] / 2
    here = (start[near] <= middle) & (middle <= end[near])
    piece, near = piece[here], near[here]
    u, v = (off[near] + t[piece] * rise[near] for t in (a, b))
    squares = (u * u + u * v + v * v) / 3
    least = np.full(len(of), np.inf)
    np.minimum.at(least, piece, squares)
    alike = np.flatnonzero(squares <= least[piece] + ALIKE_OFFSETS_M2)
    piece, lowest = np.unique(piece[alike], return_index=True)
    squares, near = squares[alike[lowest]], near[alike[lowest]]
    owned = np.zeros((4, len(of)))  # square, turn and ends of what has an owner
    ends = np.sort([along[near] + t[piece] * run[near] for t in (a, b)], axis=0)
    owned[:, piece] = squares, np.arcsin(turn[near]) ** 2, *ends
    owner = np.full(len(of), -1)
    owner[piece] = wall[near]
    pieces = segments[of, :1] + np.stack([a, b], -1)[..., None] * step[of, None]
    return _Pieces(pieces, of, owner, (b - a) * metres[of], *owned)


def _cover(at: Array, spans: list[tuple[float, float]]) -> NDArray[np.int64]:
    """How many of some spans cover each stretch between ends `(k + 1,)`; `(k,)`."""
    low, high = np.sort(np.reshape(spans, (-1, 2)), axis=0).T
    begun, ended = (np.searchsorted(each, at[:-1], "right") for each in (low, high))
    return begun - ended
