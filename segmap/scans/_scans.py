"""One turn of the laser, and a log of many with what else the robot recorded."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, unit_checks
from ..display import Pictured
from ..poses.motions import transform, wrap
from .causes import Finding

T = TypeVar("T")

NO_POSE = (np.nan, np.nan, np.nan)
#: No laser takes longer for a turn, seconds; the milliseconds of one are more.
LONGEST_TURN_S = 10.0
#: In a whole turn the last beam is at most so many steps before the first: one may be missing.
SEAM_STEPS = 2.5


@dataclass(frozen=True, eq=False, repr=False)
class LaserScan(Pictured):
    """Ranges that one turn of the laser measured.

    A beam is valid where its range is finite, positive and below `max_range`. Readers write `inf`
    where the beam met nothing and NaN where the sensor reported an error; a range that is masked
    becomes NaN. Angles in degrees are
    refused; a warning tells of ranges that look like millimetres.

    Parameters
    ----------
    ranges : (n,) array, metres
    angles : (n,) array, radians
        Directions of the beams in the sensor's frame, counter-clockwise, 0 ahead.
    time : float, seconds
        NaN where it is not known.
    odometry : (3,) array, metres and radians, or None
        Pose of the robot by odometry, in a frame that drifts.
    max_range : float, metres
    sensor_pose : (3,) array, metres and radians
        Pose of the sensor in the frame of the robot.
    codes : (n,) int array or None
        Error codes of the sensor, where its format has them; 0 where it reported none.
    delays : (n,) array, seconds, or None
        How long after `time` each beam was measured: `time`, and the pose of the scan, are those of
        the beam measured first. None takes all beams to be measured at once.

    Examples
    --------
    >>> scan = LaserScan([1.0, np.inf, 2.0], np.radians([-90, 0, 90]))
    >>> scan.valid
    array([ True, False,  True])
    >>> scan.points().round(6)
    array([[ 0., -1.],
           [ 0.,  2.]])
    """

    ranges: Array
    angles: Array
    time: float
    odometry: Array | None
    max_range: float
    sensor_pose: Array
    codes: NDArray[np.int64] | None
    delays: Array | None

    def __init__(
        self,
        ranges: ArrayLike,
        angles: ArrayLike,
        time: float = 0.0,
        odometry: ArrayLike | None = None,
        max_range: float = np.inf,
        sensor_pose: ArrayLike = (0.0, 0.0, 0.0),
        codes: ArrayLike | None = None,
        delays: ArrayLike | None = None,
    ) -> None:
        keep = object.__setattr__
        keep(self, "ranges", _frozen_row(arrays.ranges(ranges), "ranges"))
        keep(self, "angles", _frozen_row(angles, "angles", len(self.ranges)))
        if not np.isfinite(self.angles).all():
            raise ValueError("angles must be finite, in radians")
        unit_checks.check_angles(self.angles, "angles")
        keep(self, "time", _checked_number(time, "time"))
        pose = None if odometry is None else arrays.pose(odometry, "odometry", missing=True)
        keep(self, "odometry", None if pose is None else _freeze(pose))
        keep(self, "max_range", _checked_number(max_range, "max_range"))
        if np.isnan(self.max_range):
            raise ValueError("max_range must be a number, in metres, got nan")
        unit_checks.check_ranges(self.ranges, self.max_range)
        keep(self, "sensor_pose", _freeze(arrays.pose(sensor_pose, "sensor_pose")))
        unit_checks.check_angles(self.sensor_pose[2], "sensor_pose[2]")
        for name, values, kind in (("codes", codes, int), ("delays", delays, float)):
            known = None if values is None else _frozen_row(values, name, len(self.ranges), kind)
            keep(self, name, known)
        if self.delays is not None and not ((self.delays >= 0) & np.isfinite(self.delays)).all():
            raise ValueError("delays must be finite and at least 0, in seconds after time")
        if self.delays is not None and (turn := self.delays.max(initial=0.0)) > LONGEST_TURN_S:
            most = f"{LONGEST_TURN_S:g} s after time, got {turn:.6g}"
            raise ValueError(f"delays must be at most {most}: are they milliseconds?")

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which beams hold a measurement, `(n,)` bool."""
        r = self.ranges
        return np.isfinite(r) & (r > 0) & (r < self.max_range)

    @property
    def whole_turn(self) -> bool:
        """Whether the beams go all round: the last one is next to the first."""
        steps = wrap(np.diff(self.angles))
        if not len(steps):
            return False
        seam, steps = 2 * np.pi - abs(steps.sum()), np.abs(steps)
        return bool(seam < SEAM_STEPS * steps.max() and seam < SEAM_STEPS * np.median(steps))

    def points(self) -> Array:
        """End points of the valid beams in the robot's frame, `(m, 2)` array, metres."""
        ok = self.valid
        r, a = self.ranges[ok], self.angles[ok]
        ends = np.stack([r * np.cos(a), r * np.sin(a)], -1)
        return transform(self.sensor_pose, ends) if self.sensor_pose.any() else ends + 0.0

    def __len__(self) -> int:
        return len(self.ranges)

    def __repr__(self) -> str:
        return f"LaserScan({len(self)} beams, {int(self.valid.sum())} valid, t={self.time:.6g} s)"


class Skipped(NamedTuple):
    """What `read(path, on_error="skip")` left out: how many lines, and why the first."""

    lines: int = 0
    reason: str = ""

    def __bool__(self) -> bool:
        return self.lines > 0


NOTHING_SKIPPED = Skipped()


