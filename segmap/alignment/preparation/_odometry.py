"""Odometry put right by what matches make of it, or left out; each thing told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ... import arrays
from ...arrays import Array, checked
from ...display import counted
from ...poses.motions import compose
from ...scans import Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import (
    CONTRADICTING_COSINE,
    LEAST_COMPARED_STEPS,
    REPEATS_M,
    REPEATS_RAD,
    RIGHT_TURN_RATIOS,
    RIGHT_WAY_RATIOS,
    OdometryComparison,
    Steps,
    delay_of,
    odometry_against_steps,
    shifted,
    steps_of,
)  # fmt: skip
from ._blind_steps import blind_steps
from ._jumps import without_jumps

#: Names of units, and the metres of each.
ODOMETRY_UNITS = {
    "millimetres": 0.001,
    "centimetres": 0.01,
    "inches": 0.0254,
    "decimetres": 0.1,
    "feet": 0.3048,
    "kilometres": 1000.0,
}
#: Shares of the way that wheels may say, in any unit.
WAY_RATIOS = (0.86, 1.12)
#: Directions of straight steps agree from here on.
AGREEING_COSINE = 0.9
#: A laser that looks this far aside is mounted so; less is the noise of some logs.
ASIDE_RAD = np.radians(8)
#: A lever arm is told from here on, metres.
LEAST_LEVER_M = 0.15
#: None is longer than a robot, metres.
LONGEST_LEVER_M = 2.0
#: At this share of the steps scans stand although the wheels drive: 0 in right logs.
STILL_SHARE = 0.15
#: A delay counts from so many scans on, ...
LEAST_DELAY_SCANS = 1.0
#: ... where it leaves at most this share of the disagreement.
DELAY_LEFT_SHARE = 0.6
#: A delay of more scans than this ...
LONG_DELAY_SCANS = 10.0
#: ... must leave less of it.
LONG_DELAY_LEFT_SHARE = 0.35
#: What can be wrong with an odometry that contradicts itself.
MIRRORS: dict[str, Callable[[Array], Array]] = {
    "its y counts to the right": lambda rows: rows * (1, -1, 1),
    "its headings count clockwise": lambda rows: rows * (1, 1, -1),
    "its x and y are exchanged": lambda rows: rows[:, [1, 0, 2]],
}


def with_odometry_corrected(log: Log, steps: Steps) -> Log:
    """A log whose odometry says what matched steps say, as far as it can; without it elsewhere."""
    rows, causes = log.odometry, []
    if not np.isfinite(rows).all(1).any():
        return log
    late, left = delay_of(rows, steps)
    if abs(late) >= LEAST_DELAY_SCANS and left < (
        DELAY_LEFT_SHARE if abs(late) <= LONG_DELAY_SCANS else LONG_DELAY_LEFT_SHARE
    ):
        rows = shifted(rows, np.arange(len(rows)) + late)
        causes.append(_delay(late, log.times))
    rows, found = _without_repeats(rows, steps)
    causes += found
    rows, found = without_jumps(log, rows)
    causes += found
    rows, found = _agreeing(rows, steps)
    causes += found
    if not causes:
        return log
    known = [row if np.isfinite(row).all() else None for row in rows]
    scans = tuple(
        replace(scan, odometry=row) if row is None or not np.array_equal(row, was) else scan
        for scan, row, was in zip(log, known, log.odometry, strict=True)
    )
    return replace(log, scans=scans, causes=(*log.causes, *causes))


def _agreeing(rows: Array, steps: Steps) -> tuple[Array, list[Finding]]:
    """Odometry `(k, 3)` in the unit and the frame of the matches, and what that took."""
    causes: list[Finding] = []
    found = odometry_against_steps(rows, steps)
    if len(found.steps.first) < LEAST_COMPARED_STEPS:
        return rows, causes
    # 1. Its unit
    for name, metres in ODOMETRY_UNITS.items():
        if WAY_RATIOS[0] * metres < found.way < WAY_RATIOS[1] * metres:
            rows = rows * (metres, metres, 1)
            causes.append(Finding(Cause.UNIT, metres, f"the odometry is in {name}: converted"))
            found = odometry_against_steps(rows, steps)
    # 2. Whether it, or the laser, is mirrored
    if found.agreement < CONTRADICTING_COSINE and found.still < STILL_SHARE:
        mirrored = _unmirrored(rows, steps)
        if mirrored is None:
            words = "the odometry moves otherwise than the scans do: it is left out"
            told = Finding(Cause.NO_ODOMETRY, found.agreement, words, doubtful=True)
            return _nothing(rows), [*causes, told]
        words, rows = mirrored
        words = f"the odometry moves across its own heading, {words}: put right"
        causes.append(Finding(Cause.ODOMETRY_MIRRORED, found.agreement, words))
        found = odometry_against_steps(rows, steps)
    elif found.turn < -RIGHT_TURN_RATIOS[0]:
        words = "the laser or the wheels count turns the other way: one of both is mirrored"
        remedy = "--clockwise where the laser hangs upside down, else mend the odometry"
        causes.append(Finding(Cause.MIRRORED, found.turn, words, remedy))
        rows = rows * (1, -1, -1)  # as the scans have it: the map may be the mirror image
        found = odometry_against_steps(rows, steps)
    elif not (np.isnan(found.turn) or RIGHT_TURN_RATIOS[0] < found.turn < RIGHT_TURN_RATIOS[1]):
        words = f"the scans turn by {found.turn:.2f} of what the odometry says: it is left out"
        return _nothing(rows), [*causes, Finding(Cause.SCALE, found.turn, words)]
    # 3. Where the laser looks
    lever = found.lever
    if found.agreement >= AGREEING_COSINE and abs(found.direction) > ASIDE_RAD:
        rows = compose(rows, np.array([0.0, 0.0, -found.direction]))
        causes.append(_mounting(-found.direction))
        found = odometry_against_steps(rows, steps)
    # 4. What it makes of the way
    if np.isfinite(found.way) and not RIGHT_WAY_RATIOS[0] <= found.way <= RIGHT_WAY_RATIOS[1]:
        off = 100 * abs(1 / found.way - 1)
        words = f"wheels or ranges are {off:.0f} % off: scans move by {found.way:.3f} of the way"
        causes.append(Finding(Cause.SCALE, found.way, words))
        rows = rows * (found.way, found.way, 1)
    # 5. Where the laser sits, and what moves along
    x, y = np.nan_to_num(lever)
    if LEAST_LEVER_M < np.hypot(x, y) < LONGEST_LEVER_M:
        words = f"the laser sits {x:.2f} m ahead and {y:.2f} m left of where the log has it"
        causes.append(Finding(Cause.LEVER_ARM, float(np.hypot(x, y)), words, "--mount auto"))
    if found.still > STILL_SHARE:
        words = f"at {100 * found.still:.0f} % of the steps the scans stand though the wheels drive"
        why = "people, or parts of the robot, move along with it"
        causes.append(Finding(Cause.BODY, found.still, f"{words}: {why}"))
    return rows, causes


def mounting_of(found: OdometryComparison) -> Array:
    """The place of the log's robot frame on the robot, (3,) array, as turns and ways tell it."""
    turned = -found.direction if found.agreement >= AGREEING_COSINE else 0.0
    turned = turned if abs(turned) > ASIDE_RAD else 0.0
    x, y = np.nan_to_num(found.lever)
    return np.array([x, y, turned])


