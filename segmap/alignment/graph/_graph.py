"""Pose graphs: measured motions between poses, the poses that fit them best, and how well.

Grisetti et al. (2010), "A tutorial on graph-based SLAM", with Cauchy weights.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import arrays
from ...arrays import Array, Positive, at_least, at_most
from ...poses.information import checked_information
from ...poses.motions import between, compose, wrap
from ._solver import SCALE, Solver, solve
from ._solver_kernels import Edge, Indices

if TYPE_CHECKING:
    import pandas as pd

#: Standard deviations that matches of real scans have at least, whatever their Hessian says, metres
#: and radians (the bundled logs); and their covariance.
REAL_ERRORS = 0.02, float(np.radians(0.3))
REAL = np.diag([REAL_ERRORS[0], *REAL_ERRORS]) ** 2
#: Standard deviation, metres, along a direction where a search chose the place: that says nothing.
CHOSEN_M = 100.0
#: Draws that give standard deviations to a tenth of their size.
DRAWS = 32
#: What lies within this, metres, is the neighbourhood of a pose: a large room, or a few small ones.
NEARBY_M = 20.0


class Rejected(NamedTuple):
    """A loop that was proposed and not believed: the two scans, and why."""

    first: int
    second: int
    reason: str


@dataclass(frozen=True, eq=False)
class Graph:
    """The edges that poses were solved from, with what the solution left of them.

    Parameters
    ----------
    edges : (m, 2) int array
        Indices of the scans at both ends.
    relative : (m, 3) array, metres and radians
        Measured pose of the second in the frame of the first.
    loop : (m,) bool array
        Whether the edge closes a loop (else it joins neighbours in time).
    residuals : (m,) array
        Length of what the solution leaves of each edge, in standard deviations.
    rejected : tuple of Rejected
        Loops that were proposed and not believed: first, second scan, and reason.
    information : (m, 3, 3) array or None
        Inverse covariance of each edge, metres and radians; None where the method has none.
    """

    edges: Indices
    relative: Array
    loop: NDArray[np.bool_]
    residuals: Array
    rejected: tuple[Rejected, ...] = ()
    information: Array | None = None

    def __repr__(self) -> str:
        loops, rejected = int(self.loop.sum()), len(self.rejected)
        return f"Graph({len(self.edges) - loops} steps, {loops} loops, {rejected} rejected)"


def loops_of(graph: Graph | None, poses: Array) -> pd.DataFrame:
    """The closed loops of a graph and the poses `(k, 3)` that it gave: see `Alignment.loops`."""
    import pandas as pd

    chosen = slice(0) if graph is None else graph.loop
    ends, residual = (np.zeros((0, 2), np.int64), np.zeros(0)) if graph is None else (
        graph.edges, graph.residuals)  # fmt: skip
    first, second = ends[chosen].T
    way = np.r_[0.0, np.cumsum(np.hypot(*np.diff(poses[:, :2], axis=0).T))]
    table = {"first": first, "second": second, "residual": residual[chosen]}
    table |= {"scans": abs(second - first), "metres": abs(way[second] - way[first])}
    for name, scan in (("first", first), ("second", second)):
        table |= {f"{axis}_{name}": poses[scan, k] for k, axis in enumerate("xy")}
    return pd.DataFrame(table).rename_axis("loop")


@arrays.checked
def solve_graph(
    poses: ArrayLike,
    edges: ArrayLike,
    relative: ArrayLike,
    *,
    information: ArrayLike | None = None,
    scale: Annotated[Positive, at_least(arrays.SMALLEST_THRESHOLD_M), at_most(np.inf)] = SCALE,
) -> Array:
    """Poses that fit measured motions best, the first scan fixed (Grisetti et al. 2010).

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
    scale
        Edges left open by so many standard deviations have half the weight (Cauchy); `inf`: plain
        least squares.

    Raises
    ------
    ValueError
        For an edge to a scan that does not exist, a scan that has edges but is not tied to the
        first one; for information that is negative, not symmetric, or leaves a pose free.

    Examples
    --------
    Two steps of one metre, and a third measurement that makes both of them 1.7 m:

    >>> edges, motions = [(0, 1), (1, 2), (2, 0)], [(1, 0, 0), (1, 0, 0), (-1.7, 0, 0)]
    >>> solve_graph(np.zeros((3, 3)), edges, motions, scale=np.inf)[:, 0].round(6).tolist()
    [0.0, 0.9, 1.8]
    >>> solve_graph(np.zeros((3, 3)), edges, motions)[:, 0].round(2).tolist()
    [0.0, 0.99, 1.97]
    """
    start = arrays.poses(poses)
    ends = arrays.table(edges, "edges", 2, unit="numbers of scans").astype(np.int64)
    m, motion = len(ends), arrays.poses(relative, "relative", count=len(ends))
    real = np.broadcast_to(np.linalg.inv(REAL), (m, 3, 3))
    weight = real if information is None else checked_information(information, m)
    if not m:
        return start
    if ends.min() < 0 or ends.max() >= len(start):
        got = f"{ends.min()} to {ends.max()}"
        raise ValueError(f"edges must name scans 0 to {len(start) - 1}, got {got}")
    key, index = np.unique(ends, return_inverse=True)
    first, second = index.reshape(-1, 2).T
    group = groups(first, second, len(key))
    if (apart := np.flatnonzero(group != group[0])).size:
        scan = int(key[apart[0]])
        raise ValueError(f"edges must tie all scans to the first; scan {scan} is not tied to it")
    try:
        solved = solve(start[key], Edge(first, second, motion, weight), scale=scale).poses
    except np.linalg.LinAlgError:
        solved = np.full((len(key), 3), np.nan)
    if not np.isfinite(solved).all():
        raise ValueError("information must fix every pose, but leaves some of them free")
    on = np.maximum(np.searchsorted(key, np.arange(len(start)), side="right") - 1, 0)
    return compose(solved[on], between(start[key[on]], start))


def groups(first: Indices, second: Indices, count: int) -> Indices:
    """For each of so many poses, which group of those that edges join it belongs to, `(n,)`."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def information(covariance: Array, least: Array = REAL, free: Array | None = None) -> Array:
    """Information of a motion with this covariance, beside that of all matches; (3, 3) arrays.

    None along the direction `free`, a unit vector `(2,)`.
    """
    along = CHOSEN_M * np.array([0.0, 0.0, 0.0] if free is None else [*free, 0.0])
    return np.asarray(np.linalg.inv(covariance + least + np.outer(along, along)))


