"""The runner of all alignment methods, and the trail of poses that most of them lay."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Sequence
from functools import wraps
from typing import NamedTuple, ParamSpec

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..extraction import extract_polylines
from ..poses import between, compose
from ..scans import LaserScan, Log
from ..segments import length
from ._graph import Graph
from ._result import Alignment

P = ParamSpec("P")


class Outcome(NamedTuple):
    """What a method hands to the runner.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians
    reasons : sequence of k str
        Why a scan was not used; empty where it was.
    graph, doubt
        As in `Alignment`.
    """

    poses: ArrayLike
    reasons: Sequence[str]
    graph: Graph | None = None
    doubt: str = ""


def alignment_method(method: Callable[P, Outcome]) -> Callable[P, Alignment]:
    """Make a function of a log a method of the family: each call is timed and its result checked.

    Parameters
    ----------
    method : callable
        `method(log, *, thresholds) -> Outcome`; its name becomes that of the alignment.

    Returns
    -------
    callable
        `method(log, *, thresholds) -> Alignment`. It raises ValueError where the log is no Log, and
        RuntimeError where the method gave not one finite pose and one reason for each scan.
    """
    name = method.__name__

    @wraps(method)
    def run(*args: P.args, **kwargs: P.kwargs) -> Alignment:
        log = args[0] if args else kwargs.get("log")
        if not isinstance(log, Log):
            raise ValueError(f"log must be a Log, got {type(log).__name__}")
        begun = time.perf_counter()
        found = method(*args, **kwargs)
        seconds = time.perf_counter() - begun
        poses, reasons = np.array(found.poses, float).reshape(-1, 3), tuple(found.reasons)
        if len(poses) != len(log) or len(reasons) != len(log) or not np.isfinite(poses).all():
            raise RuntimeError(f"{name} must give a finite pose and a reason for each scan")
        used = np.array([not reason for reason in reasons], bool)
        return Alignment(poses, used, seconds, name, reasons, found.graph, found.doubt)

    signature = inspect.signature(method).replace(return_annotation="Alignment")
    run.__signature__ = signature  # type: ignore[attr-defined]
    return run


class Trail:
    """The poses laid so far, scan by scan, and the guess of the next one.

    The order of recording counts and no time: scans with equal or exchanged times give the same
    poses. The guess is the last pose and the odometry step; where the log holds no odometry for one
    of the two scans, the robot is assumed to repeat its last motion (constant velocity).

    Parameters
    ----------
    log : Log
    first : (3,) array, metres and radians, or None
        Pose of the first scan; None takes its odometry, or the origin where it has none.
    reason : str
        Why the first scan is not used, if it is not.
    """

    def __init__(self, log: Log, first: Array | None = None, reason: str = "") -> None:
        odometry = log.odometry
        self.steps = between(odometry[:-1], odometry[1:])
        if first is None and len(log):
            first = odometry[0]
        start = first if first is not None and np.isfinite(first).all() else np.zeros(3)
        self.poses: list[Array] = [start][: len(log)]
        self.reasons: list[str] = [reason][: len(log)]

    def guess(self) -> Array:
        """Expected pose of the next scan, (3,) array, metres and radians."""
        return compose(self.poses[-1], self.step())

    def step(self) -> Array:
        """Expected motion to the next scan, (3,) array, metres and radians."""
        step = self.steps[len(self.poses) - 1]
        if np.isfinite(step).all():
            return step
        return between(self.poses[-2], self.poses[-1]) if len(self.poses) > 1 else np.zeros(3)

    def place(self, pose: ArrayLike, reason: str = "") -> None:
        """Append the pose of the next scan, (3,) array, metres and radians.

        The reason tells why that pose does not count as used, if it does not.
        """
        self.poses.append(np.asarray(pose, float))
        self.reasons.append(reason)

    def carry(self, reason: str) -> None:
        """Append the guess: the next scan could not be matched, for this reason."""
        self.place(self.guess(), reason)

    def outcome(self, graph: Graph | None = None, doubt: str = "") -> Outcome:
        """All poses and reasons, for the runner."""
        return Outcome(np.reshape(self.poses, (-1, 3)), self.reasons, graph, doubt)


def long_segments(scan: LaserScan, min_length: float) -> Array:
    """Segments of a scan that are at least `min_length` metres long, `(n, 2, 2)`, robot frame."""
    found = extract_polylines(scan.points())
    return found[length(found) >= min_length]
