"""Where a laser sits on its robot, out of a pose in space: flat, upside down, or of no use here."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import LIMIT, Array

#: Half a degree of tilt is in every mounting and in many descriptions of a robot; at 5 degrees a
#: wall that is 10 m away seems 4 cm farther, and its height is another by 0.9 m.
MOST_TILT = np.radians(5)


class Tilted(ValueError):
    """A laser whose scans are no sections of a building that is level."""


def planar(pose: Array) -> tuple[Array, bool]:
    """A laser's pose in the plane of the robot, and whether the laser hangs upside down.

    `pose`, (4, 4) array, carries points of the laser into the robot's frame. The place, (3,) array,
    is x, y and the direction of the beam at angle 0. Beams of a laser that hangs upside down turn
    the other way round: their angles change sign. One that is neither is `Tilted`.

    Examples
    --------
    >>> hanging = in_space((0.2, 0.0, 0.5), (0.0, 1.0, 0.0, 0.0))  # turned about x by half a turn
    >>> planar(hanging)[1]
    True
    """
    place = level(pose)
    tilt = float(np.arccos(np.clip(pose[2, 2], -1.0, 1.0)))
    mirrored = tilt > np.pi / 2
    off = np.pi - tilt if mirrored else tilt
    if not off <= MOST_TILT:
        raise Tilted(
            f"expected a laser that is level, or upside down, got one that is tilted by "
            f"{np.degrees(off):.0f} degrees: its scans are no floor plan"
        )
    return place, mirrored


def level(pose: Array) -> Array:
    """x, y and heading, (3,) array, of a pose in space, (4, 4) array."""
    if not (np.abs(pose) <= LIMIT).all():
        raise ValueError(f"expected a pose in metres and radians, got {pose[:3].tolist()}")
    return np.array([pose[0, 3], pose[1, 3], np.arctan2(pose[1, 0], pose[0, 0])])


def in_space(translation: Sequence[float], quaternion: Sequence[float]) -> Array:
    """A pose in space as a (4, 4) array, of metres x, y, z and a quaternion w, x, y, z.

    Examples
    --------
    >>> in_space((1, 2, 3), (2, 0, 0, 0))[:, 3]
    array([1., 2., 3., 1.])
    """
    values = np.array([*translation, *quaternion], float)
    if not (np.abs(values) <= LIMIT).all():
        raise ValueError(f"expected metres and a quaternion, got {values.tolist()}")
    length = float(np.sqrt(values[3:] @ values[3:]))
    if length < 1e-6:
        raise ValueError("expected a quaternion, got one of length 0")
    w, x, y, z = values[3:] / length
    pose = np.eye(4)
    pose[:3, 3] = values[:3]
    pose[:3, :3] = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return pose