def residuals(poses: Array, edges: Edge) -> Array:
    """What poses leave of each edge, `(m, 3)`, metres and radians, in the frame of `first`."""
    residual = between(poses[edges.first], poses[edges.second]) - edges.relative
    residual[..., 2] = wrap(residual[..., 2])
    return residual


def deviations(poses: Array, edges: Edge) -> Array:
    """Lengths of the residuals in standard deviations (Mahalanobis distances), `(m,)`."""
    r = residuals(poses, edges)
    return np.sqrt(np.maximum(np.einsum("...i,...ij,...j", r, edges.information, r), 0.0))


def place_deviations(
    poses: Array, edges: Edge, weight: Array, *, reach: float = NEARBY_M
) -> tuple[Array, Array]:
    """Standard deviation of the place of each pose, `(n,)`, as the information of all edges has it.

    The edges are drawn anew from their covariances, and the poses solved for, in the linear
    neighbourhood of the solution (Papandreou and Yuille 2010): 32 solves with one factorisation,
    instead of the inverse of a large matrix. The draws are the same at each call. All poses are
    tied to the first; `weight` counts the scans at each. The place is that relative to all others,
    and then to those within `reach` metres: after the rigid motion that fits these best.
    """
    from scipy.sparse import bsr_array
    from scipy.spatial import cKDTree

    # Derivatives of the residuals by the first and by the second pose of each edge
    m, motion = len(edges.relative), between(poses[edges.first], poses[edges.second])
    heading, blocks = poses[edges.first, 2], np.zeros((m, 2, 3, 3))
    blocks[:, 1, 0, 0] = blocks[:, 1, 1, 1] = np.cos(heading)
    blocks[:, 1, 0, 1] = np.sin(heading)
    blocks[:, 1, 1, 0] = -blocks[:, 1, 0, 1]
    blocks[:, 1, 2, 2] = 1.0
    blocks[:, 0] = -blocks[:, 1]
    blocks[:, 0, 0, 2], blocks[:, 0, 1, 2] = motion[:, 1], -motion[:, 0]
    weight_of = 1.0 / (1.0 + (deviations(poses, edges) / SCALE) ** 2)
    information = edges.information * np.where(edges.forced, 1.0, weight_of)[:, None, None]
    ends, rows = np.stack([edges.first, edges.second], -1).ravel(), np.arange(0, 2 * m + 1, 2)
    shape = 3 * m, 3 * len(poses)
    jacobian = bsr_array((blocks.reshape(-1, 3, 3), ends, rows), shape=shape)
    draws = np.random.default_rng(0).normal(size=(m, 3, DRAWS))
    pull = (np.linalg.cholesky(information) @ draws).reshape(3 * m, DRAWS)
    pulls = (jacobian.T @ pull).T.reshape(DRAWS, -1, 3)
    solver = Solver()
    solver.add(edges)
    moved = np.ascontiguousarray(solver.moves(poses, pulls)[:, :, :2].transpose(1, 2, 0))
    places = poses[:, :2]
    tree, near_by = cKDTree(places), np.empty(len(places))
    for k, place in enumerate(places):
        near = np.sort(tree.query_ball_point(place, reach))
        near_by[k] = _spread(places[near], moved[near], weight[near], near == k)[0]
    return _spread(places, moved, weight, slice(None)), near_by


def _spread(places: Array, moved: Array, weight: Array, asked: NDArray[np.bool_] | slice) -> Array:
    """How far those asked of places `(n, 2)` move in draws `(n, 2, d)` beside the rigid motion that
    fits all best."""
    share = weight / weight.sum()
    arm = places - share @ places
    moved = moved - np.tensordot(share, moved, 1)
    across = np.stack([-arm[:, 1], arm[:, 0]], -1)
    turn = np.einsum("n,ni,nid->d", share, across, moved) / max(share @ (arm**2).sum(1), 1e-9)
    offsets = moved[asked] - across[asked, :, None] * turn
    return np.asarray(np.sqrt((offsets**2).sum(1).mean(-1)))
