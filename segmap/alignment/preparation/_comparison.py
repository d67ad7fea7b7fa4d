"""What matches that do not lean on the odometry make of it: its unit, direction, delay and more.

Motions on the plane are complex numbers here, x + iy: their quotient is a scale and a turn.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import arrays
from ...arrays import Array, checked
from ...poses.motions import between
from ...scans import Log
from ._blind_steps import Steps, blind_steps

#: Matched turns that are compared are larger than this; straight steps turn by less.
TURN_RAD = np.radians(4)
#: Straight steps that are compared are longer than this.
STRAIGHT_M = 0.1
#: Below so many turns, or straight steps, nothing is said.
ENOUGH = 12
#: Turns that fit worse than this count for less (Cauchy).
TURN_ERROR_RAD = np.radians(10)
#: A match that says less than this stands: the noise of a match.
STANDS_M, STANDS_RAD = 0.03, np.radians(0.6)
#: Rounds of a robust fit: it rests after five to ten.
ROUNDS = 15
#: Where this share of all turns goes one way, a drift of the heading looks like a place aside.
ONE_WAY = 0.6
#: What one step counts at most for a delay: radians, or half of the metres.
MOST_OFF = 0.5
#: Residuals of the lever arm that a match has at least.
LEAST_ERROR_M = 0.003


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
    steps
        The matched motions.
    wheels : (m, 3) array
        The same motions by the odometry.
    """

    turn: float
    way: float
    direction: float
    agreement: float
    lever: Array
    still: float
    steps: Steps = field(repr=False)
    wheels: Array = field(repr=False)

    @property
    def straight(self) -> NDArray[np.bool_]:
        """Steps, `(m,)`, that go straight by the match."""
        x, y, turn = self.steps.motion.T
        return np.asarray((np.hypot(x, y) > STRAIGHT_M) & (np.abs(turn) < TURN_RAD))


@checked
def compare_odometry(log: Log) -> OdometryComparison:
    """Compare the odometry of a log with matches that do not lean on it.

    Some hundred scans over the log are matched with scans soon after, from the guess that the robot
    stands. In a right log turns and ways agree; real wheels say 0.90 to 1.00 of the way.

    Examples
    --------
    >>> from segmap import load
    >>> found = compare_odometry(load("corridor"))
    >>> round(found.way, 2), round(found.agreement, 2)
    (1.0, 1.0)
    """
    arrays.instance(log, "log", Log)
    return compared(log.odometry, blind_steps(log))


def compared(odometry: Array, steps: Steps) -> OdometryComparison:
    """Odometry `(k, 3)`, metres and radians, against matched steps."""
    wheels = between(odometry[steps.first], odometry[steps.second])
    known = np.isfinite(wheels).all(1)
    steps = Steps(steps.first[known], steps.second[known], steps.motion[known])
    wheels = wheels[known]
    way, moved = (m[:, 0] + 1j * m[:, 1] for m in (wheels, steps.motion))
    turned = np.abs(steps.motion[:, 2])
    straight = (np.abs(moved) > STRAIGHT_M) & (turned < TURN_RAD)
    ratio = moved[straight] / np.where(way == 0, 1e-12, way)[straight]
    mean = np.mean(ratio / np.abs(ratio)) if len(ratio) >= ENOUGH else complex(np.nan)
    drives = np.abs(way) > STRAIGHT_M
    stands = drives & (np.abs(moved) < STANDS_M) & (turned < STANDS_RAD)
    return OdometryComparison(
        _slope(wheels[:, 2], steps.motion[:, 2]),
        float(np.median(np.abs(ratio))) if len(ratio) >= ENOUGH else float("nan"),
        float(np.angle(mean)),
        float(np.abs(mean)),
        _lever(way, moved, wheels[:, 2]),
        float(stands.sum() / max(drives.sum(), ENOUGH)),
        steps,
        wheels,
    )


def _slope(given: Array, matched: Array) -> float:
    """Of the axis through turns `(given, matched)`, radians: both err, so none is the base."""
    turns = np.stack([given, matched])[:, np.maximum(np.abs(given), np.abs(matched)) > TURN_RAD]
    if turns.shape[1] < ENOUGH:
        return float("nan")
    size = weight = np.hypot(*turns)
    for _ in range(ROUNDS):
        axis = np.linalg.eigh((weight * turns) @ turns.T)[1][:, 1]
        off = axis[0] * turns[1] - axis[1] * turns[0]
        weight = size / (1 + (off / TURN_ERROR_RAD) ** 2)
    return float(axis[1] / axis[0]) if abs(axis[0]) > 1e-9 else float("inf")


def _lever(way: NDArray[np.complex128], moved: NDArray[np.complex128], turn: Array) -> Array:
    """Where on the robot the point lies that moved so, (2,) array, metres; NaN where unknown.

    With the robot's motion `way`, and c for scale and direction of the laser, a point at x moves by
    c (way + (exp(i turn) - 1) x). Both halves of the steps must agree.
    """

    def fitted(part: slice) -> complex:
        """x by weighted least squares."""
        columns, target = np.stack([way, np.exp(1j * turn) - 1], -1)[part], moved[part]
        weight = np.ones(len(target))
        for _ in range(ROUNDS):
            found = np.linalg.lstsq(columns * weight[:, None], target * weight, rcond=None)[0]
            off = np.abs(columns @ found - target)
            sigma = max(1.4826 * float(np.median(off)), LEAST_ERROR_M)
            weight = np.sqrt(1 / (1 + (off / (2 * sigma)) ** 2))
        return complex(found[1] / found[0]) if found[0] else complex(np.nan)

    if (np.abs(turn) > TURN_RAD).sum() < 2 * ENOUGH:
        return np.full(2, np.nan)
    whole, one, other = (
        fitted(part) for part in (slice(None), slice(0, None, 2), slice(1, None, 2))
    )
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
    if (turned > TURN_RAD).sum() < ENOUGH or not np.isfinite(odometry).all():
        return 0.0, 1.0
    most = min(most, len(odometry) // 3)
    shifts = np.unique(np.r_[np.arange(-10, 10.5, 0.5), np.arange(-most, most + 1)])
    first, second = (shifted(odometry, scans + shifts[:, None]) for scans in steps[:2])
    wheels = between(first, second)
    known = np.isfinite(wheels).all(-1)
    turns, ways = np.abs(wheels[..., 2]), np.hypot(wheels[..., 0], wheels[..., 1])
    unit = float(np.nanmedian(ways[shifts == 0])) / max(float(np.median(moved)), 1e-9)
    if unit == 0:
        return 0.0, 1.0
    off = np.minimum(np.abs(turns - turned) + 0.5 * np.abs(ways / unit - moved), MOST_OFF)
    off = np.where(known, off, 0.0).sum(1)
    enough = known.sum(1) >= max(known.shape[1] / 2, ENOUGH)
    costs = np.where(enough, off / np.maximum(known.sum(1), 1), np.inf)
    best, now = int(np.argmin(costs)), float(costs[shifts == 0][0])
    return float(shifts[best]), float(costs[best] / now) if now > 0 else 1.0


def shifted(odometry: Array, scans: NDArray[Any]) -> Array:
    """Odometry `(k, 3)` at scans and between them, `(..., 3)`; NaN beyond its ends."""
    columns = [odometry[:, 0], odometry[:, 1], np.unwrap(odometry[:, 2])]
    own = np.arange(len(odometry))
    return np.stack([np.interp(scans, own, c, left=np.nan, right=np.nan) for c in columns], -1)