def _mounting(turned: float) -> Finding:
    """The laser looks aside, by so many radians counter-clockwise."""
    degrees = float(np.degrees(turned))
    to = 90 * round(degrees / 90)
    looks = {180: "backwards", -180: "backwards", 90: "to the left", -90: "to the right"}
    near = abs(degrees - to) < np.degrees(ASIDE_RAD) and to
    where = looks[to] if near else f"{degrees:.0f} degrees aside"
    words = f"the laser looks {where}, or the wheels count otherwise"
    degrees = to if near else round(degrees)
    return Finding(Cause.MOUNTING, turned, words, f"--mount X Y {degrees:g}")


def _delay(late: float, times: Array) -> Finding:
    """The odometry is so many scans late."""
    steps = np.diff(times[np.isfinite(times)])
    step = float(np.median(steps)) if len(steps) else 0.0
    value, unit = (abs(late) * step, "s") if step > 0 else (abs(late), "scans")
    word = "late" if late > 0 else "early"
    words = f"the odometry is {value:.3g} {unit} {word}: read at the right time"
    return Finding(Cause.DELAY, float(np.copysign(value, late)), words)


def _unmirrored(rows: Array, steps: Steps) -> tuple[str, Array] | None:
    """What is wrong with an odometry that contradicts itself, and the right one; None if nothing.

    One that only looks aside then is turned as well: compass headings begin at north.
    """
    for words, change in MIRRORS.items():
        changed = change(rows)
        found = odometry_against_steps(changed, steps)
        turns_right = (
            np.isnan(found.turn) or RIGHT_TURN_RATIOS[0] < found.turn < RIGHT_TURN_RATIOS[1]
        )
        if turns_right and found.agreement > AGREEING_COSINE:
            aside = found.direction if abs(found.direction) > ASIDE_RAD else 0.0
            return words, compose(changed, np.array([0.0, 0.0, -aside]))
    return None


def _nothing(rows: Array) -> Array:
    """No odometry at all."""
    return np.full_like(rows, np.nan)


def _without_repeats(rows: Array, steps: Steps) -> tuple[Array, list[Finding]]:
    """Rows `(k, 3)` without those that repeat while matched steps move: NaN in their place."""
    rows = rows.copy()
    way, turned = steps_of(rows)
    run = np.r_[0, np.cumsum(~((way < REPEATS_M) & (turned < REPEATS_RAD)))]  # of equal rows
    x, y, turn = steps.motion.T
    moves = (np.hypot(x, y) > 0.1) | (np.abs(turn) > np.radians(4))
    within = moves & (run[steps.first] == run[steps.second])
    runs, counts = np.unique(run[steps.first[within]], return_counts=True)
    out = np.isin(run, runs[counts >= 3]) & np.r_[False, np.diff(run) == 0]
    if not out.any():
        return rows, []
    rows[out] = np.nan
    words = f"the odometry stands still in {counted(int(out.sum()), 'scan')} while the robot moves"
    return rows, [
        Finding(Cause.NO_ODOMETRY, int(out.sum()), f"{words}: there is no odometry there")
    ]


@checked
def compare_odometry(log: Log) -> OdometryComparison:
    """Compare the odometry of a log with matches that do not lean on it.

    Some hundred scans over the log are matched with scans soon after, from the guess that the robot
    stands. In a right log turns and ways agree; real wheels say 0.90 to 1.00 of the way.

    Examples
    --------
    >>> from segmap import load
    >>> comparison = compare_odometry(load("corridor"))
    >>> round(comparison.way, 2), round(comparison.agreement, 2)
    (1.0, 1.0)
    """
    arrays.instance(log, "log", Log)
    return odometry_against_steps(log.odometry, blind_steps(log))
