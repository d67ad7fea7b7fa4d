"""Where a robot is on a map of segments, from a start that is known: an extended Kalman filter."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..alignment.pose_graph import Wheels
from ..angles import wrap
from ..arrays import Array, Metres, Quantity, checked
from ..extraction import extract_polylines
from ..poses import between, compose, transform
from ..scans import LaserScan
from ..segments import SegmentMap, angle, length, midpoint, point_distance
from ..simulation import OdometryNoise
from ._likelihoods import Likelihoods
from ._localize import LOST_FIT, on_lines
from ._search import sample_beams

#: Points of a scan so near to one of its segments are those behind it, metres: three deviations.
BEHIND_M = 0.03
#: The middle of what a scan sees may lie so far beyond the end of a wall, metres.
BEYOND_END_M = 0.3

#: Beams of a scan that tell whether the filter is lost, as in `localize`.
ASKED_BEAMS = 60

#: Largest variance of a start, square metres: a kilometre of standard deviation.
MOST_VARIANCE_M2 = 1e6


class KalmanState(NamedTuple):
    """What an extended Kalman filter holds after a scan.

    `pose`, (3,) array, and `covariance`, (3, 3), metres and radians. `pairs`, (m, 2), are the
    segments of the scan and the walls of the map that were taken for one another; `innovations`,
    (m, 2), how far each is from where it was predicted, radians and metres; `distances`, (m,), its
    squared Mahalanobis distance. `unmatched` segments of the scan agree with no wall. `fit`, 0 to
    1, is how well the lines of the last few scans fit on the map, as in `localize`; NaN before any.
    """

    pose: Array
    covariance: Array
    pairs: NDArray[np.int64]
    innovations: Array
    distances: Array
    unmatched: int
    fit: float = np.nan

    @property
    def lost(self) -> bool:
        """Whether the scans fit so badly that the robot is elsewhere."""
        return self.fit < LOST_FIT

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
    odometry_noise: OdometryNoise | None = None,
    sigma: Metres = 0.01,
    wall_sigma: Annotated[float, Quantity("metres", least=0)] = 0.02,
    gate: Annotated[float, Quantity("", above=0, most=0.9999)] = 0.99,
) -> Iterator[KalmanState]:
    """Keep track of a robot on a map of segments by an extended Kalman filter.

    Extended Kalman filter localisation (Thrun, Burgard and Fox 2005, 7.4): odometry predicts the
    pose, and its covariance grows. Each segment of the scan is compared with the wall that predicts
    it best: its direction, and the offset of its middle across the wall. Pairs within the gate
    update the pose, all at once.

    The covariance of a motion has full rank: wheels slip to the side too, and scans and odometry
    are not of one instant. It begins with that of ordinary wheels and grows by how far odometry was
    off from the poses after the update, in the 0.9 quantile of the last 100, as in `pose_graph`.

    One hypothesis only: where the start is wrong, or a wall is taken for its neighbour, the
    covariance shrinks all the same. What tells is `lost`: lines of the scans fit to less than 0.7
    on the map. Use `localize` where the start is unknown.

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
    odometry_noise
        Noise of simulated wheels, which know no slip; None for wheels of a log.
    sigma
        Standard deviation of a point of a scan.
    wall_sigma
        Standard deviation of an end of a wall, across it: some centimetres on maps of real logs.
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
    if odometry_noise is not None:
        arrays.instance(odometry_noise, "odometry_noise", OdometryNoise)
    if not arrays.is_iterable(scans):
        raise ValueError(f"scans must be a Log, or give scans, got {arrays.brief(scans)}")
    first, spread = arrays.pose(start, "start"), arrays.values(covariance, "covariance")
    good = spread.shape == (3, 3) and np.isfinite(spread).all() and np.allclose(spread, spread.T)
    if not good or np.linalg.eigvalsh(spread)[0] <= 0 or spread.max() > MOST_VARIANCE_M2:
        wanted = "symmetric, positive in all directions, at most a square kilometre"
        raise ValueError(f"covariance must be (3, 3), {wanted}; got {arrays.brief(covariance)}")
    walls = map.filtered(BEHIND_M).segments
    limit = -2 * float(np.log(1 - gate))  # the quantile of chi squared, two degrees of freedom

    fit_on_map = Likelihoods(map).fits if len(walls) else None

    def states(pose: Array, covariance: Array) -> Iterator[KalmanState]:
        odometry_before: Array | None = None
        wheels, fit = Wheels(), np.nan
        for k, scan in enumerate(scans):
            arrays.instance(scan, f"scan {k}", LaserScan)
            if scan.odometry is None:
                raise ValueError(f"scan {k} has no odometry, which moves the filter: use localize")
            pose_before = pose
            if odometry_before is not None:
                motion = between(odometry_before, scan.odometry)
                wheels.begin()
                wheels.drive(motion)
                noise = np.diag(wheels.deviations() ** 2)
                if odometry_noise is not None:
                    noise = simulated_noise(motion, odometry_noise)
                pose, covariance = predict_pose(pose, covariance, motion, noise)
            state = update_pose(pose, covariance, scan, walls, (sigma, wall_sigma), limit)
            if odometry_before is not None and len(state.pairs):
                wheels.compare(between(pose_before, state.pose))
            ends = scan.points()
            if fit_on_map is not None and len(ends):
                asked = sample_beams(on_lines(ends, 1), ASKED_BEAMS)
                now = float(fit_on_map(asked, state.pose[None])[0])
                fit = now if np.isnan(fit) else np.sqrt(fit * now)
            odometry_before, pose, covariance = scan.odometry, state.pose, state.covariance
            yield state._replace(fit=float(fit))

    return states(first, spread)


