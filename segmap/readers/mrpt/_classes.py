"""Members of the classes of MRPT that a 2D log is made of, in all versions that MRPT 2.5 reads."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from .._mounting import in_space
from .._raw_scans import NOWHERE
from ._stream import NEXT_IN_MAP, Stream, Unknown

#: Seconds from 1601, where MRPT's clock of 100 ns ticks starts, to 1970.
EPOCH = 11_644_473_600
#: How the robot's movement was told: by its wheels.
BY_ODOMETRY = 0


class Turn(NamedTuple):
    """One turn of a laser as the file has it, and the robot's poses by odometry and in truth.

    Parameters
    ----------
    ranges, angles : (n,) arrays, metres and radians
    valid : (n,) bool array
    time : float, seconds, or None
    place : (4, 4) array
        The laser's pose on the robot, in space.
    limit : float, metres
    odometry, truth : (3,) arrays, metres and radians
    """

    ranges: Array
    angles: Array
    valid: NDArray[np.bool_]
    time: float | None
    place: Array
    limit: float
    odometry: Array = NOWHERE
    truth: Array = NOWHERE


class Movement(NamedTuple):
    """How the robot moved since the frame before, (3,) array, metres and radians."""

    step: Array


class Wheels(NamedTuple):
    """Time, seconds or None, and the robot's pose by its wheels, (3,) array."""

    time: float | None
    pose: Array


def _scan(stream: Stream, version: int) -> Turn:
    stream.check("CObservation2DRangeScan", version, range(8))
    aperture, to_left, limit = stream.values("f?f")
    place = stream.object("CPose3D")
    if version < 6:
        stream.object("CMatrix")
    (count,) = stream.values("I")
    ranges = stream.array("f4", count)
    valid = stream.array("u1", count) != 0 if version else ranges < limit
    stream.values("f" if version > 1 else "")
    time = _seconds(stream.values("Q")[0]) if version > 2 else None
    stream.values("f" if version > 3 else "")
    if version > 4:
        stream.text()
        stream.values("d")
    if version > 6 and stream.values("?")[0]:
        stream.array("i4", count)
    half = aperture / 2 if to_left else -aperture / 2
    angles = np.linspace(-half, half, count) if count > 1 else np.zeros(count)
    return Turn(ranges, angles, valid, time, place, limit)


def _wheels(stream: Stream, version: int) -> Wheels:
    stream.check("CObservationOdometry", version, range(3))
    pose = stream.object("CPose2D")
    stream.text()
    time = _seconds(stream.values("Q")[0])
    if version and (stream.values("?")[0] or version < 2):
        stream.values("ii")
    if version and (stream.values("?")[0] or version < 2):
        stream.values("ff" if version < 2 else "ddd")
    return Wheels(time, pose)


def _movement(stream: Stream, version: int) -> Movement:
    stream.check("CActionRobotMovement2D", version, range(8))
    method = BY_ODOMETRY if version < 2 else stream.values("I")[0]
    if version > 1 and method == BY_ODOMETRY:
        step = stream.object("CPose2D")
        stream.take({2: 44, 3: 44, 4: 48}.get(version, 56))  # models of noise
    else:
        step = stream.object("CPosePDFGaussian")
    if version < 2:
        stream.values("I")
    if version and (stream.values("?")[0] or version < 7):
        stream.values("ff" if version < 7 else "ddd")
    if version and (stream.values("?")[0] or version < 7):
        stream.values("ii")
    stream.values("Q" if version > 5 else "")
    return Movement(step)


def _frame(stream: Stream, version: int) -> list[Any]:
    stream.check("CSensoryFrame", version, range(3))
    stream.values("I" if version < 2 else "")
    time = _seconds(stream.values("Q")[0]) if version == 0 else None
    found = stream.many("CObservation")
    return [each._replace(time=time) if time is not None and hasattr(each, "time") else each
            for each in found]  # fmt: skip


