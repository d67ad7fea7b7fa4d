"""Where the robot was by its wheels, recorded at other times than the scans."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..poses import interpolate
from ..scans import NO_POSE
from ._shots import Shot


class Track:
    """Poses and their times, in any order; lines without a pose are left out."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.poses: list[Array] = []

    def add(self, time: float, pose: Array) -> None:
        """Note one pose, (3,) array, metres and radians, and its time in seconds."""
        if np.isfinite(pose).all():
            self.times.append(time)
            self.poses.append(pose)

    def at(self, times: ArrayLike) -> Array:
        """Poses between the noted ones, `(m, 3)`, metres and radians; NaN outside of them."""
        when = np.asarray(times, float)
        if not self.times:
            return np.full((len(when), 3), NO_POSE)
        order = np.argsort(self.times, kind="stable")
        return interpolate(np.array(self.times)[order], np.array(self.poses)[order], when)


def with_odometry(shots: Sequence[Shot], track: Track) -> list[Shot]:
    """The shots, those without odometry with what the track says at their time.

    Odometry is a (3,) array, metres and radians, NaN where nothing is known; times in seconds.
    """
    times = [np.nan if shot.time is None else shot.time for shot in shots]
    return [
        shot._replace(odometry=pose) if np.isnan(shot.odometry).any() else shot
        for shot, pose in zip(shots, track.at(times), strict=True)
    ]
