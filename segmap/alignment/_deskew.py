"""De-skewing: beams of a laser that turns while the robot moves, carried to the first of each scan.

1. A pose graph of the scans as they are says how the robot moved: its poses lie in mid-scan.
2. The part of the log that turns most is aligned anew as it is, and with its beams carried; in both
   orders of the beams where the file does not know it. The sharpest map tells. Is it the log as it
   is, the robot stood while it measured, or the times of its beams mean nothing.
3. The match of each scan finds the motion within it too, and the odometry tells of one: what is
   sharpest counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .. import arrays
from ..arrays import Array, Poses, checked
from ..poses.motions import between, transform, twist
from ..progress import Progress
from ..scans import LaserScan, Log
from ..scans.causes import Cause, Finding
from ..scans.motion import is_timed, motion_compensated, velocities
from ..scans.pose_argument import checked_poses
from .points import poses_at
from .pose_graph import LiveGraph, Tracking, pose_graph, turn_of

#: Scans that turn by more than this, radians, show how the beams were measured.
TURNING_SCAN_RAD = np.radians(1)
#: Side of the cells in which the entropy of a map is counted, metres.
ENTROPY_CELL_M = 0.05
#: One way to carry the beams is better than another if it lowers the entropy by more, nats.
ENTROPY_MARGIN_NATS = 0.05
#: The ways are compared on so many scans in a row, those that turn most.
PART_SCANS = 100
#: At least so many of them must turn.
LEAST_TURNING_IN_PART = 10
#: Scans lie so many turns apart at most: else the times of the beams are wrong, or scans are left
#: out, and nobody knows how the robot moved meanwhile.
MOST_TURNS_A_SCAN = 2.5
#: Maps are turned by these angles, radians: walls along the cells fill one row of them or two.
OBLIQUE_RAD = (0.4, 0.9, 1.3)


@checked
def deskew(log: Log, poses: Poses | None = None, *, progress: Progress | None = None) -> Log:
    """Carry each beam to the moment of the first one of its scan, where the log has their times.

    A turning laser measures a scan while the robot moves: walls bend, by what it turns meanwhile.
    How it moved is what a pose graph of the log says, the match of each scan, or the odometry. An
    order of the beams that is not known is found, or nothing is changed. Where walls are sharper
    as measured, the robot stood while it measured: the scans stay as they are, as they do where
    scans come several turns apart by the times of their beams.

    Parameters
    ----------
    poses
        Of the scans as they are, by matching: they lie in mid-scan, and the robot moves evenly from
        one to the next. None makes a `pose_graph`, and tries the other two as well.
    progress
        As in `pose_graph`.

    Returns
    -------
    Log
        Without `delays`; the same object where there are none. `causes` says what was found wrong.
        A robot that stood shows only where ten scans turn by more than a degree.

    Examples
    --------
    >>> from segmap.simulation import URG_04LX, drive, simulate, square_room
    >>> path, rng = drive([(1, 1), (3, 1), (3, 2)], step=0.1, turn=0.1), np.random.default_rng(1)
    >>> log = simulate(square_room(), path, sensor=URG_04LX, rng=rng, moving=True)
    >>> log[0].delays.max().round(3), deskew(log)[0].delays
    (np.float64(0.067), None)
    """
    arrays.instance(log, "log", Log)
    user_poses = None if poses is None else checked_poses(log, poses)
    if not is_timed(log):
        return log
    apart = np.diff(log.times)
    if len(log) > 1 and not (apart > 0).any():
        return _keep_as_measured(
            log, 0.0, "the scans have no times, which tell how the robot moved meanwhile"
        )
    usual = float(np.median(apart[apart > 0])) if len(log) > 1 else 0.0
    if (whole := _whole_turn(log)) * MOST_TURNS_A_SCAN < usual:
        words = f"a turn takes {whole:.2g} s by the times of its beams, and scans lie {usual:.2g} s"
        return _keep_as_measured(log, whole, f"{words} apart: these times are not believed")
    rows = pose_graph(log).poses if user_poses is None else user_poses
    motions, causes = np.zeros((len(log), 7)), list(log.causes)
    sees = np.array([scan.valid.any() for scan in log], bool)
    motions[sees, :3] = velocities(log.times[sees], rows[sees])
    part = _turning_part(log, motions)
    logs = [log] if log.order_known else [log, replace(log, scans=tuple(map(_reverse, log)))]
    ways = [_carry(each, motions) for each in logs]
    as_measured = _map_entropy([replace(scan, delays=None) for scan in log[part]])
    unsharp = [_map_entropy([scans[k] for k in part]) for scans in ways]
    best = int(np.argmin(unsharp))
    if len(part) and unsharp[best] >= as_measured + ENTROPY_MARGIN_NATS:
        words = "the robot stood while each scan was measured, or the times of beams are not right"
        return _keep_as_measured(log, unsharp[best] - as_measured, words)
    margin = max(unsharp) - min(unsharp)
    if not (log.order_known or margin >= ENTROPY_MARGIN_NATS):
        words = "nothing tells in which order the beams were measured"
        return replace(log, causes=(*causes, Finding(Cause.BEAM_ORDER, margin, words)))
    if best:
        words = "the beams are in the other order than the file says"
        causes.append(Finding(Cause.BEAM_ORDER, margin, words))
    log, carried = replace(logs[best], order_known=True), ways[best]
    if user_poses is None:
        entropies = {
            motions_of: _map_entropy(_carry(log[part], motions_of(log[part], motions[part])))
            for motions_of in (_matched_motions, _driven_motions)
        }
        sharpest = min(entropies, key=entropies.__getitem__)
        if entropies[sharpest] < unsharp[best]:
            carried = _carry(log, sharpest(log, motions))
    return replace(log, scans=tuple(carried), causes=tuple(causes))


def _matched_motions(log: Log, motions: Array) -> Array:
    """The motions `(k, 7)` that the matches of the scans have found; else those that are given."""
    live = LiveGraph(tracking=Tracking(moving=True))
    live.extend(log)
    rows = [live.tracked(k) for k in range(len(log))]
    pairs = zip(rows, motions, strict=True)
    return np.array([motion if row.as_measured is None else row.motion for row, motion in pairs])


def _driven_motions(log: Log, motions: Array) -> Array:
    """The motions `(k, 7)` that the odometry says, even to the next scan; else those given."""
    apart = np.diff(log.times)
    seconds = np.where(apart > 0, apart, np.nan)
    driven = twist(between(log.odometry[:-1], log.odometry[1:])) / seconds[:, None]
    motions = motions.copy()
    motions[:-1, :3] = np.where(np.isfinite(driven), driven, motions[:-1, :3])
    return motions


def _carry(log: Log, motions: Array) -> list[LaserScan]:
    """The scans, each beam moved by what the robot moved since the first one, by motions `(k, 7)`.

    A motion is that in the middle of the turn.
    """
    scans = list(log)
    for k, (scan, motion) in enumerate(zip(log, motions, strict=True)):
        if scan.delays is not None:
            poses = poses_at(motion, np.r_[0.0, scan.delays] - turn_of(scan) / 2)
            scans[k] = motion_compensated(scan, between(poses[0], poses[1:]))
    return scans


def _whole_turn(log: Log) -> float:
    """How long a whole turn takes by the times of the beams, seconds: the median over the scans."""
    turns = [
        2 * np.pi * np.ptp(scan.delays) / np.ptp(scan.angles)
        for scan in log
        if scan.delays is not None and len(scan) > 1 and np.ptp(scan.angles) > 0
    ]
    return float(np.median(turns)) if turns else float("inf")


def _keep_as_measured(log: Log, value: float, why: str) -> Log:
    """The log with its scans as they were measured, and why."""
    scans = tuple(replace(scan, delays=None) for scan in log)
    finding = Finding(Cause.SKEW, value, f"{why}: no beam is carried")
    return replace(log, scans=scans, order_known=True, causes=(*log.causes, finding))


def _turning_part(log: Log, motions: Array) -> list[int]:
    """The so many scans in a row that turn most, by their index; none where few of them turn."""
    turns = np.abs(motions[:, 2]) * [turn_of(scan) for scan in log]
    ends = np.r_[0.0, np.cumsum(turns)]
    size = min(PART_SCANS, len(log))
    first = int(np.argmax(ends[size:] - ends[: len(ends) - size]))
    part = np.arange(first, first + size)
    return part.tolist() if (turns[part] > TURNING_SCAN_RAD).sum() >= LEAST_TURNING_IN_PART else []


def _map_entropy(scans: Sequence[LaserScan]) -> float:
    """The entropy of the map of scans, by a pose graph of their own, nats; 0 where there is none.

    Poses that were fitted to scans as they are would favour them.
    """
    if not len(scans):
        return 0.0
    poses = pose_graph(Log("part", scans)).poses
    ends = np.concatenate(
        [transform(pose, scan.points()) for pose, scan in zip(poses, scans, strict=True)]
    )
    turned = (transform(np.array([0.0, 0.0, angle]), ends) for angle in OBLIQUE_RAD)
    return float(np.mean([_entropy(points) for points in turned]))


def _reverse(scan: LaserScan) -> LaserScan:
    """The scan with its beams measured in the other order."""
    delays = scan.delays
    return scan if delays is None else replace(scan, delays=delays.max(initial=0.0) - delays)


def _entropy(points: Array) -> float:
    """Of the cells in which points `(n, 2)` lie, nats: sharp walls fill fewer."""
    cells = np.floor(points / ENTROPY_CELL_M).astype(np.int64)
    counts = np.unique(cells @ np.array([1 << 32, 1]), return_counts=True)[1]
    share = counts / counts.sum()
    return float(-(share * np.log(share)).sum())
