"""What to doubt of a pose graph, and how far each scan may be off, once that is asked for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Array
from ...poses.motions import between
from ...scans.causes import Cause, Finding, Unmatched
from .._result import SURE_M, Appraisal
from ..graph import NEARBY, Edge, deviations, place_deviations

if TYPE_CHECKING:
    from ._front_end import TrackedScan

#: Loops that stay open by this many standard deviations contradict the rest.
OPEN = 5.0
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
#: No scan for so many times as long as between nearly all of them, and for so long, seconds: ...
PAUSE_RATIO = 5.0
LEAST_PAUSE_S = 1.0
#: ... the scan after it confirms the way there unless it lies on the map worse than all but this
#: share: pauses of a real log rank above 0.09, a robot that was carried below 0.01.
CONFIRMED_RANK = 0.02
#: A step of the map that errs by more than so many times the usual ...
TORN_RATIO = 80.0
#: ... and by more than this, metres, is torn: 3 to 40 times and 0.95 m in right logs, 180 times and
#: 2.2 m in wrong ones.
TORN_M = 1.5
#: Words of `Cause.LEFT_FREE`.
LEFT_FREE = (
    "the matches contradict each other so much that they leave poses free: are there scans of "
    "two robots, or of corridors without odometry?"
)


def appraisal(
    rows: Sequence[TrackedScan],
    poses: Array,
    places: Array,
    edges: Edge | None,
    converged: bool,
    fixed: bool,
) -> Appraisal:
    """How far each scan may be off, in the whole and relative to those near by, and the findings.

    Poses `(k, 3)` of the scans and `(n, 3)` of the key frames, metres and radians; the edges
    between these are stacked, None where there are none; `converged` says whether they were solved,
    `fixed` whether they fixed all poses: else nothing is known of any.
    """
    frame = np.array([row.frame for row in rows], np.int64)
    far, near, left = np.zeros(len(rows)), np.zeros(len(rows)), np.zeros(0)
    if edges is not None:
        weight = np.bincount(frame, minlength=len(places)).astype(float)
        try:
            far, near = (spread[frame] for spread in place_deviations(places, edges, weight))
        except np.linalg.LinAlgError:
            fixed = False
        left = deviations(places, edges)[edges.loop]
    told = [(row.along, row.overlap, row.scan.time) for row in rows]
    along, overlap, times = np.reshape(told, (-1, 3)).T
    far, near = np.hypot(far, along), np.hypot(near, along)
    causes = breaks(np.reshape([row.odometry for row in rows], (-1, 3)), poses, overlap, times)
    if not fixed:
        far = near = np.full(len(rows), np.inf)
        causes.append(Finding(Cause.LEFT_FREE, len(places), LEFT_FREE, doubtful=True))
    causes += _findings([row.unmatched for row in rows], far, near, left, converged)
    return Appraisal(tuple(causes), far, near)


def breaks(odometry: Array, poses: Array, overlap: Array, times: Array) -> list[Finding]:
    """What speaks for a robot that was carried: odometry and poses `(k, 3)`, metres and radians.

    `overlap`, `(k,)`, is the share of each scan that lay on the map of those before it; NaN where
    nothing was matched and no odometry carried it. `times`, `(k,)`, are in seconds.
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
    since = np.diff(times, prepend=times[0])
    paused = since > max(PAUSE_RATIO * np.quantile(since, USUAL_STEP_QUANTILE), LEAST_PAUSE_S)
    broken = (overlap < usual - drop) & ~(way > JUMP_RATIO * usual_way)
    broken |= paused & ~(overlap >= np.quantile(ranked, CONFIRMED_RANK))
    if broken.any():
        words = f"scan {(k := int(np.argmax(broken)))} does not go on from those before it"
        why = "the robot was lifted, or is on another floor, or scans are missing"
        found.append(Finding(Cause.LIFTED, k, f"{words}: {why}", doubtful=True))
    seen = between(poses[:-1], poses[1:])
    torn = np.hypot(seen[:, 0] - wheels[:, 0], seen[:, 1] - wheels[:, 1])
    if np.isfinite(torn).any():
        most = float(np.nanmax(torn))
        if most > max(TORN_M, TORN_RATIO * float(np.nanmedian(torn))):
            scan = int(np.nanargmax(torn)) + 1
            words = f"at scan {scan} the map tears the odometry by {most:.1f} m"
            found.append(Finding(Cause.LIFTED, most, words, doubtful=True))
    return found


def _findings(
    unmatched: Sequence[Unmatched], far: Array, near: Array, left: Array, converged: bool
) -> list[Finding]:
    """What to doubt of the whole, with numbers.

    `far` and `near` are the standard deviations of all places in the whole and relative to those
    within 20 m, `left` is what the solution leaves of each loop, `(m,)`, in standard deviations.
    """
    count, found, counts = len(unmatched), [], Counter(unmatched)

    def add(cause: Cause, value: int, words: str) -> None:
        """One more finding; `Alignment.verdict` weighs the scans themselves."""
        found.append(Finding(cause, value, words))

    if loose := counts[Unmatched.FREE_DIRECTION]:
        words = f"at {loose} of {count} scans {Unmatched.FREE_DIRECTION}"
        add(Cause.NO_DISTANCE, loose, words)
    if apart := counts[Unmatched.UNTIED]:
        add(Cause.UNTIED, apart, f"no match ties {apart} of {count} scans to the rest")
    if np.isfinite(far).all() and (vague := int((far > SURE_M).sum())):
        words = f"{vague} of {count} scans may be more than {2 * SURE_M} m off, {_worst(far)}"
        close = int((near > SURE_M).sum())
        most = f"{close} of {count}, {_worst(near)}" if close else "none"
        words += f"; relative to those within {NEARBY:g} m {most}"
        add(Cause.VAGUE, vague, words)
    if wide := int((left > OPEN).sum()):
        words = f"{wide} of {len(left)} loops stay open by over {OPEN:g} standard deviations"
        add(Cause.OPEN_LOOPS, wide, words)
    if not converged:
        add(Cause.NOT_SOLVED, 1, "the solver stopped before it came to an end")
    return found


def _worst(far: Array) -> str:
    """The scan that is known least, by two standard deviations."""
    return f"scan {np.argmax(far)} by {2 * far.max():.1f} m"
