"""MRPT's binary files, written member by member: the room of log_samples, and every old version."""

import struct

import numpy as np
from log_samples import ODOMETRY, TIMES, TRUTH

from segmap.poses import between

EPOCH = 11_644_473_600
RANGES = (1.5, 2.0, 2.5, 81.83, 3.0)


def pack(form, *values) -> bytes:
    return struct.pack("<" + form, *values)


def new(name, version, *members) -> bytes:
    """An object as MRPT writes it since 0.5.5."""
    return (
        bytes([0x80 + len(name)]) + name.encode() + bytes([version]) + b"".join(members) + b"\x88"
    )


def old(name, version, *members) -> bytes:
    """An object as it was before: longer numbers, and no mark of its end."""
    return pack("I", len(name)) + name.encode() + pack("i", version) + b"".join(members)


def ticks(seconds) -> bytes:
    return pack("Q", round((seconds + EPOCH) * 1e7) if seconds else 0)


def text(words) -> bytes:
    return pack("I", len(words)) + words.encode()


def group(*objects) -> bytes:
    return pack("I", len(objects)) + b"".join(objects)


# ------------------------------------------------------------------------------ poses
def in_space(x, y, yaw, roll=0.0, pitch=0.0):
    """A homogeneous matrix."""
    (cy, sy), (cp, sp), (cr, sr) = ((np.cos(a), np.sin(a)) for a in (yaw, pitch, roll))
    turn = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    turn = turn @ [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]] @ [[1, 0, 0], [0, cr, -sr], [0, sr, cr]]
    return np.block([[turn, np.array([[x], [y], [0.4]])], [np.zeros((1, 3)), 1]])


def matrix(values, kind="d", name=None, write=new) -> bytes:
    values = np.atleast_2d(values)
    numbers = pack(f"{values.size}{kind}", *values.ravel())
    return write(name or f"CMatrix{kind.upper()}", 0, pack("II", *values.shape), numbers)


def quaternion(x, y, yaw) -> bytes:
    return pack("7d", x, y, 0.4, np.cos(yaw / 2), 0, 0, np.sin(yaw / 2))


def pose_3d(x, y, yaw, version=3, write=new, **tilt) -> bytes:
    m = in_space(x, y, yaw, **tilt)
    if version == 2:
        return write("CPose3D", 2, quaternion(x, y, yaw))
    if version == 3:
        return write("CPose3D", 3, pack("12d", *m[:3, 3], *m[:3, :3].ravel()))
    name, kind = ("CMatrix", "f") if version == 0 else ("CMatrixD", "d")
    return write("CPose3D", version, matrix(m, kind, name, write))


def pose_2d(pose, version=1, write=new) -> bytes:
    return write("CPose2D", version, pack("3d" if version else "3f", *pose))


def gauss_2d(pose, version=2, write=new) -> bytes:
    tails = (matrix(np.eye(3), "f", "CMatrix", write), bytes(24), bytes(48))
    return write("CPosePDFGaussian", version, pose_2d(pose, 1, write), tails[version])


def gauss_3d(pose) -> bytes:
    return new("CPose3DPDFGaussian", 1, pose_3d(*pose), bytes(21 * 8))


# ----------------------------------------------------------------------- observations
def scan(time, version=6, place=(0.3, 0.1, 0.0), write=new, ranges=RANGES, to_left=True, bad=(),
         **tilt):  # fmt: skip
    """A scan over half a turn; the fourth beam met nothing, bad ones are flagged."""
    n = len(ranges)
    members = [pack("f?f", np.pi, to_left, 80.0)]
    members += [pose_3d(*place, 0 if write is old else 1 if version < 7 else 3, write, **tilt)]
    members += [matrix(np.zeros((3, 3)), "f", "CMatrix", write)] * (version < 6)
    members += [pack(f"I{n}f", n, *ranges)]
    members += [bytes(int(r < 80 and k not in bad) for k, r in enumerate(ranges))] * (version > 0)
    members += [pack("f", 0.01)] * (version > 1) + [ticks(time)] * (version > 2)
    members += [pack("f", 0.004)] * (version > 3)
    members += [text("front") + pack("d", 0.0)] * (version > 4)
    members += [pack(f"?{n}i", True, *range(n))] * (version > 6)
    return write("CObservation2DRangeScan", version, *members)


def wheels(time, pose, version=2) -> bytes:
    encoders = {0: b"", 1: pack("?ii", False, 1, 2), 2: pack("?ii", True, 1, 2)}[version]
    speeds = {0: b"", 1: pack("?ff", True, 1, 2), 2: pack("?ddd", True, 1, 0, 2)}[version]
    known = pose_2d(pose), text("wheels"), ticks(time), encoders, speeds
    return new("CObservationOdometry", version, *known)


def movement(step, version=6, method=0) -> bytes:
    noise = {0: 0, 1: 0, 2: 44, 3: 44, 4: 48}.get(version, 56)
    known = gauss_2d(step) if method or version < 2 else pose_2d(step) + bytes(noise)
    told = known + pack("I", method) if version < 2 else pack("I", method) + known
    rest = b"" if version == 0 else pack("?ff?ii", True, 1, 2, True, 3, 4)
    rest = pack("?ddd??"[:5], True, 1, 0, 2, False) if version == 7 else rest
    return new("CActionRobotMovement2D", version, told, rest, ticks(1.0) * (version > 5))


def frame(*observations, version=2) -> bytes:
    head = pack("I", 7) * (version < 2) + ticks(TIMES[0]) * (version == 0)
    return new("CSensoryFrame", version, head, group(*observations))


def actions(*found) -> bytes:
    return new("CActionCollection", 0, group(*found))


STEP = between(*ODOMETRY)
BEACONS = new("CObservationBeaconRanges", 3, pack("3f", 1, 2, 3), new("CPoint3D", 1, bytes(24)))

#: Actions and frames; observations alone; a map of today, and one from before 2010.
RAWLOG = b"".join(
    [
        new("CObservationComment", 0, text("a room"), ticks(1.0)),
        frame(scan(TIMES[0])),
        actions(movement(STEP)),
        frame(scan(TIMES[1]), BEACONS),
    ]
)
OBSERVATIONS = b"".join(
    part
    for time, pose in zip(TIMES, ODOMETRY, strict=True)
    for part in (wheels(time, pose), scan(time, 7).replace(b"\x97C", b"\xa2mrpt::obs::C"))
)
SIMPLE_MAP = new(
    "CSimpleMap",
    1,
    pack("I", 2),
    *(gauss_3d(pose) + frame(scan(time)) for time, pose in zip(TIMES, TRUTH, strict=True)),
)
OLD_MAP = old(
    "CSensFrameProbSequence",
    0,
    pack("I", 2),
    *(
        gauss_2d(pose, 1, old)
        + old("CSensorialFrame", 1, pack("I", 0), group(scan(time, 4, write=old)))
        for time, pose in zip(TIMES, TRUTH, strict=True)
    ),
)
BINARY_FILES = {
    "rawlog": RAWLOG,
    "observations": OBSERVATIONS,
    "simplemap": SIMPLE_MAP,
    "old_simplemap": OLD_MAP,
}