def _actions(stream: Stream, version: int) -> list[Any]:
    """The movement of a collection: the first, where several methods tell of the same."""
    stream.check("CActionCollection", version, (0,))
    found = stream.many("CAction")
    moved = [each for each in found if isinstance(each, Movement)]
    return [*moved[:1], *(each for each in found if isinstance(each, Unknown))]


def _simple_map(stream: Stream, version: int) -> list[Any]:
    stream.check("CSimpleMap", version, (0, 1))
    (count,) = stream.values("I")
    stream.next, found = NEXT_IN_MAP, []
    for _ in range(count):
        pose = stream.object("CPosePDF", "CPose3DPDF")
        frame = stream.object("CSensoryFrame")
        found += [e._replace(truth=pose) if isinstance(e, Turn) else e for e in frame]
    return found


def _rawlog(stream: Stream, version: int) -> list[Any]:
    stream.check("CRawlog", version, (0, 1))
    found = stream.many("CSensoryFrame", "CAction", "CObservation")
    stream.object("CObservationComment")
    return [each for part in found for each in (part if isinstance(part, list) else [part])]


def _comment(stream: Stream, version: int) -> list[Any]:
    stream.check("CObservationComment", version, (0,))
    stream.text()
    stream.values("Q")
    return []


def _matrix(stream: Stream, kind: str) -> Array:
    rows, columns = stream.values("II")
    return stream.array(kind, rows * columns).reshape(rows, columns)


def _pose_2d(stream: Stream, version: int) -> Array:
    stream.check("CPose2D", version, (0, 1))
    return stream.array("f8" if version else "f4", 3)


def _pose_3d(stream: Stream, version: int) -> Array:
    """A pose in space, (4, 4) array: a matrix, a quaternion, or a place and a matrix."""
    stream.check("CPose3D", version, range(4))
    if version < 2:
        matrix = stream.object("CMatrix")
        if matrix.shape != (4, 4):
            raise stream.broken(f"expected a matrix of 4 x 4 for a pose, got {matrix.shape}")
        return matrix
    if version == 2:
        return _of_quaternion(stream.array("f8", 7))
    matrix = np.eye(4)
    matrix[:3, 3], matrix[:3, :3] = stream.array("f8", 3), stream.array("f8", 9).reshape(3, 3)
    return matrix


def _of_quaternion(values: Array) -> Array:
    """What is no pose is told where the object is used, once it has been read to its end."""
    try:
        return in_space(values[:3].tolist(), values[3:].tolist())
    except ValueError:
        return np.full((4, 4), np.nan)


def _gauss_2d(stream: Stream, version: int) -> Array:
    stream.check("CPosePDFGaussian", version, range(3))
    mean = stream.object("CPose2D")
    if version:
        stream.take(6 * (8 if version > 1 else 4))
    else:
        stream.object("CMatrix")
    return mean


def _gauss_3d(stream: Stream, version: int) -> Array:
    stream.check("CPose3DPDFGaussian", version, (1,))
    mean = stream.object("CPose3D")
    stream.take(21 * 8)
    return mean


PARSERS = {
    "CSensoryFrame": _frame,
    "CActionCollection": _actions,
    "CSimpleMap": _simple_map,
    "CRawlog": _rawlog,
    "CObservation2DRangeScan": _scan,
    "CObservationOdometry": _wheels,
    "CObservationComment": _comment,
    "CActionRobotMovement2D": _movement,
    "CPose2D": _pose_2d,
    "CPose3D": _pose_3d,
    "CPosePDFGaussian": _gauss_2d,
    "CPose3DPDFGaussian": _gauss_3d,
    "CMatrix": lambda stream, version: _matrix(stream, "f4"),
    "CMatrixF": lambda stream, version: _matrix(stream, "f4"),
    "CMatrixD": lambda stream, version: _matrix(stream, "f8"),
}


def _seconds(ticks: int) -> float | None:
    """Seconds since 1970; 0 ticks are no time."""
    return ticks / 1e7 - EPOCH if ticks else None
