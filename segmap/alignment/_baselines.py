"""The two ends of the scale, odometry and ground truth (A 3.3.3), and errors against the truth."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, Seconds, at_least, at_most, checked
from ..poses import between, compose, interpolate, inverse, transform
from ..scans import Log
from ..scans.causes import Unmatched
from ._result import Outcome, Trail, alignment_method
from .pose_graph import poses_compared


@alignment_method
def odometry(log: Log) -> Outcome:
    """The poses that the odometry reports: the baseline that every other method has to beat.

    A scan without odometry repeats the last motion, and counts as not used.

    Examples
    --------
    >>> from segmap import load
    >>> odometry(load("malaga"))
    Alignment(odometry: 225 scans, 225 used)
    """
    poses = log.odometry
    return _known_poses(log, poses, np.asarray(np.isfinite(poses).all(1)), Unmatched.NO_ODOMETRY)


def usual_method(log: Log) -> str:
    """The truth where the log has it for each scan, which costs no time; else a pose graph.

    Examples
    --------
    >>> from segmap import load
    >>> usual_method(load("room")), usual_method(load("malaga"))
    ('ground_truth', 'pose_graph')
    """
    arrays.instance(log, "log", Log)
    whole = log.truth is not None and bool(np.isfinite(log.truth).all())
    return "ground_truth" if whole else "pose_graph"


@alignment_method
def ground_truth(
    log: Log,
    *,
    times: ArrayLike | None = None,
    poses: ArrayLike | None = None,
    max_gap: Annotated[Seconds, at_least(0), at_most(np.inf)] = np.inf,
    missing: Literal["raise", "drop"] = "raise",
) -> Outcome:
    """True pose of each scan: its own row of the log's truth, or a track's at its time (A 3.3.3).

    A track is poses known at other times. Between two of them the pose at the time of a scan is
    interpolated; so is that of a scan without a row of its own, between the scans before and after
    it that have one. The times of scans that have one do not matter.
    Linear in x and y, by the shorter way round in heading.

    Parameters
    ----------
    times : (n,) array, seconds, not decreasing, and poses : (n, 3) array, metres and radians
        A track, as `read_trajectory` returns it; without one the truth in the log itself.
    max_gap
        Between two poses farther apart than this nothing is known.
    missing
        What to do with a scan at whose time nothing is known.

    Returns
    -------
    Alignment
        A dropped scan is not used; its pose carries the odometry on. Its causes say where matches
        between neighbours and at revisits contradict the poses, and where none confirms them.

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
    if len(log) == 0:
        return Outcome([])
    if (times is None) != (poses is None):
        raise ValueError("times and poses belong together: give both, or neither")
    if times is not None and poses is not None:
        t, track = arrays.numbers(times, "times"), arrays.poses(poses)
        truth = interpolate(t, track, log.times, max_gap=max_gap)
        source = f"that goes from {t[0]:.6f} to {t[-1]:.6f} s"
    elif log.truth is None or not np.isfinite(log.truth).all(1).any():
        raise ValueError(f"log {log.name!r} holds no ground truth: give times and poses")
    else:
        truth = _fill_gaps(log.truth, log.times, max_gap)
        source = "the scans before and after it with one must have times around its own"
    has_truth = np.asarray(np.isfinite(truth).all(1))
    if missing == "raise" and not has_truth.all():
        scan = int(np.argmin(has_truth))
        raise ValueError(
            f"scan {scan} of log {log.name!r}, at {log.times[scan]:.6f} s, has no ground truth: "
            f"{source}, with gaps of at most {max_gap:.6g} s allowed; "
            'missing="drop" leaves such scans out'
        )
    if has_truth.any() and not has_truth[0]:  # from the first known pose back, by the odometry
        first = int(np.argmax(has_truth))
        back = between(log.odometry[first], log.odometry[0])
        truth[0] = compose(truth[first], back) if np.isfinite(back).all() else truth[first]
    laid = _known_poses(log, truth, has_truth, Unmatched.NO_TRUTH).laid
    return Outcome(laid, appraise=partial(poses_compared, log, truth, has_truth))


