"""Headings of all scans at once, then places of all at once: A 2.2-2.15, mended.

Both are the same problem, A's 2.3: the x that make `sum w |x_i - x_j + c|^2` least. Setting its
derivatives to zero gives `B x = A` with a graph Laplacian B, which leaves one x of each connected
group of scans free: that one is held. *Slips:* A's 2.6 lacks a minus before its first sum, the
right sides of 2.11 and 2.15 have the wrong sign, and 2.13-2.14 lack a factor 2 and half of what
stands off the diagonal. Here all of them come from `solve`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..angles import axial_difference
from ..arrays import Array
from ..segments import angle

Indices = NDArray[np.int64]


class Pairs(NamedTuple):
    """Segments that correspond.

    Attributes
    ----------
    i, j : (p,) int array
        Scans of both.
    u, v : (p,) int array
        Indices of both segments.
    weight : (p,) array
        `exp(-D / (2 sigma^2))` (2.7).
    """

    i: Indices
    j: Indices
    u: Indices
    v: Indices
    weight: Array


def solve(i: Indices, j: Indices, weight: Array, gap: Array, held: NDArray[np.bool_]) -> Array:
    """The x, `(n, c)`, with the least `sum w |x_i - x_j + gap|^2`, zero where held (2.3-2.6).

    Every group of connected scans must have one that is held: see `groups`.

    Parameters
    ----------
    i, j : (p,) int array
    weight : (p,) array
    gap : (p, c) array, radians or metres
        Of turns or of shifts; x has its unit.
    held : (n,) bool array

    Examples
    --------
    >>> ends = np.array([0, 1]), np.array([1, 2])
    >>> held = np.array([True, False, False])
    >>> solve(*ends, np.ones(2), np.array([[1.0], [2.0]]), held).ravel().tolist()
    [0.0, 1.0, 3.0]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    n, free = len(held), np.flatnonzero(~held)
    found = np.zeros((n, gap.shape[1]))
    if not len(free):
        return found
    rows, columns = np.r_[i, j, i, j], np.r_[i, j, j, i]
    entries = np.r_[weight, weight, -weight, -weight]
    laplacian = coo_array((entries, (rows, columns)), shape=(n, n)).tocsr()
    right = np.zeros((n, gap.shape[1]))
    np.add.at(right, i, -weight[:, None] * gap)
    np.add.at(right, j, weight[:, None] * gap)
    found[free] = splu(laplacian[free][:, free].tocsc()).solve(right[free])
    return found


def groups(i: Indices, j: Indices, count: int) -> Indices:
    """For each of so many scans, which group of connected scans it belongs to, `(n,)`."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(i)), (i, j)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def with_one_held(i: Indices, j: Indices, held: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Held scans, and the first of each group that has none: (n,) bool array, as `held` is."""
    group = groups(i, j, len(held))
    first = np.unique(group, return_index=True)[1]
    lacking = ~np.isin(group[first], group[held])
    out = held.copy()
    out[first[lacking]] = True
    return out


def best_turns(segments: Array, pairs: Pairs, held: NDArray[np.bool_]) -> Array:
    """Turns of all scans, `(n,)` radians, that make corresponding segments most parallel (2.8).

    Parameters
    ----------
    segments : (m, 2, 2) array, metres
        Of all scans, where their poses put them so far.
    pairs : Pairs
    held : (n,) bool array
    """
    gap = axial_difference(angle(segments[pairs.u]), angle(segments[pairs.v]))
    return solve(pairs.i, pairs.j, pairs.weight, gap[:, None], held)[:, 0]


def best_shifts(segments: Array, pairs: Pairs, held: NDArray[np.bool_]) -> Array:
    """Shifts of all scans, `(n, 2)` metres, that bring end points to their feet (2.12).

    The end points of u go to v and those of v go to u. Arguments as in `best_turns`.
    """
    gap, i, j = feet(segments, pairs)
    return solve(i, j, np.tile(pairs.weight, 4), gap, held)


def feet(segments: Array, pairs: Pairs) -> tuple[Array, Indices, Indices]:
    """S and E of 2.12 for both directions, (4 p, 2) array, metres, and the scans at both ends.

    Segments `(m, 2, 2)`, metres, where the poses put them. From the foot of an end point on the
    line of its partner to the end point. On the line: a wall seen in part would be drawn to the
    other end of what the partner has seen.
    """
    gaps = [
        segments[a, end] - _foot(segments[a, end], segments[b])
        for a, b in ((pairs.u, pairs.v), (pairs.v, pairs.u))
        for end in (0, 1)
    ]
    i, j = np.r_[pairs.i, pairs.i, pairs.j, pairs.j], np.r_[pairs.j, pairs.j, pairs.i, pairs.i]
    return np.concatenate(gaps), i, j


def _foot(points: Array, segments: Array) -> Array:
    d = segments[:, 1] - segments[:, 0]
    along = ((points - segments[:, 0]) * d).sum(-1) / (d * d).sum(-1)
    return segments[:, 0] + along[:, None] * d
