"""Logs and maps of MRPT: `.rawlog`, `.simplemap`, plain or gzip.

Read are 2D scans (CObservation2DRangeScan, versions 0 to 7), in sensory frames or on their own, and
of a simple map the robot's pose that belongs to each frame, as truth. Odometry is what
CActionRobotMovement2D (0 to 7) says of the way since the frame before, added up from the origin on;
where a log has no such thing, the poses of CObservationOdometry (0 to 2), interpolated at the time
of the scan, none before the first and after the last.

Where a laser sits is stated with each scan; one that hangs upside down is honoured, scans of one
that is tilted are left out and counted, and so are other observations (`Log.skipped`). A beam is
valid where the file says so and below the scan's largest range; of others those above it met
nothing. Dropped are intensities, spreads, velocities, encoders, and the tilt within a scan.

The members of each class and version are those of MRPT 2.5. Assumed: nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...angles import wrap
from ...arrays import LIMIT, Array, unit_checks
from ...poses import compose
from ...progress import announce
from ...scans import LaserScan, Log
from ...scans.causes import Finding
from .._lines import BROKEN, LATEST_TIME_S, LogError, Reading, open_bytes
from .._mounting import Tilted, flat, level
from .._raw_scans import Track, clean, known, known_truth
from ._classes import PARSERS, Movement, Turn, Wheels
from ._stream import Broken, Stream, Unknown, unpacked_stream

OBJECTS = ("CSensoryFrame", "CActionCollection", "CObservation", "CSimpleMap", "CRawlog")


class _Recording(Reading):
    """What the objects of one file said so far."""

    def __init__(self, path: Path, on_error: str) -> None:
        super().__init__(path, on_error)
        self.turns: list[Turn] = []
        self.track, self.pose, self.moved = Track(), np.zeros(3), False
        self.causes: Sequence[Finding] = ()

    def take(self, found: Any, start: int) -> None:
        """Take in what began at a byte; damaged values cost one object."""
        for each in found if isinstance(found, list) else [found]:
            try:
                self._take(each)
            except ValueError as fault:
                said = self.leave_out if isinstance(fault, Tilted) else self.damaged
                said(LogError(self.path, f"byte {start}: {fault}"))

    def _take(self, found: Any) -> None:
        if isinstance(found, Turn):
            self.turns.append(_sound(found._replace(odometry=self.pose)))
        elif isinstance(found, Movement):
            self.pose, self.moved = _pose(compose(self.pose, _pose(found.step))), True
        elif isinstance(found, Wheels) and found.time is not None:
            self.track.add(_checked_time(found.time), _pose(found.pose), len(self.turns))
        elif isinstance(found, Unknown):
            reason = f"byte {found.start}: {found.what} is no 2D scan, or not known here"
            self.leave_out(LogError(self.path, reason))


def recorded(path: Path, on_error: str = "raise") -> _Recording:
    """All turns of lasers in a file, and what was left out; `place` is `(3,)`, in the plane."""
    data, fault = unpacked_stream(path)
    found, stream = _Recording(path, on_error), Stream(data, PARSERS)
    if fault:
        found.damaged(LogError(path, fault))
    try:
        while stream.left:
            start = stream.at
            announce(start / max(len(data), 1), "reading objects of MRPT")
            found.take(stream.object(*OBJECTS), start)
    except Broken as broken:
        if not fault:
            found.damaged(LogError(path, str(broken)))
    if not found.moved:  # no increments: poses at the time of the scan, or none
        met = found.track.met([np.nan if turn.time is None else turn.time for turn in found.turns])
        pairs = zip(found.turns, met.times.tolist(), met.poses, strict=True)
        found.turns = [turn._replace(time=time, odometry=pose) for turn, time, pose in pairs]
        found.causes = met.causes
    return found


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a log or a map of MRPT."""
    found, scans = recorded(path, on_error), []
    if not found.turns:
        raise LogError(path, f"holds no scan, expected CObservation2DRangeScan{found.why()}")
    for turn in found.turns:
        limit = turn.limit if 0 < turn.limit < np.inf else np.inf
        ranges = clean(np.where(turn.valid | (turn.ranges >= limit), turn.ranges, np.nan), limit)
        time = np.nan if turn.time is None else turn.time
        scans.append(LaserScan(ranges, turn.angles, time, known(turn.odometry), limit, turn.place))
    truth = known_truth(np.array([turn.truth for turn in found.turns]))
    return Log(name, scans, truth, found.skipped, causes=found.causes)


def claims(path: Path) -> bool:
    """Whether a file, unpacked where it is packed, begins with an object of MRPT."""
    try:
        with open_bytes(path) as file:
            Stream(file.read(200), {}).header()
    except (*BROKEN, Broken):
        return False
    return True


def _sound(turn: Turn) -> Turn:
    """A turn whose values were checked, and whose place is one in the plane."""
    place, mirrored = flat(turn.place)
    unit_checks.check_angles(turn.angles, "angles")
    if not len(turn.ranges):
        raise ValueError("expected ranges, got a scan without")
    truth = level(turn.truth) if turn.truth.ndim > 1 else turn.truth
    truth = truth if np.isnan(truth).all() else _pose(truth)
    time = None if turn.time is None else _checked_time(turn.time)
    angles = -turn.angles if mirrored else turn.angles
    return turn._replace(place=place, angles=angles, truth=truth, time=time)


def _pose(values: Array) -> Array:
    if not (np.abs(values) <= LIMIT).all():
        raise ValueError(f"expected a pose in metres and radians, got {values.tolist()}")
    return np.array([values[0], values[1], wrap(values[2])])


def _checked_time(seconds: float) -> float:
    if not seconds <= LATEST_TIME_S:
        raise ValueError(f"expected a time, got {seconds:.6g} s since 1970")
    return seconds
