"""Where a scan lies on a whole map: branch and bound over x, y and heading (Hess et al. 2016)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Count, Share, checked
from ..compiled import compiled
from ..poses.motions import wrap
from ..quadtree import QuadtreeMap
from ..scans import LaserScan
from ..segments import SegmentMap
from ._field import FAR_AWAY, NO_OCCUPIED_CELL, either_map
from ._likelihoods import TOP, Levels, Likelihoods
from ._scores import Cells, Counts

#: A pose that fits worse is not believed (our choice): right ones have .94, those in a wrong
#: building .5 to .77.
SURE_FIT = 0.85
#: A pose so near to a better one, metres, ...
OTHER_PEAK_M = 0.3
#: ... and turned by less, radians, is no place of its own.
OTHER_PEAK_RAD = 0.3
#: The mean beam is taken to be so many cells long at least: no headings coarser than 3 degrees.
SHORTEST = 20
#: Ends of beams that lie farther apart count as so far, metres, in what the beams are spread over.
OUTLINE_JUMP_M = 0.3
#: After so many beams a sum is given up where the rest cannot lift it to what is asked.
BEAMS_PER_CHUNK = 12
#: So many blocks are looked into between two moments at which Control-C is heard.
PORTION = 2**20
#: So many poses within the margin are kept at most.
MOST_LEAVES = 2**16
#: Shifts in cells and headings over which the covariance of a pose is taken.
SHIFTS = np.stack(np.meshgrid(*[np.arange(-4, 5)] * 3), -1).reshape(-1, 3)


class Uncertainty(StrEnum):
    """Why it is not known where the robot is; empty where it is. Code asks for these, not words."""

    NONE = ""
    NO_PLACE = "no place explains the scan"
    SEVERAL_PLACES = "several places explain it"
    TOO_MANY_PLACES = "more places explain it than are listed"
    POOR_FIT = "the best place does not fit well"
    NOT_FINISHED = "the search was stopped"
    LOST = "the robot was found and is lost"


@dataclass(frozen=True, eq=False, repr=False)
class Places:
    """Where on a map a scan may have been taken, the best place first.

    Parameters
    ----------
    poses : (n, 3) array, metres and radians
        Of the robot. None is within 0.3 m and 0.3 radians of a better one.
    scores, fits : (n,) array
        0 to 1; see `search`.
    covariances : (n, 3, 3) array
        Of x, y (metres) and heading (radians) within four cells and headings of each pose: the mean
        over the poses there, each as likely as its beams make it (Olson 2009).
    reason
        Why the first place is not the only one, or not believed; empty where it is.
    nodes
        So many blocks of poses were looked into.
    uncertainty
        The kind of the reason.
    """

    poses: Array
    scores: Array
    fits: Array
    covariances: Array
    reason: str
    nodes: int
    uncertainty: Uncertainty = Uncertainty.NONE

    @property
    def found(self) -> bool:
        """Whether the robot is at the first place: no other explains the scan as well."""
        return self.uncertainty is Uncertainty.NONE

    def __len__(self) -> int:
        return len(self.poses)

    def __repr__(self) -> str:
        if not len(self):
            return f"Places(none: {self.reason})"
        x, y, heading = self.poses[0].round(4) + 0.0
        best = f"{x:.6g} m, {y:.6g} m, {np.degrees(heading):.4g} deg, score {self.scores[0]:.2f}"
        return f"Places({best}{self.reason and f'; {self.reason}'})"


@checked
def search(
    map: QuadtreeMap | SegmentMap,
    scan: LaserScan,
    *,
    least: Share = 0.5,
    margin: Share = 0.05,
    most_places: Count = 6,
    beams: Count = 60,
    nodes: Count | None = None,
) -> Places:
    """The best pose of a scan anywhere on a map, and all other places that are nearly as good.

    Every pose on cells of 0.05 m is tried, in headings by which the mean beam moves one cell: in
    blocks, by the most that a pose of a block can score, until none is left that could change the
    answer (Hess et al. 2016). A quadtree's cells are joined up to 0.05 m, and are
    its own where these are larger.

    A score is the mean over the beams of `exp(-d^2 / 2 sigma^2)`, in 255 parts, with the distance d
    to the nearest wall and a sigma of 0.1 m. A fit is the geometric mean of nine tenths of this and
    one tenth: it falls with each beam that nothing explains. Where rooms differ in their furniture
    alone and it has moved, one that looks as another did is found there: 11 of 156 that were found
    in offices with one room in six refurnished. Nothing in one scan tells.

    Parameters
    ----------
    map : QuadtreeMap or SegmentMap
        With half a metre around it, where the robot is.
    least
        What scores less is no place.
    margin
        Places count that score so much less than the best, at most.
    most_places
        There may be more: then so many are told, and none is found.
    beams
        So many of the scan's ends are used, spread evenly along the walls.
    nodes
        At most so many blocks are looked into, about; None sets no limit.

    Returns
    -------
    Places
        `found` where one place is left and its fit is 0.85 or more.

    Examples
    --------
    >>> from segmap import load
    >>> from segmap.quadtree import build_map
    >>> log = load("room")
    >>> places = search(build_map(log, log.truth), log[20])
    >>> places.found, bool(np.hypot(*(places.poses[0] - log.truth[20])[:2]) < 0.05)
    (True, True)
    """
    either_map(map)
    points = arrays.instance(scan, "scan", LaserScan).points()
    return distinct_places(Likelihoods(map), points, least, margin, most_places, beams, nodes)


def distinct_places(
    map: Likelihoods,
    points: Array,
    least: float = 0.5,
    margin: float = 0.05,
    most_places: int = 6,
    beams: int = 60,
    nodes: int | None = None,
) -> Places:
    """The places of points `(n, 2)`, metres: see `search`."""
    if not len(points):
        none = np.zeros((0, 3)), np.zeros(0), np.zeros(0), np.zeros((0, 3, 3))
        return Places(*none, "no beam of the scan has an end", 0, Uncertainty.NO_PLACE)
    used = sample_beams(np.clip(points, -FAR_AWAY, FAR_AWAY), beams)
    scan, step = _cells_by_heading(map, used)
    full = 255 * len(used)
    asked = int(np.ceil(least * full - 1e-9)), int(margin * full + 1e-9)
    leaves, looked, stopped = _leaves(map, scan, *asked, nodes)
    leaves = leaves[np.lexsort((*leaves.T[:0:-1], -leaves[:, 0]))]
    poses = np.empty((len(leaves), 3))
    poses[:, :2] = map.corner + (leaves[:, 2:] + 0.5) * map.size
    poses[:, 2] = wrap(step * leaves[:, 1].astype(float))
    chosen = first_distinct(poses, most_places + 1)
    many, chosen = len(chosen), chosen[:most_places]
    fits = map.fits(used, poses[chosen])
    kind, reason = stopped
    if not kind and not many:
        kind, reason = Uncertainty.NO_PLACE, f"no pose scores {least:.6g}"
    elif not kind and many > most_places:
        kind, reason = Uncertainty.TOO_MANY_PLACES, f"more than {most_places} places explain it"
    elif not kind and many > 1:
        kind, reason = Uncertainty.SEVERAL_PLACES, f"{many} places explain it"
    elif not kind and fits[0] < SURE_FIT:
        kind, reason = Uncertainty.POOR_FIT, f"the best place fits it to {fits[0]:.2f} only"
    spreads = [_leaf_covariance(map, scan, leaves[k], step) for k in chosen]
    scores, covariances = leaves[chosen, 0] / full, np.reshape(spreads, (-1, 3, 3))
    return Places(poses[chosen], scores, fits, covariances, reason, looked, kind)


def _cells_by_heading(map: Likelihoods, points: Array) -> tuple[Counts, float]:
    """Cells of points at each heading, `(h, n, 2)`, for a robot in a cell's middle; the step
    between headings, radians."""
    farthest = np.hypot(*map.shape)
    lengths = np.minimum(np.hypot(*points.T) / map.size, farthest)
    count = int(np.ceil(2 * np.pi * max(lengths.mean(), SHORTEST)))
    step = 2 * np.pi / count
    angle = step * np.arange(count)[:, None]
    x, y = points.T / map.size
    c, s = np.cos(angle), np.sin(angle)
    cells = np.stack([c * x - s * y, s * x + c * y], -1) + 0.5
    return np.floor(np.clip(cells, -NO_OCCUPIED_CELL, NO_OCCUPIED_CELL)).astype(np.int32), step


def _leaves(
    map: Likelihoods, scan: Counts, least: int, slack: int, nodes: int | None
) -> tuple[Cells, int, tuple[Uncertainty, str]]:
    """Poses with a sum of at least `least`, and at most `slack` below the best: sum, heading,
    column and row; how many blocks were looked into, and why not all."""
    rows, columns = map.shape
    across, up = -(-columns >> TOP), -(-rows >> TOP)
    grid = Grid(map.levels, scan, columns, rows)
    bound = np.empty(len(scan) * across * up, np.int32)
    bound_blocks(grid, across, up, bound)
    order = np.flatnonzero(bound >= least)
    order = order[np.argsort(-bound[order], kind="stable")]
    blocks = np.stack([bound[order], *np.unravel_index(order, (len(scan), up, across))], -1)
    state, leaves = np.array([least, 0, 0, len(bound)]), np.empty((MOST_LEAVES, 4), np.int64)
    todo, stopped = np.empty((3 * TOP + 4, 4), np.int64), (Uncertainty.NONE, "")
    while state[2] < len(blocks) and not stopped[0]:
        portion = PORTION if nodes is None else max(min(PORTION, nodes - int(state[3])), 1)
        branch_and_bound(grid, blocks, least, slack, portion, todo, state, leaves)
        if state[1] == MOST_LEAVES:
            stopped = Uncertainty.TOO_MANY_PLACES, f"it fits at more than {MOST_LEAVES} poses"
        elif nodes is not None and state[3] >= nodes and state[2] < len(blocks):
            stopped = Uncertainty.NOT_FINISHED, f"the search stopped after {state[3]} blocks"
    kept = leaves[: state[1]]
    return kept[kept[:, 0] >= max(state[0] - slack, least)], int(state[3]), stopped


def _leaf_covariance(map: Likelihoods, scan: Counts, leaf: Cells, step: float) -> Array:
    """Covariance `(3, 3)` of the pose of a leaf, metres and radians."""
    h, i, j = (leaf[1:] + SHIFTS).T
    cells = scan[h % len(scan)] + np.stack([i, j], -1)[:, None]
    worth = map.likelihood(map.corner + (cells + 0.5) * map.size).sum(1)
    weight = np.exp(worth - worth.max())
    weight /= weight.sum()
    away = SHIFTS[:, [1, 2, 0]] * np.array([map.size, map.size, step])
    cell = np.diag([map.size, map.size, step]) ** 2 / 12
    return np.asarray((away.T * weight) @ away + cell)


def sample_beams(points: Array, beams: int) -> Array:
    """At most so many of a scan's ends `(n, 2)`, metres: at equal steps along what they outline.

    Every k-th beam would show the near walls alone. They come in an order in which the first few
    lie all over the scan.
    """
    count = min(len(points), beams)
    way = np.minimum(np.hypot(*np.diff(points, axis=0).T), OUTLINE_JUMP_M)
    along = np.r_[0.0, np.cumsum(way)]
    if count < len(points):
        points = points[np.searchsorted(along, np.linspace(0, along[-1], count))]
    return points[np.argsort(np.arange(count) * 0.618034 % 1)]


def at_one_place(poses: Array, pose: Array, metres: float, turn: float) -> NDArray[np.bool_]:
    """Which poses `(n, 3)` lie no farther than that from one, and turned by no more radians."""
    away = poses - pose
    return (np.hypot(*away.T[:2]) <= metres) & (np.abs(wrap(away[:, 2])) <= turn)


def first_distinct(poses: Array, most: int) -> Cells:
    """Indices of the first pose, `(n, 3)`, and of each that lies apart from all taken before it."""
    left, chosen = np.arange(len(poses)), np.zeros(0, np.int64)
    while len(left) and len(chosen) < most:
        chosen = np.append(chosen, left[0])
        left = left[~at_one_place(poses[left], poses[left[0]], OTHER_PEAK_M, OTHER_PEAK_RAD)]
    return chosen


# ---------------------------------------------------------------------------------- loops
class Grid(NamedTuple):
    """A map and a scan in cells."""

    levels: Levels  # (l, rows, columns), with the border
    scan: Counts  # (h, n, 2): column and row of each end at each heading, from the robot's cell
    columns: int  # without the border
    rows: int


@compiled
def bound_scores(
    grid: Grid, level: int, h: int, i: int, j: int, across: int, up: int, need: int, most: Counts
) -> None:
    """Write the most that a pose of each block scores, 255 a beam; -1 if that is below `need`.

    So many blocks of `2^level` cells a side lie side by side, and so many rows of them one above
    the other, from column i and row j on.
    """
    last_x, last_y = grid.levels.shape[2] - 1, grid.levels.shape[1] - 1
    border, beams = 1 << (len(grid.levels) - 1), grid.scan.shape[1]
    values, cells = grid.levels[level], grid.scan[h]
    for block in range(across * up):
        at_x, at_y = i + border + (block % across << level), j + border + (block // across << level)
        total, begin = 0, 0
        while begin + BEAMS_PER_CHUNK <= beams and total + 255 * (beams - begin) >= need:
            for k in range(BEAMS_PER_CHUNK):
                x = min(max(cells[begin + k, 0] + at_x, 0), last_x)
                y = min(max(cells[begin + k, 1] + at_y, 0), last_y)
                total += int(values[np.uint64(y), np.uint64(x)])  # no index from the end: fast
            begin += BEAMS_PER_CHUNK
        if total + 255 * (beams - begin) >= need:
            for k in range(begin, beams):
                x = min(max(cells[k, 0] + at_x, 0), last_x)
                y = min(max(cells[k, 1] + at_y, 0), last_y)
                total += int(values[y, x])
        most[block] = total if total >= need else -1


@compiled
def bound_blocks(grid: Grid, across: int, up: int, bound: Counts) -> None:
    """Write the most that each of the first blocks scores, all blocks of a heading together."""
    for h in range(len(grid.scan)):
        own = bound[h * across * up :]
        bound_scores(grid, len(grid.levels) - 1, h, 0, 0, across, up, 0, own)


@compiled
def branch_and_bound(
    grid: Grid,
    blocks: Cells,
    least: int,
    slack: int,
    portion: int,
    todo: Cells,
    state: Cells,
    leaves: Cells,
) -> None:
    """Write the poses of the first blocks, the best first, that score near the best.

    Blocks and leaves are rows of 4: score, heading, column and row, those of a block counted in
    blocks. `state` holds the best score, how many leaves there are, how many of the first blocks
    are done, and how many were looked into: a call ends soon after a portion. `todo` is room.
    """
    top, looked, most = len(grid.levels) - 1, 0, np.empty(4, np.int32)
    best, count, at = state[0], state[1], state[2]
    while at < len(blocks) and looked < portion and count < len(leaves):
        need = max(best - slack, least)
        if blocks[at, 0] < need:
            at = len(blocks)
            break
        h = blocks[at, 1]
        todo[0, 0], todo[0, 1] = blocks[at, 0], top
        todo[0, 2], todo[0, 3] = blocks[at, 3] << top, blocks[at, 2] << top
        used, at = 1, at + 1
        while used:
            used -= 1
            total, level, i, j = todo[used, 0], todo[used, 1], todo[used, 2], todo[used, 3]
            if total < need:
                continue
            if level == 0:
                if count == len(leaves):
                    count = drop_below(leaves, need)
                if count == len(leaves):
                    break
                leaves[count, 0], leaves[count, 1] = total, h
                leaves[count, 2], leaves[count, 3] = i, j
                best, count = max(best, total), count + 1
                need = max(best - slack, least)
                continue
            half, first = 1 << (level - 1), used
            across, up = 1 + (i + half < grid.columns), 1 + (j + half < grid.rows)
            bound_scores(grid, level - 1, h, i, j, across, up, need, most)
            looked += across * up
            for q in range(across * up):
                a, b, total = i + half * (q % across), j + half * (q // across), most[q]
                if total < 0:
                    continue
                m = used
                while m > first and todo[m - 1, 0] > total:  # ascending: the best is taken first
                    for k in range(4):
                        todo[m, k] = todo[m - 1, k]
                    m -= 1
                todo[m, 0], todo[m, 1], todo[m, 2], todo[m, 3] = total, level - 1, a, b
                used += 1
    state[0], state[1], state[2], state[3] = best, count, at, state[3] + looked


@compiled
def drop_below(leaves: Cells, need: int) -> int:
    """Move the leaves that score enough to the front; how many these are."""
    count = 0
    for k in range(len(leaves)):
        if leaves[k, 0] >= need:
            for m in range(4):
                leaves[count, m] = leaves[k, m]
            count += 1
    return count
