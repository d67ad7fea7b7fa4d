"""Frontiers: where space that is known to be free meets space that nobody has seen."""

from __future__ import annotations

from copy import deepcopy
from typing import NamedTuple

import numpy as np

from .. import arrays
from ..arrays import Array, Metres, checked
from ._map import QuadtreeMap
from ._squares import NINE, Squares


class Frontier(NamedTuple):
    """One stretch of border between free and unknown space.

    `edges`, `(n, 2, 2)`, are the sides of leaves of which it is made, `places`, `(n, 2)`, lie
    beside their middles on the free side, and `size` is its whole length; all in metres.
    """

    edges: Array
    places: Array
    size: float


@checked
def frontiers(map: QuadtreeMap, *, min_size: Metres = 0.5) -> list[Frontier]:
    """Where free space meets the unknown, the longest first (Yamauchi 1997; A 2.4, steps 4 and 5).

    A leaf is free below an occupancy of 0.5, and unknown where it is 0.5, but for cells beside one
    where a beam ended: the mask leaves these out (B 4.4.2). Sides that touch at their ends belong
    together. Maps are to be built with a `free_resolution`: without, a large leaf is
    free as soon as one ray has crossed it.

    Parameters
    ----------
    min_size : float
        Shorter ones are left out: by default, gaps that are narrower than a robot.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=1, size=4, free_resolution=1)
    >>> tree.insert_scan((0.5, 0.5), [], free_points=[(2.5, 0.5)])
    >>> [(len(frontier.edges), frontier.size) for frontier in frontiers(tree)]
    [(8, 8.0)]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    map = deepcopy(arrays.instance(map, "map", QuadtreeMap))  # as it is now
    _, cell, level = map.tree.leaves()
    value = np.append(map.leaf_occupancy(), 0.5)  # the last stands for what lies outside the root
    squares = Squares(cell, level)
    hit = cell[map.leaves().occ > 0]
    masked = squares.at((hit[:, None] + NINE).reshape(-1, 2))
    masked = masked[(level[masked] == 0) & (value[masked] == 0.5) & (masked >= 0)]
    value[masked] = np.nan
    one, other, edges = squares.borders()
    inside = value[one] < 0.5  # else the larger one of the two is the free one
    met = np.where(inside, value[other] == 0.5, (value[one] == 0.5) & (value[other] < 0.5))
    one, inside, edges = one[met], inside[met], edges[met]
    middle, side = edges.mean(1), (1 << level[one])[:, None]
    inward = cell[one] + side / 2 - middle
    places = middle + np.where(inside[:, None], inward, -inward)

    ends, corner = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    a, b = corner.reshape(-1, 2).T
    joined = coo_array((np.ones(len(a)), (a, b)), shape=(len(ends),) * 2)
    group = connected_components(joined, directed=False)[1][a] if len(a) else a
    corner_of_map = map.corner + map.tree.corner * map.resolution
    edges, places = (corner_of_map + part * map.resolution for part in (edges, places))
    sizes = np.bincount(group, side[:, 0] * map.resolution)
    order = [k for k in np.argsort(-sizes, kind="stable").tolist() if sizes[k] >= min_size]
    return [Frontier(edges[group == k], places[group == k], float(sizes[k])) for k in order]
