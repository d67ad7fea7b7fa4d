"""A pose graph solved again: without some of its loops, or with others."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..poses import between, compose
from ._solver import REAL, SCALE, Edges, solve


def solve_graph(
    poses: ArrayLike,
    edges: ArrayLike,
    relative: ArrayLike,
    *,
    information: ArrayLike | None = None,
    scale: float = SCALE,
) -> Array:
    """Poses that fit measured motions best, the first scan held (Grisetti et al. 2010).

    Scans that no edge names stay where they are beside the last one before them that has an edge.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians
        Of all scans, to begin from; the nearest minimum is found.
    edges : (m, 2) int array
        Indices of the scans at both ends.
    relative : (m, 3) array, metres and radians
        Measured pose of the second in the frame of the first.
    information : (m, 3, 3) array or None
        Inverse covariances; None: 2 cm and 0.3 degrees for all.
    scale : float
        Edges left open by so many standard deviations have half the weight (Cauchy); `inf`: plain
        least squares.

    Returns
    -------
    (k, 3) array, metres and radians

    Raises
    ------
    ValueError
        For arrays of the wrong shape, values that are not finite, an edge to a scan that does not
        exist, a scan that has edges but is not tied to the first one, a scale that is not positive.

    Examples
    --------
    Two steps of one metre, and a third measurement that makes both of them 1.7 m:

    >>> edges, motions = [(0, 1), (1, 2), (2, 0)], [(1, 0, 0), (1, 0, 0), (-1.7, 0, 0)]
    >>> solve_graph(np.zeros((3, 3)), edges, motions, scale=np.inf)[:, 0].round(6).tolist()
    [0.0, 0.9, 1.8]
    >>> solve_graph(np.zeros((3, 3)), edges, motions)[:, 0].round(2).tolist()
    [0.0, 0.99, 1.97]
    """
    start, ends, motion, weight = _checked(poses, edges, relative, information)
    if not scale > 0:
        raise ValueError(f"scale must be positive, got {scale}")
    if not len(ends):
        return start
    key, index = np.unique(ends, return_inverse=True)
    first, second = index.reshape(-1, 2).T
    _check_tied(key, first, second)
    placed = solve(start[key], Edges(first, second, motion, weight), scale=scale)
    on = np.maximum(np.searchsorted(key, np.arange(len(start)), side="right") - 1, 0)
    return compose(placed[on], between(start[key[on]], start))


def _checked(
    poses: ArrayLike, edges: ArrayLike, relative: ArrayLike, weights: ArrayLike | None
) -> tuple[Array, NDArray[np.int64], Array, Array]:
    """The four arrays, with what they must hold."""
    start, ends = np.array(poses, float), np.array(edges, np.int64).reshape(-1, 2)
    m, motion = len(ends), np.array(relative, float).reshape(-1, 3)
    usual = np.broadcast_to(np.linalg.inv(REAL), (m, 3, 3))
    weight = usual if weights is None else np.array(weights, float)
    for name, array, shape in (
        ("poses", start, (len(start), 3)),
        ("relative", motion, (m, 3)),
        ("information", weight, (m, 3, 3)),
    ):
        if array.shape != shape or not np.isfinite(array).all():
            raise ValueError(f"{name} must be {shape} and finite, got shape {array.shape}")
    if m and (ends.min() < 0 or ends.max() >= len(start)):
        got = f"{ends.min()} to {ends.max()}"
        raise ValueError(f"edges must name scans 0 to {len(start) - 1}, got {got}")
    return start, ends, motion, weight


def _check_tied(
    key: NDArray[np.int64], first: NDArray[np.int64], second: NDArray[np.int64]
) -> None:
    """Refuse a scan of which the edges say nothing relative to the first."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(first)), (first, second)), shape=(len(key), len(key)))
    group = connected_components(graph, directed=False)[1]
    if (apart := np.flatnonzero(group != group[0])).size:
        scan = int(key[apart[0]])
        raise ValueError(f"edges must tie all scans to the first; scan {scan} is not tied to it")
