"""Convert the Malaga loop from MRPT's binary files into one CARMEN log.

    python convert.py RAWLOG SIMPLEMAP malaga.log.gz

RAWLOG holds all scans and the odometry between them, SIMPLEMAP some of the scans with corrected
poses of the robot. Both are gzipped streams of objects: `0x80 + length of the class name`, the
name, a version, the members of that version, `0x88`; all numbers are little endian. Only the
classes and versions that occur in these two files are known here; any other byte is an error.
"""

import gzip
import struct
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from segmap.poses import compose

END = 0x88
#: Seconds from 1601, where MRPT's clock of 100 ns ticks starts, to 1970.
EPOCH = 11_644_473_600
#: Ranges from here on, metres, are the sensor's codes for nothing met; they are kept.
NO_RETURN = 80.0


class Stream:
    """Objects out of a gzipped MRPT file."""

    def __init__(self, path: Path) -> None:
        self.data, self.at = gzip.decompress(path.read_bytes()), 0

    def values(self, form: str) -> tuple[Any, ...]:
        """Unpack the next members; `form` as in `struct`."""
        found = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return found

    def array(self, form: str, count: int) -> np.ndarray:
        """The next `count` numbers of one kind."""
        return np.array(self.values(f"{count}{form}"))

    def object(self) -> Any:
        """The next object, as what its parser makes of it."""
        start = self.at
        name = self.values(f"{self.values('B')[0] - 0x80}s")[0].decode("ascii")
        found = PARSERS[name, self.values("B")[0]](self)
        if self.values("B")[0] != END:
            raise ValueError(f"{name} at byte {start} does not end where it should")
        return found

    def objects(self) -> Iterator[Any]:
        """All objects to the end of the file."""
        while self.at < len(self.data):
            yield self.object()


def group(stream: Stream) -> list[Any]:
    """A count and so many objects."""
    return [stream.object() for _ in range(stream.values("I")[0])]


def simple_map(stream: Stream) -> list[tuple[Any, Any]]:
    """A count and so many pairs of a pose and a group of observations."""
    return [(stream.object(), stream.object()) for _ in range(stream.values("I")[0])]


def scan(stream: Stream) -> dict[str, Any]:
    """One turn of the laser, from right to left."""
    _, right_to_left, _ = stream.values("fBf")
    sensor = stream.object()
    (count,) = stream.values("I")
    ranges, valid = stream.array("f", count), stream.array("B", count)
    _, ticks, _, label, _ = stream.values("fQfId")
    if not right_to_left or label or not np.array_equal(valid != 0, ranges < NO_RETURN):
        raise ValueError("expected beams from right to left, valid where they met something")
    return {"ranges": ranges, "time": ticks, "sensor": sensor}


def matrix(stream: Stream) -> np.ndarray:
    """Rows, columns, entries."""
    rows, columns = stream.values("II")
    return stream.array("d", rows * columns).reshape(rows, columns)


def pose_of_matrix(stream: Stream) -> np.ndarray:
    """x, y, heading of a homogeneous matrix."""
    m = stream.object()
    return np.array([m[0, 3], m[1, 3], np.arctan2(m[1, 0], m[0, 0])])


def pose_of_quaternion(stream: Stream) -> np.ndarray:
    """x, y, heading of x, y, z and a quaternion that turns about z alone."""
    x, y, _, w, i, j, k = stream.values("7d")
    if abs(i) + abs(j) > 1e-9:
        raise ValueError("expected a pose in the plane")
    return np.array([x, y, 2 * np.arctan2(k, w)])


def pose_with_covariance(stream: Stream) -> np.ndarray:
    """x, y, heading; the upper half of the 6 x 6 covariance is left out."""
    found = stream.object()
    stream.values("21d")
    return found


def movement(stream: Stream) -> np.ndarray:
    """x, y, heading that the wheels measured since the last scan."""
    (method,) = stream.values("I")
    found = stream.object()
    stream.values("I6fI6fB2fB2iQ")  # models of noise, velocities, encoders, time
    if method != 0:
        raise ValueError("expected a movement by odometry")
    return found


PARSERS: dict[tuple[str, int], Callable[[Stream], Any]] = {
    ("CSensoryFrame", 2): group,
    ("CActionCollection", 0): group,
    ("CSimpleMap", 1): simple_map,
    ("CObservation2DRangeScan", 6): scan,
    ("CActionRobotMovement2D", 6): movement,
    ("CMatrixD", 0): matrix,
    ("CPose2D", 1): lambda stream: stream.array("d", 3),
    ("CPose3D", 1): pose_of_matrix,
    ("CPose3D", 2): pose_of_quaternion,
    ("CPose3DPDFGaussian", 1): pose_with_covariance,
}


def driven(rawlog: Path) -> Iterator[tuple[dict[str, Any], np.ndarray]]:
    """Scans and the robot's poses by odometry, from the origin on."""
    odometry = np.zeros(3)
    for (found,) in Stream(rawlog).objects():
        if isinstance(found, dict):
            yield found, odometry
        else:
            odometry = compose(odometry, found)


def corrected(simple_map_file: Path) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """Ranges and the robot's corrected poses, by the time of the scan."""
    (pairs,) = Stream(simple_map_file).objects()
    return {found["time"]: (found["ranges"], pose) for pose, (found,) in pairs}


def line(found: dict[str, Any], laser: np.ndarray, odometry: np.ndarray, start: float) -> str:
    """One FLASER line."""
    time = found["time"] / 1e7 - EPOCH
    fields = [f"{r:.2f}" for r in found["ranges"]]
    fields += [f"{v:.6f}" for v in (*laser, *odometry, time)]
    return f"FLASER {len(found['ranges'])} {' '.join(fields)} malaga {time - start:.6f}"


def convert(rawlog: Path, simple_map_file: Path) -> str:
    """The log as text."""
    scans, truth = list(driven(rawlog)), corrected(simple_map_file)
    sensor = scans[0][0]["sensor"]
    lines = [f"PARAM robot_frontlaser_offset {sensor[0]:.6f}"]
    for found, odometry in scans:
        ranges, pose = truth.pop(found["time"], (found["ranges"], np.full(3, np.nan)))
        if not np.array_equal(ranges, found["ranges"]) or (found["sensor"] != sensor).any():
            raise ValueError("expected the same ranges in both files, and one place of the laser")
        start = scans[0][0]["time"] / 1e7 - EPOCH
        lines.append(line(found, compose(pose, sensor), odometry, start))
    if truth or sensor[1:].any():
        raise ValueError("expected each corrected pose to have its scan, and the laser ahead")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    text = convert(Path(sys.argv[1]), Path(sys.argv[2]))
    Path(sys.argv[3]).write_bytes(gzip.compress(text.encode("ascii"), mtime=0))
