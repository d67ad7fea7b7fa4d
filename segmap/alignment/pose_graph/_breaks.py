"""Where a drive breaks: what the robot sees changes at once, or its map tears the odometry."""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...poses.motions import between
from ...scans.causes import Cause, Finding

#: A scan lies on the map before it less than usual by so many times what all but the worst
#: hundredth do: 1.1 to 2.2 in real and simulated logs without a break, 4.6 and more with one.
BREAK_RATIO = 3.0
#: So many scans at least count as the worst: one break takes two or three.
WORST = 5
#: And by this share at least: walls that all match leave no spread to compare with.
LEAST_DROP = 0.2
#: Odometry that goes this many times as far as nearly all steps tells of the break itself.
JUMP_RATIO = 2.0
#: Nearly all steps: this share of them.
USUAL_STEP_QUANTILE = 0.95
#: A step of the map that errs by more than so many times the usual ...
TORN_RATIO = 80.0
#: ... and by more than this, metres, is torn: 3 to 40 times and 0.95 m in right logs, 180 times and
#: 2.2 m in wrong ones.
TORN_M = 1.5


def breaks(odometry: Array, poses: Array, overlap: Array) -> list[Finding]:
    """What speaks for a robot that was carried: odometry and poses `(k, 3)`, metres and radians.

    `overlap`, `(k,)`, is the share of each scan that lay on the map of those before it; NaN where
    nothing was matched and no odometry carried it.
    """
    found: list[Finding] = []
    known = np.isfinite(overlap)
    if len(poses) < 3 * WORST or known.sum() < 3 * WORST:
        return found
    wheels = between(odometry[:-1], odometry[1:])
    way = np.r_[np.nan, np.hypot(wheels[:, 0], wheels[:, 1])]
    moved = way[np.isfinite(way)]
    usual_way = np.quantile(moved, USUAL_STEP_QUANTILE) if len(moved) else np.inf
    ranked = np.sort(overlap[known])
    usual = float(np.median(ranked))
    drop = max(BREAK_RATIO * (usual - ranked[max(WORST, len(ranked) // 100)]), LEAST_DROP)
    broken = np.flatnonzero((overlap < usual - drop) & ~(way > JUMP_RATIO * usual_way))
    if len(broken):
        words = f"at scan {broken[0]} all that the robot sees changes at once"
        why = "it was lifted, or is on another floor, or scans are missing"
        found.append(Finding(Cause.LIFTED, int(broken[0]), f"{words}: {why}", doubtful=True))
    seen = between(poses[:-1], poses[1:])
    torn = np.hypot(seen[:, 0] - wheels[:, 0], seen[:, 1] - wheels[:, 1])
    if np.isfinite(torn).any():
        most = float(np.nanmax(torn))
        if most > max(TORN_M, TORN_RATIO * float(np.nanmedian(torn))):
            words = (
                f"at scan {int(np.nanargmax(torn)) + 1} the map tears the odometry by {most:.1f} m"
            )
            found.append(Finding(Cause.LIFTED, most, words, doubtful=True))
    return found
