"""What a pose graph doubts: how well it knows the place of each scan, and what ties it there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses import between
from .._result import SURE
from ..graph import SCALE, Edge, deviations

#: So many draws give standard deviations to a tenth of their size.
DRAWS = 32
#: Loops that stay open by this many standard deviations contradict the rest.
OPEN = 5.0
#: Why a scan is not used although it matched.
LOOSE = "neither walls nor odometry say how far it went"
UNTIED = "no match ties it to the rest"


def spread(poses: Array, edges: Edge, weight: Array) -> Array:
    """Standard deviation of the place of each pose, as the information of all edges has it.

    The edges are drawn anew from their covariances, and the poses solved for, in the linear
    neighbourhood of the solution (Papandreou and Yuille 2010): 32 solves with one factorisation,
    instead of the inverse of a large matrix. The draws are the same at each call.

    Parameters
    ----------
    poses : (n, 3) array, metres and radians
        The solution; all poses are tied to the first.
    edges : Edge
    weight : (n,) array
        How many scans stand at each pose.

    Returns
    -------
    (n,) array, metres
        Of the place relative to all the others: after the rigid motion that fits best.
    """
    from scipy.sparse import bsr_array
    from scipy.sparse.linalg import splu

    m = len(edges.relative)
    known = edges.information / (1.0 + (deviations(poses, edges) / SCALE) ** 2)[:, None, None]
    blocks = _derivatives(poses, edges)
    ends, rows = np.stack([edges.first, edges.second], -1).ravel(), np.arange(0, 2 * m + 1, 2)
    shape = 3 * m, 3 * len(poses)
    jacobian = bsr_array((blocks.reshape(-1, 3, 3), ends, rows), shape=shape)
    right = bsr_array(((known[:, None] @ blocks).reshape(-1, 3, 3), ends, rows), shape=shape)
    symmetric = {"SymmetricMode": True}
    factors = splu(
        (jacobian.T @ right).tocsc()[3:, 3:],
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options=symmetric,
    )
    draws = np.random.default_rng(0).normal(size=(m, 3, DRAWS))
    pull = (np.linalg.cholesky(known) @ draws).reshape(3 * m, DRAWS)
    moved = factors.solve((jacobian.T @ pull)[3:]).reshape(-1, 3, DRAWS)[:, :2]
    left = _without_motion(poses[:, :2], np.concatenate([np.zeros((1, 2, DRAWS)), moved]), weight)
    return np.asarray(np.sqrt((left**2).sum(1).mean(-1)))


def _derivatives(poses: Array, edges: Edge) -> Array:
    """Derivatives of the residuals by the first and by the second pose, `(m, 2, 3, 3)`."""
    found = between(poses[edges.first], poses[edges.second])
    heading = poses[edges.first, 2]
    blocks = np.zeros((len(found), 2, 3, 3))
    blocks[:, 1, 0, 0] = blocks[:, 1, 1, 1] = np.cos(heading)
    blocks[:, 1, 0, 1] = np.sin(heading)
    blocks[:, 1, 1, 0] = -blocks[:, 1, 0, 1]
    blocks[:, 1, 2, 2] = 1.0
    blocks[:, 0] = -blocks[:, 1]
    blocks[:, 0, 0, 2], blocks[:, 0, 1, 2] = found[:, 1], -found[:, 0]
    return blocks


def _without_motion(places: Array, moved: Array, weight: Array) -> Array:
    """Displacements `(n, 2, d)` of places `(n, 2)`, less the small rigid motion that fits best."""
    share = weight / weight.sum()
    arm = places - share @ places
    moved = moved - np.tensordot(share, moved, 1)
    across = np.stack([-arm[:, 1], arm[:, 0]], -1)
    turn = np.einsum("n,ni,nid->d", share, across, moved) / max(share @ (arm**2).sum(1), 1e-9)
    return np.asarray(moved - across[:, :, None] * turn)


def untied(tied: Sequence[bool], edges: Sequence[Edge], weight: Array) -> NDArray[np.bool_]:
    """Which of n poses no edge that a match made ties to the largest group of them.

    `tied` says so of the step to each pose; loops always do. `weight` counts the scans of each.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    sure = [edge for edge in edges if edge.loop or tied[edge.second]]
    ends = np.reshape([edge[:2] for edge in sure], (-1, 2)).T.astype(np.int64)
    graph = coo_array((np.ones(len(sure)), ends), shape=(len(tied), len(tied)))
    group = connected_components(graph, directed=False)[1]
    return np.asarray(group != np.argmax(np.bincount(group, weight)))


def judged(reasons: Sequence[str], apart: NDArray[np.bool_]) -> tuple[str, ...]:
    """Why each scan is not used: its own reason, or that nothing ties it to the rest."""
    both = zip(reasons, apart, strict=True)
    return tuple(own or (UNTIED if alone else "") for own, alone in both)


def sentence(reasons: Sequence[str], far: Array, left: Array, *, converged: bool = True) -> str:
    """What to doubt of the whole, with numbers; empty where nothing is.

    `left` is what the solution leaves of each loop, `(m,)`, in standard deviations.
    """
    count, said = len(reasons), []
    if loose := sum(reason == LOOSE for reason in reasons):
        said.append(f"at {loose} of {count} scans {LOOSE}")
    if apart := sum(reason == UNTIED for reason in reasons):
        said.append(f"no match ties {apart} of {count} scans to the rest")
    if vague := int((far > SURE).sum()):
        worst = int(np.argmax(far))
        most = f"scan {worst} by {2 * far[worst]:.1f} m"
        said.append(f"{vague} of {count} scans may be more than {2 * SURE} m off, {most}")
    if wide := int((left > OPEN).sum()):
        said.append(f"{wide} of {len(left)} loops stay open by over {OPEN:g} standard deviations")
    if not converged:
        said.append("the solver stopped before it came to an end")
    return "; ".join(said)
