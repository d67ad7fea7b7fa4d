"""Members of the classes of MRPT that a 2D log is made of, in all versions that MRPT 2.5 reads."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from .._mounting import in_space
from .._raw_scans import NOWHERE
from ._stream import NEXT_IN_MAP, Parser, Parsers, Stream, Unknown

#: Seconds from 1601, where MRPT's clock of 100 ns ticks starts, to 1970.
EPOCH = 11_644_473_600
#: How the robot's movement was told: by its wheels.
BY_ODOMETRY = 0


class Turn(NamedTuple):
    """One turn of a laser as the file has it, and the robot's poses by odometry and in truth."""

    ranges: Array
    angles: Array
    valid: NDArray[np.bool_]
    time: float | None
    place: Array  #: (4, 4): the laser's pose on the robot, in space
    limit: float
    odometry: Array = NOWHERE
    truth: Array = NOWHERE


class Movement(NamedTuple):
    """How the robot moved since the frame before, (3,) array."""

    step: Array


class Wheels(NamedTuple):
    """The robot's pose by its wheels, (3,) array."""

    time: float | None
    pose: Array


def _laser_scan(stream: Stream, version: int) -> Turn:
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
    pose = stream.object("CPose2D")
    stream.text()
    time = _seconds(stream.values("Q")[0])
    if version and (stream.values("?")[0] or version < 2):
        stream.values("ii")
    if version and (stream.values("?")[0] or version < 2):
        stream.values("ff" if version < 2 else "ddd")
    return Wheels(time, pose)


def _movement(stream: Stream, version: int) -> Movement:
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


def _sensory_frame(stream: Stream, version: int) -> list[Any]:
    stream.values("I" if version < 2 else "")
    time = _seconds(stream.values("Q")[0]) if version == 0 else None
    found = stream.many("CObservation")
    if time is None:
        return found
    return [each._replace(time=time) if hasattr(each, "time") else each for each in found]


def _actions(stream: Stream, version: int) -> list[Any]:
    """The movement of a collection: the first, where several methods tell of the same."""
    found = stream.many("CAction")
    moved = [each for each in found if isinstance(each, Movement)]
    return [*moved[:1], *(each for each in found if isinstance(each, Unknown))]


def _simple_map(stream: Stream, version: int) -> list[Any]:
    (count,) = stream.values("I")
    stream.next, found = NEXT_IN_MAP, []
    for _ in range(count):
        pose = stream.object("CPosePDF", "CPose3DPDF")
        frame = stream.object("CSensoryFrame")
        found += [e._replace(truth=pose) if isinstance(e, Turn) else e for e in frame]
    return found


def _rawlog(stream: Stream, version: int) -> list[Any]:
    found = stream.many("CSensoryFrame", "CAction", "CObservation")
    stream.object("CObservationComment")
    return [each for part in found for each in (part if isinstance(part, list) else [part])]


def _comment(stream: Stream, version: int) -> list[Any]:
    stream.text()
    stream.values("Q")
    return []


def _matrix(kind: str) -> Parser:
    def parsed(stream: Stream, version: int) -> Array:
        rows, columns = stream.values("II")
        return stream.array(kind, rows * columns).reshape(rows, columns)

    return parsed


def _pose_2d(stream: Stream, version: int) -> Array:
    return stream.array("f8" if version else "f4", 3)


def _pose_3d(stream: Stream, version: int) -> Array:
    """A pose in space, (4, 4) array: a matrix, a quaternion, or a place and a matrix."""
    if version < 2:
        matrix = stream.object("CMatrix")
        if matrix.shape != (4, 4):
            raise stream.broken(f"expected a matrix of 4 x 4 for a pose, got {matrix.shape}")
        return matrix
    if version == 2:
        values = stream.array("f8", 7).tolist()
        try:
            return in_space(values[:3], values[3:])
        except ValueError:  # told where the object is used, once it has been read to its end
            return np.full((4, 4), np.nan)
    matrix = np.eye(4)
    matrix[:3, 3], matrix[:3, :3] = stream.array("f8", 3), stream.array("f8", 9).reshape(3, 3)
    return matrix


def _gauss_2d(stream: Stream, version: int) -> Array:
    mean = stream.object("CPose2D")
    if version:
        stream.take(6 * (8 if version > 1 else 4))
    else:
        stream.object("CMatrix")
    return mean


def _gauss_3d(stream: Stream, version: int) -> Array:
    mean = stream.object("CPose3D")
    stream.take(21 * 8)
    return mean


def _seconds(ticks: int) -> float | None:
    """Seconds since 1970; 0 ticks are no time."""
    return ticks / 1e7 - EPOCH if ticks else None


PARSERS: Parsers = {
    "CSensoryFrame": (_sensory_frame, range(3)),
    "CActionCollection": (_actions, range(1)),
    "CSimpleMap": (_simple_map, range(2)),
    "CRawlog": (_rawlog, range(2)),
    "CObservation2DRangeScan": (_laser_scan, range(8)),
    "CObservationOdometry": (_wheels, range(3)),
    "CObservationComment": (_comment, range(1)),
    "CActionRobotMovement2D": (_movement, range(8)),
    "CPose2D": (_pose_2d, range(2)),
    "CPose3D": (_pose_3d, range(4)),
    "CPosePDFGaussian": (_gauss_2d, range(3)),
    "CPose3DPDFGaussian": (_gauss_3d, [1]),
    "CMatrix": (_matrix("f4"), None),
    "CMatrixF": (_matrix("f4"), None),
    "CMatrixD": (_matrix("f8"), None),
}