def simulated_noise(motion: Array, noise: OdometryNoise) -> Array:
    """Covariance (3, 3) of a motion `(3,)`, metres and radians, in the frame where it began."""
    distance, turn = np.hypot(motion[0], motion[1]), abs(motion[2])
    covariance = np.zeros((3, 3))
    direction = np.outer(motion[:2], motion[:2]) / max(distance, 1e-9)
    covariance[:2, :2] = noise.distance_noise**2 * direction
    covariance[2, 2] = noise.turn_noise**2 * turn + noise.heading_noise**2 * distance
    covariance[2, 2] += (noise.turn_bias * turn) ** 2
    return covariance


def predict_pose(
    pose: Array, covariance: Array, motion: Array, motion_noise: Array
) -> tuple[Array, Array]:
    """Pose and covariance after a motion `(3,)`, metres and radians, of covariance `(3, 3)`."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    world_from_robot = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    by_pose = np.eye(3)  # derivative of the new pose by the old one
    by_pose[:2, 2] = world_from_robot[:2, :2] @ (-motion[1], motion[0])
    predicted = by_pose @ covariance @ by_pose.T
    predicted += world_from_robot @ motion_noise @ world_from_robot.T
    return compose(pose, motion), predicted


def update_pose(
    pose: Array,
    covariance: Array,
    scan: LaserScan,
    walls: Array,
    sigmas: tuple[float, float],
    gate: float,
) -> KalmanState:
    """A predicted pose, corrected by the segments of a scan; deviations of a point and of a wall.

    Each segment is paired with the wall of least Mahalanobis distance, if that is below `gate`.
    """
    points = scan.points()
    segments = extract_polylines(points, closed=scan.whole_turn)
    placed = transform(pose, segments)
    middle, wall_length = midpoint(placed), length(walls)
    along = (walls[:, 1] - walls[:, 0]) / wall_length[:, None]
    normal = along[:, ::-1] * (-1, 1)
    offset = middle[:, None] - walls[:, 0]  # (segments, walls, 2)
    # Innovation of each pair: turn of the line, and offset of its middle across the wall
    turn = (angle(placed)[:, None] - angle(walls) + np.pi / 2) % np.pi - np.pi / 2
    innovation = np.stack([turn, (offset * normal).sum(-1)], -1)
    jacobian = np.zeros((*turn.shape, 2, 3))  # H, its derivative by the pose
    jacobian[..., 0, 2], jacobian[..., 1, :2] = 1, normal
    lever = (middle - pose[:2])[:, None, ::-1] * (-1, 1)
    jacobian[..., 1, 2] = (lever * normal).sum(-1)
    # Its noise R: a line is known the better, the longer it is and the more points lie on it
    point_count = (point_distance(points[:, None], segments) < BEHIND_M).sum(0)
    point_variance, wall_variance = sigmas[0] ** 2, sigmas[1] ** 2
    noise = np.zeros((*turn.shape, 2, 2))
    noise[..., 0, 0] = (12 * point_variance / point_count / length(segments) ** 2)[:, None]
    noise[..., 0, 0] += 2 * wall_variance / wall_length**2
    noise[..., 1, 1] = (point_variance / point_count + wall_variance)[:, None]
    # Gate by S = H P H' + R, and only walls that the middle of the segment lies beside
    innovation_covariance = jacobian @ covariance @ jacobian.swapaxes(-1, -2) + noise
    weighted = np.linalg.solve(innovation_covariance, innovation[..., None])[..., 0]
    mahalanobis = (innovation * weighted).sum(-1)
    beyond_end = np.abs((offset * along).sum(-1) - wall_length / 2) - wall_length / 2
    mahalanobis[beyond_end > BEYOND_END_M] = np.inf
    nearest = mahalanobis.argmin(1) if len(walls) else np.zeros(len(segments), np.int64)
    segment = np.flatnonzero(mahalanobis.min(1, initial=np.inf) <= gate)
    wall, unmatched = nearest[segment], len(segments) - len(segment)
    # All pairs at once, in information form
    weights = jacobian[segment, wall].swapaxes(1, 2) @ np.linalg.inv(noise[segment, wall])
    information = np.linalg.inv(covariance) + (weights @ jacobian[segment, wall]).sum(0)
    covariance = np.linalg.inv(information)
    pose = pose - covariance @ (weights @ innovation[segment, wall, :, None]).sum(0)[:, 0]
    pose[2] = wrap(pose[2])
    pairs, distances = np.stack([segment, wall], -1), mahalanobis[segment, wall]
    return KalmanState(pose, covariance, pairs, innovation[segment, wall], distances, unmatched)
