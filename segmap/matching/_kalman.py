"""Where a robot is on a map of segments, from a start that is known: an extended Kalman filter."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import chi2

from .. import arrays
from ..angles import wrap
from ..arrays import Array, Metres, Quantity, checked
from ..extraction import extract_polylines
from ..poses import between, compose, transform
from ..scans import LaserScan
from ..segments import SegmentMap, angle, length, midpoint, point_distance
from ..simulation import OdometryNoise

#: Points of a scan so near to one of its segments are those behind it, metres: three deviations.
BEHIND_M = 0.03
#: The middle of what a scan sees may lie so far beyond the end of a wall, metres.
BEYOND_END_M = 0.3

#: A start that is known worse than to a kilometre is none, square metres.
MOST_VARIANCE_M2 = 1e6


class KalmanState(NamedTuple):
    """What an extended Kalman filter holds after a scan.

    `pose`, (3,) array, and `covariance`, (3, 3), metres and radians. `pairs`, (m, 2), are the
    segments of the scan and the walls of the map that were taken for one another; `innovations`,
    (m, 2), how far each is from where it was predicted, radians and metres; `distances`, (m,), its
    squared Mahalanobis distance. `unmatched` segments of the scan agree with no wall.
    """

    pose: Array
    covariance: Array
    pairs: NDArray[np.int64]
    innovations: Array
    distances: Array
    unmatched: int

    def nees(self, truth: ArrayLike) -> float:
        """Normalised estimation error squared, from the true pose (3,), metres and radians.

        3 in the mean where the covariance is what it says; more where it is too sure.
        """
        error = self.pose - arrays.pose(truth, "truth")
        error[2] = wrap(error[2])
        return float(error @ np.linalg.solve(self.covariance, error))


@checked
def localize_ekf(
    map: SegmentMap,
    scans: Iterable[LaserScan],
    start: ArrayLike,
    covariance: ArrayLike,
    *,
    odometry_noise: OdometryNoise = OdometryNoise(),
    sigma: Metres = 0.01,
    wall_sigma: Annotated[float, Quantity("metres", least=0)] = 0.0,
    gate: Annotated[float, Quantity("", above=0, most=0.9999)] = 0.99,
) -> Iterator[KalmanState]:
    """Keep track of a robot on a map of segments by an extended Kalman filter (B 2.2 [9]).

    Odometry moves the pose, and its covariance grows. Each segment of the scan is compared with the
    wall that predicts it best: its direction, and the offset of its middle across the wall. Pairs
    within the gate correct the pose, all at once. One hypothesis only: where the start is wrong, or
    a wall is taken for its neighbour, the covariance shrinks all the same, and nothing tells but
    `distances`. Use `localize` where the start is unknown.

    Parameters
    ----------
    map
        One segment for each wall. Errors of its walls are the same at each look: `wall_sigma` makes
        a single look less sure, and cannot make many of them independent.
    scans
        A Log, or scans one by one, with odometry.
    start : (3,) array, metres and radians
        Where the robot is at the first scan.
    covariance : (3, 3) array
        How well that is known.
    sigma
        Standard deviation of a point of a scan.
    wall_sigma
        Standard deviation of an end of a wall, across it.
    gate
        So many right pairs of a hundred pass, as a share.

    Yields
    ------
    KalmanState
        After each scan.

    Raises
    ------
    ValueError
        At once for wrong arguments; later it names the scan that is no LaserScan or has no
        odometry.

    Examples
    --------
    >>> from segmap import load, reduction
    >>> from segmap.extraction import build_map
    >>> log = load("room")
    >>> walls = SegmentMap(reduction.least_cost(build_map(log, log.truth)).segments)
    >>> for state in localize_ekf(walls, log, log.truth[0], np.diag([0.1, 0.1, 0.05]) ** 2):
    ...     pass
    >>> bool(np.hypot(*(state.pose - log.truth[-1])[:2]) < 0.03)
    True
    """
    arrays.instance(map, "map", SegmentMap)
    arrays.instance(odometry_noise, "odometry_noise", OdometryNoise)
    if not arrays.is_iterable(scans):
        raise ValueError(f"scans must be a Log, or give scans, got {arrays.brief(scans)}")
    first, known = arrays.pose(start, "start"), arrays.values(covariance, "covariance")
    good = known.shape == (3, 3) and np.isfinite(known).all() and np.allclose(known, known.T)
    if not good or np.linalg.eigvalsh(known)[0] <= 0 or known.max() > MOST_VARIANCE_M2:
        said = "symmetric, positive in all directions, at most a square kilometre"
        raise ValueError(f"covariance must be (3, 3), {said}; got {arrays.brief(covariance)}")
    walls, limit = map.filtered(BEHIND_M).segments, float(chi2.ppf(gate, 2))

    def states(pose: Array, spread: Array) -> Iterator[KalmanState]:
        before: Array | None = None
        for k, scan in enumerate(scans):
            arrays.instance(scan, f"scan {k}", LaserScan)
            if scan.odometry is None:
                raise ValueError(f"scan {k} has no odometry, which moves the filter: use localize")
            if before is not None:
                pose, spread = moved(pose, spread, between(before, scan.odometry), odometry_noise)
            before, sigmas = scan.odometry, (sigma, wall_sigma)
            yield (state := corrected(pose, spread, scan, walls, sigmas, limit))
            pose, spread = state.pose, state.covariance

    return states(first, known)


def moved(pose: Array, covariance: Array, way: Array, noise: OdometryNoise) -> tuple[Array, Array]:
    """Pose and covariance after a motion `(3,)`, metres and radians."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    world_from_robot = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    by_pose = np.eye(3)
    by_pose[:2, 2] = world_from_robot[:2, :2] @ (-way[1], way[0])
    far, turn = np.hypot(way[0], way[1]), abs(way[2])
    error = np.zeros((3, 3))
    error[:2, :2] = noise.distance_noise**2 / max(far, 1e-9) * np.outer(way[:2], way[:2])
    error[2, 2] = noise.turn_noise**2 * turn + noise.heading_noise**2 * far
    error[2, 2] += (noise.turn_bias * turn) ** 2
    spread = by_pose @ covariance @ by_pose.T + world_from_robot @ error @ world_from_robot.T
    return compose(pose, way), spread


