"""Odometry put right by what matches make of it, or left out; each thing told."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...display import plural
from ...poses.motions import compose
from ...scans import Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import (
    COMPARED_STRAIGHT_M,
    COMPARED_TURN_RAD,
    CONTRADICTING_COSINE,
    REPEATS_M,
    REPEATS_RAD,
    RIGHT_TURN_RATIOS,
    RIGHT_WAY_RATIOS,
    OdometryComparison,
    Steps,
    delay_of,
    interpolate,
    odometry_against_steps,
    steps_of,
)  # fmt: skip
from ._changed import with_odometry_rows
from ._jumps import without_jumps

#: Names of units, and the metres of each.
ODOMETRY_UNITS = {
    "millimetres": 0.001,
    "centimetres": 0.01,
    "feet": 0.3048,
}
#: Shares of the way that wheels may say, in any unit.
WAY_RATIOS = (0.86, 1.12)
#: Directions of straight steps agree from here on.
AGREEING_COSINE = 0.9
#: A laser that looks this far aside is mounted so; less is the noise of some logs.
ASIDE_RAD = np.radians(8)
#: A lever arm is told from here on, metres.
LEAST_LEVER_M = 0.15
#: At this share of the steps scans stand although the wheels drive: 0 in right logs.
STILL_SHARE = 0.15
#: A delay of a scan and more counts where it leaves at most this share of the disagreement.
DELAY_LEFT_SHARE = 0.5
#: Matched steps that move while the rows repeat; with this many, the rows were not read anew.
LEAST_REPEATS = 3
#: What can be wrong with an odometry that contradicts itself.
MIRRORS = {
    "its y counts to the right": (1, -1, 1),
    "its headings count clockwise": (1, 1, -1),
}


def with_odometry_corrected(log: Log, steps: Steps) -> Log:
    """A log whose odometry says what matched steps say, as far as it can; without it elsewhere."""
    rows, causes = log.odometry, []
    if not np.isfinite(rows).all(1).any():
        return log
    late, share_left = delay_of(rows, steps)
    if abs(late) >= 1 and share_left < DELAY_LEFT_SHARE:
        rows = interpolate(rows, np.arange(len(rows)) + late)
        words = f"the odometry is {abs(late):g} scans {'late' if late > 0 else 'early'}"
        causes.append(Finding(Cause.DELAY, late, f"{words}: read at the right time"))
    rows, repeats = _without_repeats(rows, steps)
    rows, jumps = without_jumps(log, rows)
    rows, others = _make_agree(rows, steps)
    causes = [*causes, *repeats, *jumps, *others]
    return with_odometry_rows(log, rows, *causes) if causes else log


def _make_agree(rows: Array, steps: Steps) -> tuple[Array, list[Finding]]:
    """Odometry `(k, 3)` in the unit and the frame of the matches, and what that took."""
    causes: list[Finding] = []
    against = odometry_against_steps(rows, steps)
    # 1. Its unit
    for name, metres in ODOMETRY_UNITS.items():
        if WAY_RATIOS[0] * metres < against.way < WAY_RATIOS[1] * metres:
            rows = rows * (metres, metres, 1)
            causes.append(Finding(Cause.UNIT, metres, f"the odometry is in {name}: converted"))
            against = odometry_against_steps(rows, steps)
    # 2. Whether it, or the laser, is mirrored
    if against.agreement < CONTRADICTING_COSINE and against.still < STILL_SHARE:
        mirrored = _unmirror(rows, steps)
        if mirrored is None:
            words = "the odometry moves otherwise than the scans do: it is left out"
            finding = Finding(Cause.NO_ODOMETRY, against.agreement, words, doubtful=True)
            return np.full_like(rows, np.nan), [*causes, finding]
        words, rows = mirrored
        words = f"the odometry moves across its own heading, {words}: put right"
        causes.append(Finding(Cause.ODOMETRY_MIRRORED, against.agreement, words))
        against = odometry_against_steps(rows, steps)
    elif against.turn < -RIGHT_TURN_RATIOS[0]:
        words = "the laser or the wheels count turns the other way: one of both is mirrored"
        remedy = "--clockwise where the laser hangs upside down, else mend the odometry"
        causes.append(Finding(Cause.MIRRORED, against.turn, words, remedy))
        rows = rows * (1, -1, -1)  # as the scans have it: the map may be the mirror image
        against = odometry_against_steps(rows, steps)
    elif not against.turns_agree:
        words = f"the scans turn by {against.turn:.2f} of what the odometry says: it is left out"
        finding = Finding(Cause.SCALE, against.turn, words)
        return np.full_like(rows, np.nan), [*causes, finding]
    # 3. Where the laser looks
    x, y, turned = mounting_of(against)
    if turned:
        rows = compose(rows, np.array([0.0, 0.0, turned]))
        degrees = round(float(np.degrees(turned)))
        words = f"the laser looks {degrees} degrees aside, or the wheels count otherwise"
        causes.append(Finding(Cause.MOUNTING, turned, words, f"--mount X Y {degrees}"))
        against = odometry_against_steps(rows, steps)
    # 4. What it makes of the way
    if np.isfinite(against.way) and not RIGHT_WAY_RATIOS[0] <= against.way <= RIGHT_WAY_RATIOS[1]:
        off = 100 * abs(1 / against.way - 1)
        words = f"wheels or ranges are {off:.0f} % off: scans move by {against.way:.3f} of the way"
        causes.append(Finding(Cause.SCALE, against.way, words))
        rows = rows * (against.way, against.way, 1)
    # 5. Where the laser sits, and what moves along
    if np.hypot(x, y) > LEAST_LEVER_M:
        words = f"the laser sits {x:.2f} m ahead and {y:.2f} m left of where the log has it"
        causes.append(Finding(Cause.LEVER_ARM, float(np.hypot(x, y)), words, "--mount auto"))
    if against.still > STILL_SHARE:
        words = f"at {100 * against.still:.0f} % of the steps the scans stand and the wheels drive"
        why = "people, or parts of the robot, move along with it"
        causes.append(Finding(Cause.BODY, against.still, f"{words}: {why}"))
    return rows, causes


def mounting_of(against: OdometryComparison) -> Array:
    """The place of the log's robot frame on the robot, (3,) array, as turns and ways tell it."""
    aside = against.agreement >= AGREEING_COSINE and abs(against.direction) > ASIDE_RAD
    return np.array([*np.nan_to_num(against.lever), -against.direction if aside else 0.0])


