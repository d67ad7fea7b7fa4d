"""After a gap the odometry confirms nothing: the whole map is asked where the scan lies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses.motions import between, compose, wrap
from ...scans.causes import Cause, Finding, Unmatched
from ..points import in_range
from ._key_frames import KeyFrames
from ._loop_closing import LOST_WINDOW_M, LoopClosing

if TYPE_CHECKING:
    from ._front_end import TrackedScan

#: No scan for so many times as long as between nearly all of them, and for so long, seconds, is a
#: pause.
PAUSE_RATIO = 5.0
LEAST_PAUSE_S = 1.0
#: This share of the steps counts as nearly all of them.
USUAL_STEP_QUANTILE = 0.95
#: A place farther away than this, metres, is another one.
OTHER_PLACE_M = 0.5
#: A place turned by more than this, radians, is another one.
OTHER_PLACE_RAD = np.radians(15)


def doubtful_gaps(rows: Sequence[TrackedScan], frames: KeyFrames) -> list[Finding]:
    """Scans behind a gap that lie nowhere on the map before it, or better elsewhere.

    A gap is a pause, or where an odometry ends that says how the robot came to the scans before.
    One over which the odometry leads to another place, and a match to the same, is confirmed: a
    robot that is lifted does not turn its wheels.
    """
    times = np.array([row.scan.time for row in rows])
    since = np.diff(times, prepend=times[:1])
    odometry = np.reshape([row.odometry for row in rows], (-1, 3))
    wheels = np.vstack([np.full(3, np.nan), between(odometry[:-1], odometry[1:])])[: len(rows)]
    measured = np.asarray(np.isfinite(wheels).all(1))
    gap = np.r_[False, measured[:-1] & ~measured[1:]][: len(rows)]
    if np.isfinite(since).all() and len(since):
        usual = float(np.quantile(since, USUAL_STEP_QUANTILE))
        gap |= since > max(PAUSE_RATIO * usual, LEAST_PAUSE_S)
    led = np.array([row.used for row in rows], bool) & elsewhere(wheels)
    asked = (_ask_map(rows, frames, scan) for scan in np.flatnonzero(gap & ~led).tolist())
    return [finding for finding in asked if finding is not None]


def _ask_map(rows: Sequence[TrackedScan], frames: KeyFrames, gap: int) -> Finding | None:
    """What the map of the scans before a gap says of the first one behind it that sees enough."""
    blind = Unmatched.TOO_LITTLE_SEEN
    scan = next((k for k in range(gap, len(rows)) if rows[k].unmatched is not blind), None)
    before = int(np.searchsorted(frames.scans, gap))
    if scan is None or not before:
        return None
    where = "nowhere on the map before"
    if rows[scan].used:
        place = _better_place(rows[scan], frames, before)
        if place is None:
            return None
        where = f"better at ({place[0]:.1f}, {place[1]:.1f}) m than where it was laid"
    words = f"scan {scan}, before which nothing was measured for a while, lies {where}"
    why = "the robot was lifted, or is on another floor, or scans are missing"
    return Finding(Cause.LIFTED, scan, f"{words}: {why}")


def _better_place(row: TrackedScan, frames: KeyFrames, before: int) -> Array | None:
    """Another place, (3,), on which more of a scan lies than on its own; of key frames `before`.

    Its own is asked first: others count that are more likely.
    """
    points, own = in_range(row.scan.points()), compose(frames.poses[row.frame], row.pose)
    most, best, around = row.overlap, None, LoopClosing.old_frames
    least, asked = LoopClosing.likelihood, np.zeros((0, 3))
    away = np.hypot(*(frames.poses[:before] - own).T[:2])
    for k in np.argsort(away, kind="stable").tolist():  # its own place first
        centre = frames.poses[k]
        if (np.hypot(*(asked - centre).T[:2]) < LOST_WINDOW_M).any():
            continue
        asked = np.vstack([asked, centre])
        map = frames.map_of(range(max(k - around, 0), min(k + around + 1, before)), k)
        if map is None:
            continue
        start, score = map.search(
            points, np.zeros(3), reach=LOST_WINDOW_M, turn=np.pi, reach_cost=0.0, least=least
        )
        if start is None:
            continue
        least = max(least, score)
        match = map.register(points, start)
        place = compose(centre, match.pose)
        if match.matched and elsewhere(between(own, place)) and match.overlap > most:
            most, best = match.overlap, place
    return best


def elsewhere(motion: Array) -> NDArray[np.bool_]:
    """Whether motions `(..., 3)` lead to another place; not where they are NaN."""
    far = np.hypot(motion[..., 0], motion[..., 1]) > OTHER_PLACE_M
    return np.asarray(far | (np.abs(wrap(motion[..., 2])) > OTHER_PLACE_RAD))
