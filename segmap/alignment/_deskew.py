"""De-skewing: beams of a laser that turns while the robot moves, carried to the first of each scan.

1. A pose graph of the scans as they are says how the robot moved: its poses lie in mid-scan.
2. Of two orders of the beams that one holds which makes the walls of all scans that turn sharper.
3. A part of the log is aligned twice, with its beams carried and as it is. If it is sharper as it
   is, the robot stood while it measured, or the times of its beams mean nothing.
4. Odometry that comes more often than scans says it better, once its clock is found.
5. Without these the match of each scan finds the motion within it, where that makes a part of the
   log sharper. Each beam moves by what the robot moved since the first one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Poses, checked
from ..poses import interpolate
from ..poses.motions import arc, between, transform, wrap
from ..progress import Progress
from ..scans import LaserScan, Log
from ..scans.causes import Cause, Finding
from ..scans.motion import LONGEST_GAP_S, is_timed, motion_compensated, velocities
from ..scans.pose_argument import checked_poses
from .points import way
from .pose_graph import LiveGraph, Tracking, pose_graph

#: Scans that turn by more than this, radians, show the order of the beams.
TURNING_SCAN_RAD = np.radians(1)
#: So many such scans are needed.
LEAST_TURNING_SCANS = 20
#: Side of the cells in which the entropy of a map is counted, metres.
ENTROPY_CELL_M = 0.05
#: One order of the beams is better than the other if it lowers the entropy by more, nats.
ENTROPY_MARGIN_NATS = 0.05
#: Whether the robot stood is told by so many scans in a row, those that turn most.
PART_SCANS = 100
#: At least so many of them must turn.
LEAST_TURNING_IN_PART = 10
#: Scans lie so many turns apart at most: else the times of the beams are wrong, or scans are left
#: out, and nobody knows how the robot moved meanwhile.
MOST_TURNS_A_SCAN = 2.5
#: Maps are turned by these angles, radians: walls along the cells fill one row of them or two.
OBLIQUE_RAD = (0.4, 0.9, 1.3)
#: Clocks are tried up to this far apart, seconds.
CLOCK_SHIFT_S = 0.5
#: Step from one clock that is tried to the next, seconds.
CLOCK_STEP_S = 0.005
#: The clocks of both halves of a log may differ by this, seconds.
CLOCK_AGREEMENT_S = 0.02


@checked
def deskew(log: Log, poses: Poses | None = None, *, progress: Progress | None = None) -> Log:
    """Carry each beam to the moment of the first one of its scan, where the log has their times.

    A turning laser measures a scan while the robot moves: walls bend, by what it turns meanwhile.
    How it moved is what a pose graph of the log says, or the `track` of its odometry where that
    agrees in time. An order of the beams that is not known is found, or nothing is changed. Where
    walls are sharper as measured, the robot stood while it measured: the scans stay as they are,
    as they do where scans come several turns apart by the times of their beams.

    Parameters
    ----------
    poses
        Of the scans as they are, by matching: they lie in mid-scan, and the robot moves evenly from
        one to the next. None makes a `pose_graph`, and tries the motion within each scan too.
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
    motions, causes = velocities(log.times, rows), list(log.causes)
    margin = -np.inf if log.order_known else _margin(log, rows, motions)
    ordered = replace(log, scans=tuple(map(_reverse, log.scans))) if margin > 0 else log
    if (blurred := _blur(ordered, motions)) >= ENTROPY_MARGIN_NATS:
        words = "the robot stood while each scan was measured, or the times of beams are not right"
        return _keep_as_measured(log, blurred, words)
    if not abs(margin) >= ENTROPY_MARGIN_NATS:
        words = "nothing tells in which order the beams were measured"
        return replace(log, causes=(*causes, Finding(Cause.BEAM_ORDER, margin, words)))
    if margin > 0:
        log = replace(ordered, order_known=True)
        words = "the beams are in the other order than the file says"
        causes.append(Finding(Cause.BEAM_ORDER, margin, words))
    turns = [s.delays.max() for s in log if s.delays is not None and len(s)]
    turn = float(np.median(turns)) if turns else 0.0
    offset = _clock(log, rows) - turn / 2  # NaN where it is not found
    if abs(offset) > turn / 2:
        words = f"scans and odometry differ by {abs(offset):.2f} s"
        causes.append(Finding(Cause.DELAY, offset, words))
    even = [arc(motion * _delays(scan)) for scan, motion in zip(log, motions, strict=True)]
    if np.isfinite(offset) and log.track is not None:
        even = [
            _follow(log.track, scan, offset, steps) for scan, steps in zip(log, even, strict=True)
        ]
    carried = _carry(log, even)
    if user_poses is None and not np.isfinite(offset):
        part = _turning_part(log, motions).tolist()
        own = _carry_by_own_motion(log[part], [even[k] for k in part])
        ways = (own, [carried[k] for k in part])
        by_own, by_neighbours = (_unsharp(Log(log.name, scans)) for scans in ways)
        if by_own < by_neighbours:
            carried = _carry_by_own_motion(log, even)
    return replace(log, scans=tuple(carried), causes=tuple(causes))


def _delays(scan: LaserScan) -> Array:
    """Seconds from the first beam of a scan to each, `(n, 1)`; 0 where it has none."""
    return np.zeros((len(scan), 1)) if scan.delays is None else scan.delays[:, None]


def _follow(track: Array, scan: LaserScan, offset: float, steps: Array) -> Array:
    """Where odometry that comes more often says that the robot was at each beam; else `steps`."""
    at = scan.time + offset + np.r_[0.0, _delays(scan)[:, 0]]
    driven = interpolate(track[:, 0], track[:, 1:], at, max_gap=LONGEST_GAP_S)
    return between(driven[0], driven[1:]) if np.isfinite(driven).all() else steps


