"""Whether solved poses keep what matches said as they came, before any loop: the bend.

The consistency test of RRR (Latif et al. 2013), over windows of a chain of motions.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses.motions import between, compose, wrap
from ...scans.causes import Cause, Finding
from ._solver_kernels import Edge

#: Motions of a chain that a window holds: from what one room shows to a floor.
WINDOWS = (4, 8, 16, 32, 64)
#: Above this the chain and the poses contradict each other. It is no number of standard deviations:
#: the poses contain the chain. Right maps of simulated and real drives have 3.1 at most, the median
#: is 0.1; wrong ones up to 70.
MOST_BEND = 3.5


class Bends(NamedTuple):
    """Windows of a chain: both ends of each, and by how much the poses leave the chain there."""

    first: NDArray[np.int64]  # (w,), poses at both ends
    last: NDArray[np.int64]
    size: Array  # (w,), in standard deviations of the chain
    off: Array  # (w, 3), the later end as the poses have it, in the frame that the chain gives it

    def finding(self, scans: NDArray[np.int64], what: str, metres: float = 0.0) -> list[Finding]:
        """What speaks against poses that bend their chain: the narrowest window that tells it.

        `scans`, `(n,)`, are those at the poses; `what` names these. Only windows count whose end
        lies `metres` elsewhere and more.
        """
        far = np.hypot(self.off[:, 0], self.off[:, 1])
        torn = np.flatnonzero((self.size > MOST_BEND) & (far >= metres))
        if not len(torn):
            return []
        length = (self.last - self.first)[torn]
        narrow = torn[length == length.min()]
        k = narrow[np.argmax(self.size[narrow].round(9))]
        turn, ends = abs(float(np.degrees(self.off[k, 2]))), scans[[self.first[k], self.last[k]]]
        words = f"between scans {ends[0]} and {ends[1]} {what} tears what the matches say by"
        words += f" {far[k]:.2f} m and {turn:.1f} degrees"
        return [Finding(Cause.BEND, float(far[k]), words)]


def chain_bends(edges: Edge, poses: Array) -> Bends:
    """How poses `(n, 3)` bend the chain of all edges between neighbours."""
    steps = ~edges.loop
    return bends(edges.relative[steps], np.linalg.inv(edges.information[steps]), poses)


def bends(motions: Array, covariances: Array, poses: Array) -> Bends:
    """How poses `(n, 3)` bend a chain of motions `(n - 1, 3)` with covariances `(n - 1, 3, 3)`.

    Of a window: M the composed motions, C their covariance, each carried along the chain, F the
    motion between the poses at its ends; of d = M^-1 F the Mahalanobis distance by C.

    Examples
    --------
    >>> straight = np.arange(9)[:, None] * (0.5, 0.0, 0.0)
    >>> steps, covariances = np.diff(straight, axis=0), [np.diag([0.02, 0.02, 0.005]) ** 2] * 8
    >>> torn = straight + np.where(np.arange(9) < 4, 0, 0.3)[:, None] * (0, 1, 0)
    >>> bends(steps, covariances, straight).finding(np.arange(9), "the map")
    []
    >>> print(*bends(steps, covariances, torn).finding(np.arange(9), "the map"))
    between scans 0 and 4 the map tears what the matches say by 0.30 m and 0.0 degrees
    """
    steps = len(motions)
    x, y, heading = motions.T
    # A motion that errs moves the end of the next one: both in the frame of the later pose
    carry = np.zeros((steps, 3, 3))
    carry[:, 0, 0] = carry[:, 1, 1] = np.cos(heading)
    carry[:, 0, 1] = np.sin(heading)
    carry[:, 1, 0] = -carry[:, 0, 1]
    carry[:, 2, 2] = 1.0
    own = carry @ np.asarray(covariances) @ carry.transpose(0, 2, 1)
    arm = np.broadcast_to(np.eye(3), (steps, 3, 3)).copy()
    arm[:, 0, 2], arm[:, 1, 2] = -y, x
    carry = carry @ arm
    none = np.zeros(0, np.int64)
    parts = [Bends(none, none, np.zeros(0), np.zeros((0, 3)))]
    for window in (w for w in WINDOWS if w <= steps):
        first = np.arange(0, steps - window + 1, window // 4)
        motion, covariance = np.zeros((len(first), 3)), np.zeros((len(first), 3, 3))
        for step in first + np.arange(window)[:, None]:
            motion = compose(motion, motions[step])
            covariance = carry[step] @ covariance @ carry[step].transpose(0, 2, 1) + own[step]
        off = between(motion, between(poses[first], poses[first + window]))
        off[:, 2] = wrap(off[:, 2])
        weighed = np.linalg.solve(covariance, off[:, :, None])[:, :, 0]
        size = np.sqrt(np.einsum("ni,ni->n", off, weighed))
        parts.append(Bends(first, first + window, size, off))
    return Bends(*map(np.concatenate, zip(*parts, strict=True)))