def _known_poses(log: Log, poses: Array, placed: NDArray[np.bool_], missing: Unmatched) -> Outcome:
    """Poses `(k, 3)`, metres and radians, where they are known; elsewhere the odometry goes on."""
    first = poses[0] if len(log) and np.isfinite(poses[0]).all() else None
    trail = Trail(log, first, Unmatched.NONE if placed.all() or placed[0] else missing)
    for pose, is_known in zip(poses[1:], placed[1:], strict=True):
        trail.place(pose) if is_known else trail.carry(missing)
    return Outcome(trail.laid)


def _fill_gaps(truth: Array, times: Array, max_gap: float) -> Array:
    """The rows of a truth; those of NaN between the rows before and after, in the order of scans.

    Only where its time, in seconds, lies between theirs, which are at most `max_gap` apart.
    """
    filled, rows = truth.copy(), np.flatnonzero(np.isfinite(truth).all(1))
    filled[~np.isfinite(truth).all(1)] = np.nan
    for k in np.setdiff1d(np.arange(rows[0], rows[-1]), rows):
        around = rows[np.searchsorted(rows, k) + np.array([-1, 0])]
        if times[around[0]] <= times[k] <= times[around[1]]:
            filled[k] = interpolate(times[around], truth[around], times[[k]], max_gap=max_gap)[0]
    return filled


@checked
def align_to_truth(poses: ArrayLike, truth: ArrayLike, *, best: bool = False) -> Array:
    """Move all poses by one motion to where they can be compared with the true ones.

    A method does not know where its first pose lies in the world of the truth: what it found is
    right or wrong only up to one motion of the whole.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians
        Rows of NaN have no pose.
    truth : (k, 3) array, metres and radians
        Rows of NaN are not known.
    best
        False puts the first pose whose truth is known on that one, position and heading. True takes
        the motion that makes the squared distances of all known positions least (Umeyama 1991).

    Raises
    ------
    ValueError
        Where no scan has both.

    Examples
    --------
    >>> poses = align_to_truth([(0, 0, 0), (1, 0, 0)], [(5, 5, np.pi / 2), (5, 6.5, np.pi / 2)])
    >>> poses[:, :2].round(6)
    array([[5., 5.],
           [5., 6.]])
    """
    p = arrays.poses(poses, missing=True)
    q = arrays.poses(truth, "truth", count=len(p), missing=True)
    both = np.isfinite(p).all(1) & np.isfinite(q).all(1)
    if not both.any():
        raise ValueError("poses and truth must share a scan where both are known, got none")
    first = np.flatnonzero(both)[0]
    if not best:
        return compose(compose(q[first], inverse(p[first])), p)
    p_middle, q_middle = p[both, :2].mean(0), q[both, :2].mean(0)
    a, b = p[both, :2] - p_middle, q[both, :2] - q_middle
    turn = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum())
    return compose((*(q_middle - transform((0.0, 0.0, turn), p_middle)), turn), p)


@checked
def position_errors(poses: ArrayLike, truth: ArrayLike, *, best: bool = False) -> Array:
    """Distances between found and true positions, where both are known, after `align_to_truth`.

    Returns
    -------
    (m,) array, metres
        For the m <= k scans where both are known, in their order.

    Examples
    --------
    >>> truth = [(0, 0, 0), (1, 0, 0), (np.nan, np.nan, np.nan), (3, 0, 0)]
    >>> position_errors([(2, 2, 0), (3, 2, 0), (4, 2, 0), (5, 2.1, 0)], truth).round(6)
    array([0. , 0. , 0.1])
    """
    true = arrays.poses(truth, "truth", missing=True)
    away = (align_to_truth(poses, true, best=best) - true)[:, :2]
    far: Array = np.hypot(away[:, 0], away[:, 1])
    return far[np.isfinite(far)]