def _carry_by_own_motion(log: Log, steps: list[Array]) -> list[LaserScan]:
    """The scans, carried by the motion that the match of each has found; else by `steps`."""
    live = LiveGraph(tracking=Tracking(moving=True))
    live.extend(log)
    own = []
    for k, by_neighbours in enumerate(steps):
        motion, scan = live.tracked(k).motion, live.tracked(k).as_measured
        if scan is None or scan.delays is None:
            own.append(by_neighbours)
        else:
            on_the_way = way(motion, np.r_[0.0, scan.delays] - scan.delays.max() / 2)
            own.append(between(on_the_way[0], on_the_way[1:]))
    return _carry(log, own)


def _carry(log: Log, steps: list[Array]) -> list[LaserScan]:
    """The scans, each beam moved by what the robot moved since the first one."""
    return [
        scan if scan.delays is None else motion_compensated(scan, since)
        for scan, since in zip(log, steps, strict=True)
    ]


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


def _turning_part(log: Log, motions: Array) -> NDArray[np.int64]:
    """The so many scans in a row that turn most, by their index."""
    turns = np.array([_delays(scan).max(initial=0.0) for scan in log]) * np.abs(motions[:, 2])
    ends = np.r_[0.0, np.cumsum(turns)]
    size = min(PART_SCANS, len(log))
    first = int(np.argmax(ends[size:] - ends[: len(ends) - size]))
    return np.arange(first, first + size)


def _blur(log: Log, motions: Array) -> float:
    """How much less sharp a part of the log is with its beams carried, nats; NaN for too few turns.

    Poses that were fitted to scans as they are would favour them, so both are aligned anew.
    """
    part = _turning_part(log, motions)
    turns = [abs(motions[k, 2]) * _delays(log[k]).max(initial=0.0) for k in part.tolist()]
    if (np.array(turns) > TURNING_SCAN_RAD).sum() < LEAST_TURNING_IN_PART:
        return float("nan")
    even = [arc(motions[k] * _delays(log[k])) for k in part.tolist()]
    as_measured = [replace(scan, delays=None) for scan in log[part]]
    ways = (_carry(log[part], even), as_measured)
    new, old = (_unsharp(Log(log.name, scans)) for scans in ways)
    return new - old


def _unsharp(log: Log) -> float:
    """The entropy of the map of a log, by its own pose graph, nats."""
    poses = pose_graph(log).poses
    ends = np.concatenate(
        [transform(pose, scan.points()) for pose, scan in zip(poses, log, strict=True)]
    )
    turned = (transform(np.array([0.0, 0.0, angle]), ends) for angle in OBLIQUE_RAD)
    return float(np.mean([_entropy(points) for points in turned]))


def _reverse(scan: LaserScan) -> LaserScan:
    """The scan with its beams measured in the other order."""
    delays = scan.delays
    return scan if delays is None else replace(scan, delays=delays.max(initial=0.0) - delays)


def _margin(log: Log, poses: Array, motions: Array) -> float:
    """How much sharper the walls are with the beams in the other order, nats; NaN for too few.

    Poses `(k, 3)` lie in mid-scan, so both orders are carried there: either errs as much.
    """
    clouds: tuple[list[Array], list[Array]] = ([], [])
    for scan, pose, motion in zip(log, poses, motions, strict=True):
        if scan.delays is None or not len(scan) or not np.isfinite(pose).all():
            continue
        middle = scan.delays - scan.delays.max() / 2
        if 2 * abs(motion[2]) * middle.max() > TURNING_SCAN_RAD:
            for points, since in zip(clouds, (middle, -middle), strict=True):
                steps = arc(motion * since[:, None])
                points.append(transform(pose, motion_compensated(scan, steps).points()))
    if len(clouds[0]) < LEAST_TURNING_SCANS:
        return float("nan")
    stated, other = (_entropy(np.concatenate(points)) for points in clouds)
    return stated - other


def _entropy(points: Array) -> float:
    """Of the cells in which points `(n, 2)` lie, nats: sharp walls fill fewer."""
    cells = np.floor(points / ENTROPY_CELL_M).astype(np.int64)
    counts = np.unique(cells @ np.array([1 << 32, 1]), return_counts=True)[1]
    share = counts / counts.sum()
    return float(-(share * np.log(share)).sum())


def _clock(log: Log, poses: Array) -> float:
    """How much later than the scans the odometry shows the turns of poses `(k, 3)`, seconds.

    NaN where it has no track, or where the two halves of the log do not agree.
    """
    if log.track is None or not len(log.track):
        return float("nan")
    times, heading = log.track[:, 0], np.unwrap(log.track[:, 3])
    shifts = np.arange(-CLOCK_SHIFT_S, CLOCK_SHIFT_S + CLOCK_STEP_S / 2, CLOCK_STEP_S)
    at = log.times + shifts[:, None]
    seen = np.diff(np.interp(at, times, heading, left=np.nan, right=np.nan), axis=1)
    errors = wrap(seen - np.diff(poses[:, 2])) ** 2
    valid = np.isfinite(errors).all(0)  # at any shift
    errors = errors[:, valid & (np.diff(log.times) > 0) & (np.diff(log.times) <= LONGEST_GAP_S)]
    half = errors.shape[1] // 2
    if not half:
        return float("nan")
    first, second, both = (
        int(np.argmin(part.mean(1))) for part in (errors[:, :half], errors[:, half:], errors)
    )
    is_inside = 0 < both < len(shifts) - 1
    return (
        float(shifts[both])
        if is_inside and abs(first - second) * CLOCK_STEP_S <= CLOCK_AGREEMENT_S
        else np.nan
    )