def corrected(
    pose: Array, spread: Array, scan: LaserScan, walls: Array, sigmas: Sequence[float], gate: float
) -> KalmanState:
    """What the segments of a scan make of a prediction."""
    points = scan.points()
    seen = extract_polylines(points, closed=scan.whole_turn)
    placed = transform(pose, seen)
    middle, size = midpoint(placed), length(walls)
    along = (walls[:, 1] - walls[:, 0]) / size[:, None]
    normal = along[:, ::-1] * (-1, 1)
    away = middle[:, None] - walls[:, 0]  # (seen, walls, 2)
    turned = (angle(placed)[:, None] - angle(walls) + np.pi / 2) % np.pi - np.pi / 2
    innovation = np.stack([turned, (away * normal).sum(-1)], -1)
    by_pose = np.zeros((*turned.shape, 2, 3))
    by_pose[..., 0, 2], by_pose[..., 1, :2] = 1, normal
    by_pose[..., 1, 2] = ((middle - pose[:2])[:, None, ::-1] * (-1, 1) * normal).sum(-1)
    behind = (point_distance(points[:, None], seen) < BEHIND_M).sum(0)
    point, wall = sigmas[0] ** 2, sigmas[1] ** 2
    error = np.zeros((*turned.shape, 2, 2))
    error[..., 0, 0] = (12 * point / behind / length(seen) ** 2)[:, None] + 2 * wall / size**2
    error[..., 1, 1] = (point / behind + wall)[:, None]
    both = by_pose @ spread @ by_pose.swapaxes(-1, -2) + error
    distance = (innovation * np.linalg.solve(both, innovation[..., None])[..., 0]).sum(-1)
    beyond = np.abs((away * along).sum(-1) - size / 2) - size / 2
    distance[beyond > BEYOND_END_M] = np.inf
    best = distance.argmin(1) if len(walls) else np.zeros(len(seen), np.int64)
    i = np.flatnonzero(distance.min(1, initial=np.inf) <= gate)
    j, left = best[i], len(seen) - len(i)
    gain = by_pose[i, j].swapaxes(1, 2) @ np.linalg.inv(error[i, j])  # (m, 3, 2)
    spread = np.linalg.inv(np.linalg.inv(spread) + (gain @ by_pose[i, j]).sum(0))
    pose = pose - spread @ (gain @ innovation[i, j, :, None]).sum(0)[:, 0]
    pose[2] = wrap(pose[2])
    return KalmanState(pose, spread, np.stack([i, j], -1), innovation[i, j], distance[i, j], left)
