"""The two ends of the scale: what the wheels say, and what is known to be true (A 3.3.3)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..poses import between, compose, interpolate
from ..scans import Log
from ._result import Alignment, Trail


def odometry(log: Log) -> Alignment:
    """The poses that the wheels report: the baseline that every other method has to beat.

    Parameters
    ----------
    log : Log

    Returns
    -------
    Alignment
        Poses, (k, 3) array, metres and radians, as the log holds them. A scan without odometry
        moves on as the robot did last, and counts as not used.

    Examples
    --------
    >>> from segmap import load
    >>> odometry(load("malaga"))
    Alignment(odometry: 225 scans, 225 used)
    """
    trail = Trail(log)
    if len(log) and log[0].odometry is None:
        trail.reasons[0] = "no odometry"
    for pose in log.odometry[1:]:
        if np.isfinite(pose).all():
            trail.place(pose)
        else:
            trail.carry("no odometry")
    return trail.alignment("odometry")


def ground_truth(
    log: Log,
    *,
    times: ArrayLike | None = None,
    poses: ArrayLike | None = None,
    max_gap: float = np.inf,
    missing: str = "raise",
) -> Alignment:
    """Poses interpolated at the time of each scan from poses known at other times (A 3.3.3).

    Linear in x and y, by the shorter way round in heading.

    Parameters
    ----------
    log : Log
    times : (n,) array, seconds, not decreasing, and poses : (n, 3) array, metres and radians
        What is known, as `read_trajectory` returns it; without them what the log itself holds.
    max_gap : float, seconds
        Between two poses farther apart than this nothing is known.
    missing : "raise" or "drop"
        What becomes of a scan of which nothing is known.

    Returns
    -------
    Alignment
        A dropped scan is not used; its pose carries the odometry on.

    Raises
    ------
    ValueError
        Where a scan lies outside what is known or in a gap, naming it; where nothing is known.

    Examples
    --------
    >>> from segmap import load
    >>> ground_truth(load("malaga"), missing="drop")
    Alignment(ground_truth: 225 scans, 224 used)
    """
    if missing not in ("raise", "drop"):
        raise ValueError(f'missing must be "raise" or "drop", got {missing!r}')
    if len(log) == 0:
        return Trail(log).alignment("ground_truth")
    known_times, known_poses = _known(log, times, poses)
    found = interpolate(known_times, known_poses, log.times, max_gap=max_gap)
    known = np.asarray(np.isfinite(found).all(1))
    if missing == "raise" and not known.all():
        raise ValueError(_where_missing(log, int(np.argmin(known)), known_times, max_gap))
    trail = Trail(log, _first(log, found, known))
    for scan in range(len(log)):
        reason = "" if known[scan] else "no ground truth at its time"
        if scan == 0:
            trail.reasons[0] = reason
        elif known[scan]:
            trail.place(found[scan])
        else:
            trail.carry(reason)
    return trail.alignment("ground_truth")


def _known(log: Log, times: ArrayLike | None, poses: ArrayLike | None) -> tuple[Array, Array]:
    """Times `(n,)` and poses `(n, 3)` that are known, in the order of time."""
    if (times is None) != (poses is None):
        raise ValueError("times and poses belong together: give both, or neither")
    if times is not None and poses is not None:
        return np.asarray(times, float), np.asarray(poses, float)
    if log.truth is None or not np.isfinite(log.truth).all(1).any():
        raise ValueError(f"log {log.name!r} holds no ground truth: give times and poses")
    known = np.flatnonzero(np.isfinite(log.truth).all(1))
    known = known[np.argsort(log.times[known], kind="stable")]
    return log.times[known], log.truth[known]


def _first(log: Log, found: Array, known: NDArray[np.bool_]) -> Array | None:
    """Pose of the first scan: its own, or the odometry's way back from the first that is known."""
    if not known.any():
        return None
    first = int(np.argmax(known))
    back = between(log.odometry[first], log.odometry[0])
    return compose(found[first], back) if first and np.isfinite(back).all() else found[first]


def _where_missing(log: Log, scan: int, times: Array, max_gap: float) -> str:
    return (
        f"scan {scan} of log {log.name!r}, at {log.times[scan]:.6f} s, has no ground truth: that "
        f"goes from {times[0]:.6f} to {times[-1]:.6f} s, with gaps of at most {max_gap:.6g} s "
        'allowed; missing="drop" leaves such scans out'
    )