def _unmirror(rows: Array, steps: Steps) -> tuple[str, Array] | None:
    """What is wrong with an odometry that contradicts itself, and the right one; None if nothing.

    One that only looks aside then is turned as well: compass headings begin at north.
    """
    for words, signs in MIRRORS.items():
        changed = rows * signs
        against = odometry_against_steps(changed, steps)
        if against.turns_agree and against.agreement > AGREEING_COSINE:
            return words, compose(changed, np.array([0.0, 0.0, mounting_of(against)[2]]))
    return None


def _without_repeats(rows: Array, steps: Steps) -> tuple[Array, list[Finding]]:
    """Rows `(k, 3)` without those that repeat while matched steps move: NaN in their place."""
    run, moving = equal_runs(rows, steps)
    runs, counts = np.unique(moving, return_counts=True)
    repeats = np.isin(run, runs[counts >= LEAST_REPEATS]) & (np.diff(run, prepend=-1) == 0)
    if not repeats.any():
        return rows, []
    count = int(repeats.sum())
    words = f"the odometry stands still in {plural(count, 'scan')} while the robot moves"
    finding = Finding(Cause.NO_ODOMETRY, count, f"{words}: there is no odometry there")
    return np.where(repeats[:, None], np.nan, rows), [finding]


def equal_runs(rows: Array, steps: Steps) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The run of equal rows that each of `(k, 3)` is in; that of each step that moves in one."""
    way, turned = steps_of(rows)
    run = np.r_[0, np.cumsum(~((way < REPEATS_M) & (turned < REPEATS_RAD)))]
    x, y, turn = steps.motion.T
    moves = (np.hypot(x, y) > COMPARED_STRAIGHT_M) | (np.abs(turn) > COMPARED_TURN_RAD)
    return run, run[steps.first[moves & (run[steps.first] == run[steps.second])]]
