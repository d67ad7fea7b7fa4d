"""Odometry against other knowledge of the same motions: its unit, direction, delay, jumps.

Motions on the plane are complex numbers here, x + iy: their quotient is a scale and a turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..display import plural
from ..poses.motions import between
from . import LaserScan
from .causes import Cause, Finding

#: Matched turns that are compared are larger than this; straight steps turn by less.
COMPARED_TURN_RAD = np.radians(4)
#: Straight steps that are compared are longer than this.
COMPARED_STRAIGHT_M = 0.1
#: Below so many turns, or straight steps, nothing is said.
LEAST_COMPARED_STEPS = 12
#: Turns that fit worse than this count for less (Cauchy).
TURN_ERROR_RAD = np.radians(10)
#: A match that moves by less is one of a robot that stands, metres: the noise of a match.
STEP_STANDS_M = 0.03
#: A match that turns by less is one of a robot that stands, radians: the noise of a match.
STEP_STANDS_RAD = np.radians(0.6)
#: Rounds of a robust fit: it rests after five to ten.
ROBUST_FIT_ROUNDS = 15
#: Where this share of all turns goes one way, a drift of the heading looks like a place aside.
ONE_WAY = 0.6
#: What one step counts at most for a delay: radians, or half of the metres.
MOST_OFF = 0.5
#: Poses are taken after so much way, metres.
LONG_STEP_M = 0.3
#: Poses are also taken after so much turn, radians.
LONG_STEP_RAD = np.radians(10)
#: Each is compared with the one so many later: over one step an odometry is late now and then.
COMPARED_AFTER = 3
#: Shares of the way that say nothing against wheels.
RIGHT_WAY_RATIOS = (0.93, 1.07)
#: Factors of turns that may be noise.
RIGHT_TURN_RATIOS = (0.7, 1.4)
#: Below this agreement straight steps contradict each other.
CONTRADICTING_COSINE = 0.6
#: A step so many times as long as nearly all others is one that no robot drives.
JUMP_STEPS = 4.0
#: This share of the steps counts as nearly all of them.
USUAL_STEPS_SHARE = 0.95
#: Rows of odometry repeat each other where they move by less, metres.
REPEATS_M = 1e-4
#: Rows of odometry repeat each other where they turn by less, radians.
REPEATS_RAD = 1e-5
#: Residuals of the lever arm that a match has at least.
LEAST_ERROR_M = 0.003


class Steps(NamedTuple):
    """Matched motions: from scan `first` to scan `second`, whose pose in the first is `motion`."""

    first: NDArray[np.int64]  # (m,)
    second: NDArray[np.int64]  # (m,)
    motion: Array  # (m, 3), metres and radians


@dataclass(frozen=True)
class OdometryComparison:
    """Odometry against matches: all figures are near those of a right log, 1, 1, 0, 0, (0, 0), 0.

    Parameters
    ----------
    turn
        Slope of matched turns on those of the odometry; NaN for less than 12 turns.
    way
        Median of the matched length of a straight step, as a share of the odometry's.
    direction : radians
        From the direction of a straight step by the odometry to the matched one: 0 where the laser
        looks ahead.
    agreement
        How much straight steps agree in that direction, 0 to 1.
    lever : (2,) array, metres
        Place of the laser on the robot, in the frame that the log gives it; NaN where turns do not
        tell; y also where nearly all go one way.
    still
        Share of the odometry's steps of more than 0.1 m at which the match stands.
    """

    turn: float
    way: float
    direction: float
    agreement: float
    lever: Array
    still: float

    @property
    def turns_agree(self) -> bool:
        """Whether nothing speaks against the turns."""
        return np.isnan(self.turn) or RIGHT_TURN_RATIOS[0] < self.turn < RIGHT_TURN_RATIOS[1]


def odometry_against_steps(odometry: Array, steps: Steps) -> OdometryComparison:
    """Odometry `(k, 3)`, metres and radians, against matched steps."""
    wheels = between(odometry[steps.first], odometry[steps.second])
    usable = np.isfinite(wheels).all(1)
    steps = Steps(steps.first[usable], steps.second[usable], steps.motion[usable])
    wheels = wheels[usable]
    way, moved = (m[:, 0] + 1j * m[:, 1] for m in (wheels, steps.motion))
    turned = np.abs(steps.motion[:, 2])
    straight = (np.abs(moved) > COMPARED_STRAIGHT_M) & (turned < COMPARED_TURN_RAD)
    ratio = moved[straight] / np.where(way == 0, 1e-12, way)[straight]
    mean = np.mean(ratio / np.abs(ratio)) if len(ratio) >= LEAST_COMPARED_STEPS else complex(np.nan)
    drives = np.abs(way) > COMPARED_STRAIGHT_M
    stands = drives & (np.abs(moved) < STEP_STANDS_M) & (turned < STEP_STANDS_RAD)
    return OdometryComparison(
        _slope(wheels[:, 2], steps.motion[:, 2]),
        float(np.median(np.abs(ratio))) if len(ratio) >= LEAST_COMPARED_STEPS else float("nan"),
        float(np.angle(mean)),
        float(np.abs(mean)),
        _lever(way, moved, wheels[:, 2]),
        float(stands.sum() / max(drives.sum(), LEAST_COMPARED_STEPS)),
    )


def _slope(wheels: Array, matched: Array) -> float:
    """Of the axis through turns `(wheels, matched)`, radians: both err, so none is the base."""
    turning = np.maximum(np.abs(wheels), np.abs(matched)) > COMPARED_TURN_RAD
    turns = np.stack([wheels, matched])[:, turning]
    if turns.shape[1] < LEAST_COMPARED_STEPS:
        return float("nan")
    size = weight = np.hypot(*turns)
    for _ in range(ROBUST_FIT_ROUNDS):
        axis = np.linalg.eigh((weight * turns) @ turns.T)[1][:, 1]
        off = axis[0] * turns[1] - axis[1] * turns[0]
        weight = size / (1 + (off / TURN_ERROR_RAD) ** 2)
    return float(axis[1] / axis[0]) if abs(axis[0]) > 1e-9 else float("inf")


def _lever(way: NDArray[np.complex128], moved: NDArray[np.complex128], turn: Array) -> Array:
    """Where on the robot the point lies that moved so, (2,) array, metres; NaN where unknown.

    With the robot's motion `way`, and c for scale and direction of the laser, a point at x moves by
    c (way + (exp(i turn) - 1) x). Both halves of the steps must agree.
    """

    def fit(part: slice) -> complex:
        """x by weighted least squares."""
        columns, target = np.stack([way, np.exp(1j * turn) - 1], -1)[part], moved[part]
        weight = np.ones(len(target))
        for _ in range(ROBUST_FIT_ROUNDS):
            solution = np.linalg.lstsq(columns * weight[:, None], target * weight, rcond=None)[0]
            off = np.abs(columns @ solution - target)
            sigma = max(1.4826 * float(np.median(off)), LEAST_ERROR_M)
            weight = np.sqrt(1 / (1 + (off / (2 * sigma)) ** 2))
        return complex(solution[1] / solution[0]) if solution[0] else complex(np.nan)

    if (np.abs(turn) > COMPARED_TURN_RAD).sum() < 2 * LEAST_COMPARED_STEPS:
        return np.full(2, np.nan)
    whole, one, other = (fit(part) for part in (slice(None), slice(0, None, 2), slice(1, None, 2)))
    agree = abs(one - other) <= max(0.05, 0.25 * abs(whole))
    one_way = abs(turn.sum()) > ONE_WAY * np.abs(turn).sum()
    return np.array(
        [whole.real if agree else np.nan, whole.imag if agree and not one_way else np.nan]
    )


def delay_of(odometry: Array, steps: Steps, most: int = 150) -> tuple[float, float]:
    """By how many scans the odometry `(k, 3)` is late, and what is left of its disagreement then.

    0 and 1 where nothing tells. Neither a mirrored turn nor another unit changes the answer. Only
    scans around which the shifted odometry is known count, half of the steps at least.
    """
    turned, moved = np.abs(steps.motion[:, 2]), np.hypot(*steps.motion[:, :2].T)
    if (turned > COMPARED_TURN_RAD).sum() < LEAST_COMPARED_STEPS or not np.isfinite(odometry).all():
        return 0.0, 1.0
    most = min(most, len(odometry) // 3)
    shifts = np.unique(np.r_[np.arange(-10, 10.5, 0.5), np.arange(-most, most + 1)])
    first, second = (interpolate(odometry, scans + shifts[:, None]) for scans in steps[:2])
    wheels = between(first, second)
    covered = np.isfinite(wheels).all(-1)
    turns, ways = np.abs(wheels[..., 2]), np.hypot(wheels[..., 0], wheels[..., 1])
    unit = float(np.nanmedian(ways[shifts == 0])) / max(float(np.median(moved)), 1e-9)
    way_off = np.abs(ways / max(unit, 1e-9) - moved)
    off = np.minimum(np.abs(turns - turned) + 0.5 * way_off, MOST_OFF)
    off = np.where(covered, off, 0.0).sum(1)
    enough = covered.sum(1) >= max(covered.shape[1] / 2, LEAST_COMPARED_STEPS)
    costs = np.where(enough, off / np.maximum(covered.sum(1), 1), np.inf)
    best, now = int(np.argmin(costs)), float(costs[shifts == 0][0])
    return float(shifts[best]), float(costs[best] / now) if now > 0 else 1.0


def interpolate(odometry: Array, scans: NDArray[Any]) -> Array:
    """Odometry `(k, 3)` at scans and between them, `(..., 3)`; NaN beyond its ends."""
    columns = [odometry[:, 0], odometry[:, 1], np.unwrap(odometry[:, 2])]
    own = np.arange(len(odometry))
    return np.stack([np.interp(scans, own, c, left=np.nan, right=np.nan) for c in columns], -1)


def steps_of(rows: Array) -> tuple[Array, Array]:
    """Way and turn from each row to the next, `(k - 1,)`, metres and radians."""
    step = between(rows[:-1], rows[1:])
    return np.hypot(step[:, 0], step[:, 1]), np.abs(step[:, 2])


def odometry_jumps(rows: Array, times: Array) -> NDArray[np.int64]:
    """Scans to which odometry `(k, 3)` steps as no robot drives, by its own steps and times.

    Such a step is several times as long as nearly all others, for the time that it took, and those
    beside it are not: a robot that drives faster does so for several scans.
    """
    way, _ = steps_of(rows)
    moved = way[np.isfinite(way) & (way > REPEATS_M)]
    if len(moved) < 2 * LEAST_COMPARED_STEPS:
        return np.zeros(0, np.int64)
    took = np.diff(times)
    usual = np.median(took[took > 0]) if (took > 0).any() else np.inf
    allowed = JUMP_STEPS * np.quantile(moved, USUAL_STEPS_SHARE) * np.fmax(took / usual, 1.0)
    far = np.r_[False, way > allowed, False]
    alone = far[1:-1] & ~(far[:-2] & far[2:])  # not between two others
    jumps: list[int] = []
    for scan in np.flatnonzero(alone) + 1:
        if scan - 1 not in jumps:  # one wild row: the way back is no second jump
            jumps.append(int(scan))
    return np.array(jumps, np.int64)


def contradictions(
    scans: Sequence[LaserScan], poses: Array, used: NDArray[np.bool_]
) -> list[Finding]:
    """What an odometry that nobody has compared says against the poses `(k, 3)` found.

    `alignment.prepared` corrects the odometry; faults that it reported are not reported again.
    """
    rows, jumps, against = _against_poses(scans, poses, used)
    if not np.isfinite(rows).all(-1).any():
        return []
    reported, causes = {each.cause for each in getattr(scans, "causes", ())}, []

    def tell(cause: Cause, value: float, words: str) -> None:
        """One more cause."""
        if cause not in reported:
            remedy = "begin with alignment.prepared(log)"
            causes.append(Finding(cause, value, words, remedy, doubtful=True))

    if len(jumps):
        words = f"the odometry jumps {plural(len(jumps), 'time')}, first at scan {jumps[0]}"
        tell(Cause.JUMP, len(jumps), words)
    if against.turn < -RIGHT_TURN_RATIOS[0]:
        words = (
            "the map turns the other way than the odometry: one is mirrored, or the map is wrong"
        )
        tell(Cause.MIRRORED, against.turn, words)
    elif not against.turns_agree:
        words = f"the map turns by {against.turn:.2f} of what the odometry says"
        tell(Cause.SCALE, against.turn, words)
    if against.agreement < CONTRADICTING_COSINE:
        tell(Cause.NO_ODOMETRY, against.agreement, "the odometry moves otherwise than the map")
    if against.way < RIGHT_WAY_RATIOS[0] or against.way > RIGHT_WAY_RATIOS[1]:
        words = f"the map moves by {against.way:.3f} of what the odometry says"
        tell(Cause.SCALE, against.way, words)
    return causes


def promised_under(scans: Sequence[LaserScan], poses: Array, used: NDArray[np.bool_]) -> str:
    """The condition under which a stated accuracy of poses `(k, 3)` holds; "" if there is none.

    Without odometry for most steps, places that look alike would be taken for one. Where wheels and
    ranges differ, the log does not say which of the two has the right scale.
    """
    rows, _, comparison = _against_poses(scans, poses, used)
    usable: Array = np.isfinite(between(rows[:-1], rows[1:])).all(1).astype(float)
    if len(usable) and np.median(usable) < 1:
        return " if no place repeats"
    percent = round(100 * abs(comparison.way - 1)) if np.isfinite(comparison.way) else 0
    return f" and {percent} % of every distance, by which wheels and ranges differ" * bool(percent)


def _against_poses(
    scans: Sequence[LaserScan], poses: Array, used: NDArray[np.bool_]
) -> tuple[Array, NDArray[np.int64], OdometryComparison]:
    """The odometry `(k, 3)` of scans, where it jumps, and how it compares with poses elsewhere."""
    odometry: list[Any] = [s.odometry if s.odometry is not None else (np.nan,) * 3 for s in scans]
    rows: Array = np.reshape(odometry, (-1, 3)).astype(float)
    jumps = odometry_jumps(rows, np.array([scan.time for scan in scans]))
    steps = _steps_between(poses, used)
    before = [np.searchsorted(jumps, ends, "right") for ends in steps[:2]]
    whole = before[0] == before[1]  # no jump lies between
    return rows, jumps, odometry_against_steps(rows, Steps(*(each[whole] for each in steps)))


def _steps_between(poses: Array, used: NDArray[np.bool_]) -> Steps:
    """Steps of some length between poses `(k, 3)` that are used."""
    placed = np.flatnonzero(used)
    motion = between(poses[placed[:-1]], poses[placed[1:]])
    done = np.hypot(*motion[:, :2].T) / LONG_STEP_M + np.abs(motion[:, 2]) / LONG_STEP_RAD
    ends = placed[np.r_[True, np.diff(np.floor(np.cumsum(done)), prepend=0.0) > 0][: len(placed)]]
    first, second = ends[:-COMPARED_AFTER], ends[COMPARED_AFTER:]
    return Steps(first, second, between(poses[first], poses[second]))