@dataclass(frozen=True, eq=False, repr=False)
class Log(Pictured, Sequence[LaserScan]):
    """Scans in the order of recording, with the poses that the file holds.

    `len(log)`, `log[3]`, `log[-1]` and iteration give scans; a slice, a mask and an array of
    indices give a log: `log[log.times > 5]`.

    Parameters
    ----------
    name : str
    scans : sequence of LaserScan
    truth : (k, 3) array, metres and radians, or None
        Corrected pose of the robot for each scan; rows of NaN for scans without.
    skipped : Skipped
        What the reader left out of a damaged file.
    order_known : bool
        Whether `delays` have the order in which the beams were measured: drivers of ROS may state
        the other one.
    causes : tuple of Finding
        What a reader or `alignment.prepared` found; it comes first in those of every alignment.
    assumed : tuple of str
        What the file does not say and is taken to be so, a plain phrase each: a unit, a direction,
        an order, a place of the laser; a delay and a reach only in a format of one sensor.

    Examples
    --------
    >>> log = Log("two", [LaserScan([1.0], [0.0], time=t) for t in (0.0, 0.1)])
    >>> log.times, log[1:]
    (array([0. , 0.1]), Log('two', 1 scan, no odometry, no truth))
    """

    name: str
    scans: tuple[LaserScan, ...]
    truth: Array | None
    skipped: Skipped
    order_known: bool
    causes: tuple[Finding, ...]
    assumed: tuple[str, ...]

    def __init__(
        self,
        name: str,
        scans: Sequence[LaserScan],
        truth: ArrayLike | None = None,
        skipped: Skipped = NOTHING_SKIPPED,
        order_known: bool = True,
        causes: Iterable[Finding] = (),
        assumed: Iterable[str] = (),
    ) -> None:
        keep = object.__setattr__
        keep(self, "name", name)
        keep(self, "scans", _all_of(scans, "scans", LaserScan))
        count = len(self.scans)
        rows = None if truth is None else arrays.poses(truth, "truth", count=count, missing=True)
        keep(self, "truth", None if rows is None else _freeze(rows))
        keep(self, "skipped", skipped)
        keep(self, "order_known", arrays.switch(order_known, "order_known"))
        keep(self, "causes", _all_of(causes, "causes", Finding))
        keep(self, "assumed", tuple(dict.fromkeys(_all_of(assumed, "assumed", str))))

    @property
    def doubt(self) -> str:
        """The words of all `causes`; empty where there is none."""
        return "; ".join(map(str, self.causes))

    @property
    def times(self) -> Array:
        """Times of the scans, `(k,)` array, seconds."""
        return np.array([scan.time for scan in self.scans])

    @property
    def odometry(self) -> Array:
        """Poses by odometry, `(k, 3)` array, metres and radians; NaN where a scan has none."""
        rows = [NO_POSE if scan.odometry is None else scan.odometry for scan in self.scans]
        return np.array(rows, float).reshape(-1, 3)

    def __len__(self) -> int:
        return len(self.scans)

    @overload
    def __getitem__(self, index: int) -> LaserScan: ...
    @overload
    def __getitem__(self, index: slice | Sequence[int] | NDArray[Any]) -> Log: ...
    def __getitem__(self, index: Any) -> LaserScan | Log:
        arrays.refuse_masked(index, "the index")
        if not isinstance(index, slice) and np.ndim(index) == 0:
            return self.scans[index]
        chosen = np.arange(len(self))[index]
        truth = None if self.truth is None else self.truth[chosen]
        part = copy(self)  # the units of the whole are checked, a part may be thin
        object.__setattr__(part, "scans", tuple(self.scans[k] for k in chosen))
        object.__setattr__(part, "truth", None if truth is None else _freeze(truth))
        return part

    def __iter__(self) -> Iterator[LaserScan]:
        return iter(self.scans)

    def __repr__(self) -> str:
        count = f"{len(self)} scan" + "s" * (len(self) != 1)
        moved = sum(scan.odometry is not None for scan in self.scans)
        true = 0 if self.truth is None else int(np.isfinite(self.truth).all(1).sum())
        shares = _share_text(moved, len(self), "odometry"), _share_text(true, len(self), "truth")
        return f"Log({self.name!r}, {', '.join((count, *shares))})"


def _share_text(count: int, of: int, what: str) -> str:
    if count == 0:
        return f"no {what}"
    return what if count == of else f"{what} for {count}"


def _all_of(values: Iterable[T], name: str, kind: type[T]) -> tuple[T, ...]:
    """Values that are all of one kind."""
    if not arrays.is_iterable(values) or isinstance(values, str):
        raise ValueError(f"{name} must be a list of {kind.__name__}, got {type(values).__name__}")
    members = tuple(values)
    for k, value in enumerate(members):
        if not isinstance(value, kind):
            got = type(value).__name__
            raise ValueError(f"{name}[{k}] must be a {kind.__name__}, got {got}")
    return members


def _frozen_row(values: ArrayLike, name: str, count: int | None = None, dtype: type = float) -> Any:
    """One number a beam, `(n,)`, that nobody can change any more."""
    array = arrays.indices(values, name) if dtype is int else arrays.numbers(values, name)
    if array.ndim != 1 or count not in (None, len(array)):
        wanted = "(n,)" if count is None else f"({count},)"
        raise ValueError(f"{name} must have shape {wanted}, got {array.shape}")
    return _freeze(array, dtype)


def _checked_number(value: object, name: str) -> float:
    array = arrays.numbers(value, name, "a number")
    if array.shape != ():
        raise ValueError(f"{name} must be a number, got shape {array.shape}")
    return float(array)


def _freeze(values: NDArray[Any], dtype: type = float) -> Any:
    array: NDArray[Any] = np.array(values, dtype)
    array.flags.writeable = False
    return array
