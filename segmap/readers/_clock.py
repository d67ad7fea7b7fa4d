"""Clocks that are set back while a robot records: the order in the file counts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..display import plural
from ..scans.causes import Cause, Finding

#: A step back by less than so many usual steps is a message that came late, and no clock.
LATE_STEPS = 3
#: From this share of the scans or poses on it is no clock: the file has them in another order.
SHUFFLED_ROWS_SHARE = 0.1
#: Where a clock is set back in a file, scans and poses of that clock stand as near as this.
NEAR_SCANS = 10


def on_one_clock(
    scans: Array, poses: Array, after: NDArray[np.int64] | None
) -> tuple[Array, Array, list[Finding]]:
    """Times of scans `(k,)` and of poses `(m,)`, in the order of a file, without steps back.

    `after`, `(m,)`, says how many scans stand before each pose; None where they are in two files.
    Where both are set back at one place they have one clock, and are shifted alike; else each goes
    on by itself.
    """
    usual = [_step_s(scans), _step_s(poses)]
    back = [np.r_[False, np.diff(t) < -LATE_STEPS * max(usual)][: len(t)] for t in (scans, poses)]
    if not any(b.any() for b in back) or any(b.sum() > SHUFFLED_ROWS_SHARE * len(b) for b in back):
        return scans, poses, []
    alone = [np.cumsum(b) for b in back]
    mended = [
        t + _shifts(t, part, step)[part]
        for t, part, step in zip((scans, poses), alone, usual, strict=True)
    ]
    if after is None:
        after = np.searchsorted(mended[0], mended[1])
    steps = [np.diff(t) - step for t, step in zip((scans, poses), usual, strict=True)]
    stretches, causes = [part.copy() for part in alone], _clock_findings(steps, back, after)
    stretches[1] += stretches[0][after[0] - 1] if after[0] else 0  # what begins later
    stretches[0] += stretches[1][after == 0].max(initial=0)  # begins on the clock of then
    around = np.clip(after + np.array([[-NEAR_SCANS], [NEAR_SCANS]]), 0, len(scans) - 1)
    first, last = stretches[0][around]
    if ((first <= stretches[1]) & (stretches[1] <= last)).all():
        shifts = _shifts(np.r_[scans, poses], np.concatenate(stretches), min(usual))
        return scans + shifts[stretches[0]], poses + shifts[stretches[1]], causes
    return mended[0], mended[1], causes


def stands(times: Array) -> bool:
    """Whether times are all equal, two and more: then no clock ran."""
    return len(times) > 1 and bool(np.ptp(times) == 0)


def _step_s(times: Array) -> float:
    """The usual step from time to time, seconds; 0 where there is none."""
    steps = np.diff(times)
    return float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0


def _shifts(times: Array, stretches: NDArray[np.int64], step: float) -> Array:
    """What each stretch of times is shifted by, so that it begins a step after the one before."""
    shifts = [0.0]
    for k in range(1, stretches.max(initial=0) + 1):
        before, here = times[stretches == k - 1], times[stretches == k]
        shifts.append(float(shifts[-1] + np.nanmax(before) + step - np.nanmin(here)))
    return np.array(shifts)


def _clock_findings(
    steps: Sequence[Array], back: Sequence[NDArray[np.bool_]], after: NDArray[np.int64]
) -> list[Finding]:
    """That a clock was set back, of the scans or else of the poses, by how much and where first."""
    which = 0 if back[0].any() else 1
    first = int(np.argmax(back[which]))
    value, scan = float(steps[which][first - 1]), first if which == 0 else int(after[first])
    whose = ("clock", "clock of the odometry")[which]
    times = plural(int(back[which].sum()), "time")
    words = f"the {whose} is set back {times}, first by {-value:.4g} s at scan {scan}"
    return [Finding(Cause.CLOCK, value, f"{words}: the order in the file counts")]
