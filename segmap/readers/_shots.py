"""Laser lines before it is known where on the robot the laser sits, and the log made of them."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..angles import wrap
from ..arrays import Array
from ..poses import between, compose, inverse
from ..scans import NO_POSE, LaserScan
from ._beams import clean

NOWHERE = np.array(NO_POSE)
#: Poses closer than this, in metres and radians, are one: logs print three decimals or more.
SAME = 1e-3


class Shot(NamedTuple):
    """One laser line.

    Parameters
    ----------
    laser : str
        Which of the robot's.
    ranges : (n,) array, metres
    angles : (n,) array, radians
        Directions of the beams in the frame of the laser.
    time : float, seconds, or None
    odometry, pose : (3,) array, metres and radians
        Of the robot by its wheels; corrected, as the line has it. NaN where it has none.
    limit : float, metres
        Longest range.
    codes : (n,) int array or None
        Of beams without a range, see `segmap.error_codes`; 0 where there is one.
    """

    laser: str
    ranges: Array
    angles: Array
    time: float | None = None
    odometry: Array = NOWHERE
    pose: Array = NOWHERE
    limit: float = np.inf
    codes: NDArray[np.int64] | None = None


class Mounted(NamedTuple):
    """Where the laser sits on the robot, and the robot's corrected poses, `(k, 3)`."""

    sensor_pose: Array
    truth: Array


Mount = Callable[[str, Sequence[Shot]], Mounted]


def same_poses(a: Array, b: Array) -> bool:
    """Whether poses `(k, 3)`, metres and radians, agree in all rows; rows of NaN tell nothing."""
    step = a - b
    step[..., 2] = wrap(step[..., 2])
    return not bool((np.abs(step) > SAME).any())


def mount_by_offset(shots: Sequence[Shot], offset: Array) -> Mounted:
    """The laser's poses are corrected ones, and it sits at `offset` on the robot.

    The offset, (3,) array, and the truth, `(k, 3)`, metres and radians.
    """
    poses = np.array([shot.pose for shot in shots])
    return Mounted(offset, compose(poses, inverse(offset)))


def mount_by_poses(shots: Sequence[Shot], offset: Array) -> Mounted:
    """Each line holds the laser's and the robot's pose: what lies between them says which.

    Where it is one and the same all along it is the laser's place on the robot. Where it varies,
    the laser's poses have been corrected and the robot's not; so they have where the robot has
    none. There the laser sits at `offset`, (3,) array, metres and radians.
    """
    poses = np.array([shot.pose for shot in shots])
    relative = between(np.array([shot.odometry for shot in shots]), poses)
    known = relative[np.isfinite(relative).all(1)]
    if not len(known) or not same_poses(known, known[:1]):
        return mount_by_offset(shots, offset)
    return Mounted(np.round(known[0], 6) + 0.0, np.full_like(poses, np.nan))


def assemble(
    shots: Sequence[Shot], mount: Mount, limits: Array
) -> tuple[list[LaserScan], Array | None]:
    """Scans and corrected poses `(k, 3)`, metres and radians, of all lasers in the file's order.

    `limits`, `(k,)`, metres: the range from which on each shot met nothing.
    """
    lasers = np.array([shot.laser for shot in shots])
    places, truth = np.empty((len(shots), 3)), np.empty((len(shots), 3))
    for laser in np.unique(lasers):
        mine = np.flatnonzero(lasers == laser)
        mounted = mount(str(laser), [shot for shot in shots if shot.laser == laser])
        places[mine], truth[mine] = mounted.sensor_pose, mounted.truth
    scans = [
        _scan(shot, k, place, limit)
        for k, (shot, place, limit) in enumerate(zip(shots, places, limits, strict=True))
    ]
    return scans, truth if np.isfinite(truth).any() else None


def _scan(shot: Shot, number: int, place: Array, limit: float) -> LaserScan:
    return LaserScan(
        clean(shot.ranges, limit),
        shot.angles,
        number if shot.time is None else shot.time,
        None if np.isnan(shot.odometry).any() else shot.odometry,
        limit,
        place,
        shot.codes,
    )
